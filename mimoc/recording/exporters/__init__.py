"""Recordings in the formats of others."""

import os
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import KindError, OutputError, RecordingError
from mimoc.base.kinds import function_of
from mimoc.bundle.files import staged_folder
from mimoc.recording.reading import Episode, ReadRecording, read_recording
from mimoc.schema.kinds import EXPORTERS


@takes("a recording, or the folder of one", ReadRecording, *PATH)
def export_recording(
    recording: ReadRecording | str | Path,
    to: str,
    out: str | Path,
    *,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[str, ...]:
    """Write a recording in another format, all or nothing; return what that cannot hold, one line each.

    Args:
        recording: The recording, or its folder.
        to: `minari`, `lerobot`, `mjlab`, `csv`, `parquet`, or the name of an `ExporterKind` that was registered.
        out: A new or empty folder.
        progress: Called with how much is written, and how much there is.

    Raises:
        UnknownNameError: If there is no such format.
        RecordingError: If this is no recording, it is damaged, or there are no steps in it.
        OutputError: If the folder is not empty, or cannot be written.
        MissingExtraError: If the format needs a library that is not installed.
        KindError: If somebody else's exporter cannot be imported, or does not return lines.

    Example:
        >>> import mimoc
        >>> lost = mimoc.export_recording("recordings/reach", "csv", "out/csv")
        >>> any("states" in line for line in lost)
        True
    """
    kind, notes = EXPORTERS.find(to), list[str]()
    whole = recording if isinstance(recording, ReadRecording) else read_recording(recording)
    source = replace(whole, episodes=tuple(episode for episode in whole if episode.steps))
    if not source:
        raise RecordingError(f"{source.path}: there are no control steps in this recording")
    if empty := len(whole) - len(source):
        notes.append(f"{empty} episodes without any control step are left out")
    if kind.is_uniform:
        _check_uniform(source)
    export = function_of(kind.run, "export")
    with staged_folder(_new_folder(out)) as staging:
        lost = export(source, staging, progress) or ()
        lines = [*lost] if isinstance(lost, Iterable) and not isinstance(lost, str) else [lost]
        if not all(isinstance(line, str) for line in lines):
            raise KindError(f"the exporter '{to}' returned {lines!r:.60}; let it return lines of text")
    return (*notes, *lines)


def _new_folder(out: str | Path) -> Path:
    target = Path(out).expanduser()
    if os.path.lexists(target) and not target.is_dir():
        raise OutputError(f"{target}: this is a file; name a new folder")
    if target.is_dir() and any(target.iterdir()):
        raise OutputError(f"{target}: the folder is not empty; name a new one")
    return target


def _check_uniform(recording: ReadRecording) -> None:
    """Check that all episodes have the same observations, control step and number of actuators, at least one."""
    first = recording[0]
    if not first.described.actions:
        raise RecordingError(f"{recording.path}: this format holds actions, and this infant has none; export it to csv")
    for episode in recording:
        if _form(episode) != _form(first):
            raise RecordingError(
                f"{recording.path}: infant {episode.infant}, episode {episode.number} has other observations, movement"
                f" columns, actuators or control steps than infant {first.infant}, episode {first.number}, and this"
                " format holds one kind only; export it to csv"
            )


def _form(episode: Episode) -> Any:
    described = episode.described
    readings = {(reading.name, reading.shape, reading.dtype, reading.kind) for reading in described.readings}
    return readings, len(described.actions), described.step_ms, described.movement
