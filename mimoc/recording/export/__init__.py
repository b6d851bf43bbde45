"""Recordings in the formats of others: Minari, LeRobot and CSV."""

import os
import secrets
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import csv

from mimoc.base.errors import OutputError, RecordingError, UnknownNameError
from mimoc.recording.described import OBSERVATION
from mimoc.recording.earlier import convert
from mimoc.recording.export.lerobot import export_lerobot
from mimoc.recording.export.minari import export_minari
from mimoc.recording.reading import Episode, ReadRecording, read_recording
from mimoc.recording.tables import sparse_of

Progress = Callable[[int, int], None]
"""Called with how much is written, and how much there is."""


def export_csv(recording: ReadRecording, episodes: Sequence[Episode], out: Path, progress: Progress) -> list[str]:
    """Write a table for each episode, one of touch with a row for each number that is not zero, and a list of all.

    Returns:
        What a table cannot hold.
    """

    def write(name: str, columns: Mapping[str, Any]) -> None:
        csv.write_csv(pa.table({key: pa.array(values) for key, values in columns.items()}), out / f"{name}.csv")

    notes = dict[str, None]()
    for done, episode in enumerate(episodes):
        progress(done, len(episodes))
        name = episode.files.stems[0].name
        write(name, episode.columns())
        for reading in episode.described.readings:
            if reading.kind == "picture":
                notes[f"'{reading.name}' is left out: a table cannot hold pictures"] = None
            elif reading.kind == "sparse":
                rows, index, value = sparse_of(episode.table, OBSERVATION + reading.name)
                layout = reading.layout or [str(number) for number in range(reading.size)]
                columns = {"step": episode.step[rows], "name": np.array(layout)[index], "value": value}
                write(f"{name}.{reading.name}", columns)
                notes[f"'{reading.name}' is in tables of its own, without the numbers that are zero"] = None
    write("episodes", recording.summary())
    return [*notes, "states and what was done besides control steps are left out: a table cannot hold them"]


Export = Callable[[ReadRecording, Sequence[Episode], Path, Progress], Iterable[str]]
"""Writes episodes into an empty folder, and returns what the format cannot hold, one line each."""
FORMATS: Mapping[str, Export] = {"minari": export_minari, "lerobot": export_lerobot, "csv": export_csv}
RECORDING = "recording"
"""Format of this version itself."""


def export_recording(
    recording: ReadRecording | str | Path,
    to: str,
    out: str | Path,
    *,
    progress: Progress = lambda done, total: None,
) -> tuple[str, ...]:
    """Write a recording in another format, all or nothing; return what that cannot hold, one line each.

    Args:
        recording: The recording, or its folder.
        to: `minari`, `lerobot`, `csv`, or `recording`: one of an earlier version as this one records.
        out: A new or empty folder.
        progress: Called with how much is written, and how much there is.

    Raises:
        UnknownNameError: If there is no such format.
        RecordingError: If this is no recording, it is damaged, or there are no steps in it.
        OutputError: If the folder is not empty, or cannot be written.
        MissingExtraError: If the format needs a library that is not installed.

    Example:
        >>> import mimoc
        >>> lost = mimoc.export_recording("recordings/reach", "csv", "out/csv")
        >>> any("states" in line for line in lost)
        True
    """
    if to not in (*FORMATS, RECORDING):
        raise UnknownNameError("format of recordings", to, (*FORMATS, RECORDING))
    if to == RECORDING:
        folder = recording.path if isinstance(recording, ReadRecording) else Path(recording).expanduser()
        with _staged(out) as staging:
            convert(folder, staging)
        return ()
    source = recording if isinstance(recording, ReadRecording) else read_recording(recording)
    episodes = [episode for episode in source if episode.steps]
    if not episodes:
        raise RecordingError(f"{source.path}: there are no control steps in this recording")
    empty = len(source) - len(episodes)
    if to != "csv":
        _check_alike(source, episodes)
    with _staged(out) as staging:
        notes = FORMATS[to](source, episodes, staging, progress)
    return (*([f"{empty} episodes without any control step are left out"] if empty else []), *notes)


@contextmanager
def _staged(out: str | Path) -> Iterator[Path]:
    """Yield an empty folder, which is put in place of a new or empty one if nothing goes wrong.

    Raises:
        OutputError: If there is anything else, or it cannot be written.
    """
    target = Path(out).expanduser()
    if os.path.lexists(target) and not target.is_dir():
        raise OutputError(f"{target}: this is a file; name a new folder")
    if target.is_dir() and any(target.iterdir()):
        raise OutputError(f"{target}: the folder is not empty; name a new one")
    staging = target.absolute().parent / f".{target.name}.mimoc-{secrets.token_hex(8)}"
    try:
        staging.mkdir(parents=True)
        yield staging
        if target.is_dir():
            target.rmdir()
        os.rename(staging, target)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written ({error.strerror}); choose another folder") from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _check_alike(recording: ReadRecording, episodes: Sequence[Episode]) -> None:
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
