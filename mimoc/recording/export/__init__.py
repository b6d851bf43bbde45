"""Recordings in the formats of others: Minari, LeRobot and CSV."""

import os
import secrets
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from mimoc.errors import OutputError, RecordingError, UnknownNameError
from mimoc.recording.export.csv import export_csv
from mimoc.recording.export.lerobot import export_lerobot
from mimoc.recording.export.minari import export_minari
from mimoc.recording.reading import Episode, ReadRecording, read_recording

Progress = Callable[[int, int], None]
"""Called with how much is written, and how much there is."""
Export = Callable[[ReadRecording, Sequence[Episode], Path, Progress], Iterable[str]]
"""Writes episodes into an empty folder, and returns what the format cannot hold, one line each."""
FORMATS: Mapping[str, Export] = {"minari": export_minari, "lerobot": export_lerobot, "csv": export_csv}


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
        to: `minari`, `lerobot` or `csv`.
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
    if to not in FORMATS:
        raise UnknownNameError("format of recordings", to, FORMATS)
    found = recording if isinstance(recording, ReadRecording) else read_recording(recording)
    episodes = [episode for episode in found if episode.steps]
    if not episodes:
        raise RecordingError(f"{found.path}: there are no control steps in this recording")
    empty = len(found) - len(episodes)
    notes = [f"{empty} episodes without any control step are left out"] if empty else []
    target = Path(out).expanduser()
    _check_free(target)
    staging = target.absolute().parent / f".{target.name}.mimoc-{secrets.token_hex(8)}"
    try:
        staging.mkdir(parents=True)
        notes += FORMATS[to](found, episodes, staging, progress)
        if target.is_dir():
            target.rmdir()
        os.rename(staging, target)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written ({error.strerror}); choose another folder") from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)
    return tuple(notes)


def _check_free(target: Path) -> None:
    """Check that a folder is new or empty.

    Raises:
        OutputError: If it is not.
    """
    if os.path.lexists(target) and not target.is_dir():
        raise OutputError(f"{target}: this is a file; name a new folder")
    if target.is_dir() and any(target.iterdir()):
        raise OutputError(f"{target}: the folder is not empty; name a new one")
