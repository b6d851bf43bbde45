"""Formats that hold one kind of episode only."""

from collections.abc import Sequence
from typing import Any

from mimoc.errors import RecordingError
from mimoc.recording.reading import Episode, ReadRecording


def check_alike(recording: ReadRecording, episodes: Sequence[Episode]) -> None:
    """Check that all episodes have the same observations, number of actuators and control step.

    Raises:
        RecordingError: If one has not.
    """
    first = episodes[0]
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
