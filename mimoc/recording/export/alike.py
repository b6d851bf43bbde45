"""Formats that hold one kind of episode only."""

from collections.abc import Sequence
from typing import Any

from mimoc.errors import RecordingError
from mimoc.recording.reading import Episode, ReadRecording


def check_alike(recording: ReadRecording, episodes: Sequence[Episode]) -> None:
    """Check that all episodes have the same observations, number of actuators and control step, and that they have any.

    Raises:
        RecordingError: If one has not, or if no actuator is commanded, which these formats cannot hold.
    """
    first = episodes[0]
    if not first.described.actions:
        raise RecordingError(f"{recording.path}: this format holds actions, and this infant has none; export it to csv")
    for episode in episodes:
        if _kind(episode) != _kind(first):
            raise RecordingError(
                f"{recording.path}: infant {episode.infant}, episode {episode.number} has other observations, actuators"
                f" or control steps than infant {first.infant}, episode {first.number}, and this format holds one kind"
                " only; export it to csv"
            )


def _kind(episode: Episode) -> Any:
    described = episode.described
    readings = {(reading.name, reading.shape, reading.dtype, reading.kind) for reading in described.readings}
    return readings, len(described.actions), described.step_ms
