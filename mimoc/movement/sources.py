"""The infants whose movement is measured: in recordings of points, in mimoc's recordings, or simulated for it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mimoc.base.errors import MimocError, MovementError
from mimoc.motion.reading import read_points
from mimoc.movement.filming import Filmed
from mimoc.movement.simulated import SECONDS, Progress, film_policy, film_recording, no_progress

POINTS = "points.npz"
"""The recorded points in a folder that `mimoc retarget` wrote."""
RECORDING, COHORT = "recording.json", "cohort.json"
"""Marks of the folders of mimoc's recordings and of cohorts."""
BUNDLE = "manifest.json"
SPECS = ".yaml", ".yml"
MOST = 1000
"""Recordings in one folder."""


@dataclass(frozen=True)
class SourceOptions:
    """What is said of a source besides its path."""

    rate_hz: float | None = None
    """Frames per second of recorded points, where the files do not say it."""
    policy: str | None = None
    """Policy of a bundle or a spec, which is simulated."""
    seeds: Sequence[int] = range(12)
    seconds: float = SECONDS


def films_in(path: Path, options: SourceOptions | None = None, progress: Progress = no_progress) -> list[Filmed]:
    """Return the infants that a path stands for.

    Args:
        path: A recording of points, or a folder of such; a recording of mimoc's, whose episodes are simulated again; a
            folder that `mimoc retarget` wrote; a cohort's folder, with all recordings in it; or, with a policy, a
            bundle or a spec.
        options: What else is said of them.
        progress: Called with the number of control steps done and their total, while something is simulated.

    Raises:
        MimocError: If there is nothing that can be measured.
    """
    options = options or SourceOptions()
    is_infant = path.suffix.lower() in SPECS or (path / BUNDLE).is_file()
    if is_infant and not options.policy:
        raise MovementError(f"{path}: an infant, not a recording; say how it moves with --policy, such as random")
    if options.policy and not is_infant:
        raise MovementError(f"{path}: --policy is for a bundle or a spec, which is simulated; leave it out")
    if is_infant:
        return [*film_policy(path, str(options.policy), options.seeds, options.seconds, progress)]
    if not path.exists():
        raise MovementError(f"{path}: does not exist; name a recording, or the folder of one")
    return _recorded(path, options, progress)


def _recorded(path: Path, options: SourceOptions, progress: Progress) -> list[Filmed]:
    if (path / POINTS).is_file():
        return [Filmed(read_points(path / POINTS))]
    if (path / RECORDING).is_file():
        return [*film_recording(path, progress)]
    if (path / COHORT).is_file():
        folders = [mark.parent for mark in _first(path.rglob(RECORDING), path)]
        if not folders:
            raise MovementError(f"{path}: a cohort without recordings; its steps must record what is to be measured")
        return [film for folder in folders for film in film_recording(folder, progress)]
    try:
        return [Filmed(read_points(path, rate_hz=options.rate_hz))]
    except MimocError:
        if not path.is_dir():
            raise
        inside = _first((item for item in path.iterdir() if not item.name.startswith(".")), path)
        films = [Filmed(recording) for item in inside if (recording := _read(item, options))]
        if not films:
            raise
        return films


def _read(path: Path, options: SourceOptions):
    """Return the points in something in a folder, or None if there are none."""
    try:
        return read_points(path, rate_hz=options.rate_hz)
    except MimocError:
        return None


def _first(paths: Iterator[Path], folder: Path) -> list[Path]:
    """Return paths in their order, or raise a MovementError if there are too many."""
    chosen = []
    for path in paths:
        chosen.append(path)
        if len(chosen) > MOST:
            raise MovementError(f"{folder}: more than {MOST} recordings are in this folder; divide it")
    return sorted(chosen)
