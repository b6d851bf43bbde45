"""The infants whose movement is measured: in recordings of points, in mimoc's recordings, or simulated for it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from mimoc.base.errors import MovementError
from mimoc.base.kinds import function_of
from mimoc.motion.joint_motion import MOTION
from mimoc.motion.reading import read_again, read_points
from mimoc.movement.filming import SECONDS, Filmed, Progress, film_policy, film_recording, no_progress, noted
from mimoc.policies.policy import PolicyMaker
from mimoc.recording.folder import read_infant
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import FORMATS

POINTS = "points.npz"  # The recorded points in a folder that `mimoc retarget` wrote.
RECORDING, COHORT = "recording.json", "cohort.json"  # Marks of the folders of mimoc's recordings and of cohorts.
BUNDLE = "manifest.json"
SPECS = ".yaml", ".yml"
MOST = 1000


@dataclass(frozen=True)
class SourceOptions:
    """What is said of a source besides its path."""

    policy: str | PolicyMaker | None = None
    """Policy of a bundle or a spec, which is simulated: its name, or what makes it."""
    seeds: Sequence[int] = range(12)
    seconds: float = SECONDS
    reading: Mapping[str, Any] = field(default_factory=dict)
    """Arguments of `read_points` for recorded points, such as `rate_hz`, where the files do not say it."""


def films_in(path: Path, options: SourceOptions | None = None, progress: Progress = no_progress) -> list[Filmed]:
    """Return the infants that a path stands for; MimocError if there is nothing that can be measured.

    It is a recording of points; one of mimoc's, whose episodes are simulated again; a folder that `mimoc retarget`
    wrote; a folder of such; a cohort's folder; or, with a policy, a bundle or a spec.
    """
    options = options or SourceOptions()
    is_infant = _is_infant(path)
    if is_infant and not options.policy:
        raise MovementError(f"{path}: an infant, not a recording; say how it moves with --policy, such as random")
    if options.policy and not is_infant:
        raise MovementError(f"{path}: --policy is for a bundle or a spec, which is simulated; leave it out")
    if options.policy:
        return films_of(path, options, progress)
    if not path.exists():
        raise MovementError(f"{path}: does not exist; name a recording, or the folder of one")
    return _recorded(path, options, progress)


def reads_points(path: Path) -> bool:
    """Return whether a path stands for points that mimoc did not write itself, or for a folder that may have some."""
    return not _is_infant(path) and not any((path / mark).is_file() for mark in (POINTS, RECORDING, COHORT))


def _is_infant(path: Path) -> bool:
    return path.suffix.lower() in SPECS or (path / BUNDLE).is_file()


def films_of(infant: Path | InfantSpec, options: SourceOptions, progress: Progress = no_progress) -> list[Filmed]:
    """Return films of an infant that is simulated under the policy of some options; see `film_policy`."""
    return [*film_policy(infant, options.policy or "zero", options.seeds, options.seconds, progress)]


def _recorded(path: Path, options: SourceOptions, progress: Progress) -> list[Filmed]:
    if (path / POINTS).is_file():
        child = read_infant(path).manifest.child if (path / MOTION).is_file() else None
        return [noted(Filmed(read_again(path / POINTS)), child)]
    if (path / RECORDING).is_file():
        return [*film_recording(path, progress)]
    if (path / COHORT).is_file():
        folders = [mark.parent for mark in _first(path.rglob(RECORDING), path)]
        if not folders:
            raise MovementError(f"{path}: a cohort without recordings; give its step 'run' the option record: true")
        named = [(folder, folder.relative_to(path).as_posix()) for folder in folders]
        return [film for folder, name in named for film in film_recording(folder, progress, name)]
    if not path.is_dir() or _is_recognised(path):
        return [Filmed(read_points(path, **options.reading))]
    inside = [item for item in _first(path.iterdir(), path) if (item / RECORDING).is_file() or _is_recognised(item)]
    if not inside:
        raise MovementError(f"{path}: nothing in this folder is a recording; name one, or a folder of several")
    return [film for item in inside for film in _recorded(item, options, progress)]


def _is_recognised(path: Path) -> bool:
    hidden = path.name.startswith(".")
    return not hidden and any(function_of(kind.recognise, "recognise")(path) for kind in FORMATS.values())


def _first(paths: Iterator[Path], folder: Path) -> list[Path]:
    chosen = sorted(islice(paths, MOST + 1))
    if len(chosen) > MOST:
        raise MovementError(f"{folder}: more than {MOST} files are in this folder; divide it")
    return chosen
