"""Infants whose movement is measured: recorded points, or simulated infants as a camera above them sees them.

The camera has the rate of real infants' recordings, whole pixels, and shows infants in their size.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from mimoc.base.errors import MovementError
from mimoc.base.kinds import function_of
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import ChildEntry
from mimoc.bundle.world import WorldBundle
from mimoc.compiler.provenance import SCALE_NOT_KNOWN
from mimoc.motion.body_points import locate
from mimoc.motion.joint_motion import MOTION
from mimoc.motion.labels import MINI_RGBD_POINTS, SIDES
from mimoc.motion.point_recording import MINI_RGBD_CAMERA, FloatArray, PointRecording
from mimoc.motion.reading import read_again, read_points
from mimoc.movement.measures import MIN_S
from mimoc.policies.policy import PolicyMaker
from mimoc.policies.rollout import rollout
from mimoc.recording.folder import read_infant
from mimoc.recording.reading import read_recording
from mimoc.recording.replaying import replay_recording
from mimoc.runtime.batch_env import infants_of
from mimoc.runtime.infant import Infant
from mimoc.runtime.opening import is_world_source, open_infant, shared_world
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import FORMATS

RATE_HZ = 30.0  # Frames per second of MINI-RGBD, as its files are read.
TRUNK_PX = 138.0  # Mean length of the trunk of the infants of MINI-RGBD: the camera is as high as this needs.
SETTLING_S = 1.0  # Beginning of an episode that is left out, in which an infant starts from rest.
SPACE_POINTS = (*MINI_RGBD_POINTS, *(f"{side}_{part}" for part in ("ankle", "ear") for side in SIDES), "nose")


@dataclass(frozen=True)
class Filmed:
    """An infant whose movement is measured."""

    seen: PointRecording
    """Its points, as recorded or as a camera above it sees them."""
    space: PointRecording | None = None
    """Its points in the world, [m], of a simulated infant."""


@dataclass
class Film:
    """Collects the configurations of one simulated infant after each control step, and develops them."""

    times_s: list[float] = field(default_factory=list)
    places_m: list[FloatArray] = field(default_factory=list)  # Points of blocks of control steps, shape (s, k, 3) each.
    _model: mujoco.MjModel | None = None
    _child: ChildEntry | None = None
    _prefix: str = ""
    _block: list[FloatArray] = field(default_factory=list)

    def watch(self, env: Infant, observation: object = None) -> None:
        """Keep where the infant is now; it may have grown since the last step, but not started a new episode."""
        if env.model is not self._model:
            self._locate()
            self._model = env.model
            self._child = env.manifest.child
            self._prefix = env.manifest.prefix
        self.times_s.append(float(env.data.time))
        self._block.append(env.data.qpos.copy())

    def to_recording(self, name: str) -> Filmed:
        """Return what the camera saw, without the first second; MovementError if it is too short to measure."""
        self._locate()
        times_s = np.array(self.times_s)
        times_s -= times_s[0] if len(times_s) else 0.0
        least_s = SETTLING_S + MIN_S
        if not len(times_s) or times_s[-1] < least_s - 1e-6:
            reason = f"record at least {least_s:g} s, since the first {SETTLING_S:g} s is not measured"
            raise MovementError(f"{name}: too short to measure movement; {reason}")
        return noted(film_places(name, times_s, np.concatenate(self.places_m), SETTLING_S), self._child)

    def _locate(self) -> None:
        if self._model is not None and self._block:
            self.places_m.append(locate(self._model, np.array(self._block), SPACE_POINTS, self._prefix))
            self._block.clear()


def noted(film: Filmed, child: ChildEntry | None) -> Filmed:
    """Return a film with a note if its child's scale is not known."""
    if child is None or child.size_is_known:
        return film
    notes = (*film.seen.notes, f"{SCALE_NOT_KNOWN}; measures in lengths of the trunk do not depend on it")
    return replace(film, seen=replace(film.seen, notes=notes))


def film_places(name: str, times_s: FloatArray, places_m: FloatArray, start_s: float = 0.0) -> Filmed:
    """Return what a camera that looks straight down on an infant sees at 30 frames/s, rounded to whole pixels.

    Its picture has world x to the right and world -y downwards. It stands above the mean place of the hips, at the
    height at which the trunk is as long as those of MINI-RGBD, f T / h = 138 px. Times rise, shape (s,), and places are
    those of `SPACE_POINTS` in the world, shape (s, k, 3).
    """
    count = int((times_s[-1] - start_s) * RATE_HZ + 1e-6) + 1
    frames_s = start_s + np.arange(count) / RATE_HZ
    flat = places_m.reshape(len(places_m), -1)
    world = np.stack([np.interp(frames_s, times_s, column) for column in flat.T], axis=-1)
    world = world.reshape(count, *places_m.shape[1:])
    confidence = np.isfinite(world).all(axis=-1).astype(float)
    space = PointRecording(name, RATE_HZ, SPACE_POINTS, world, confidence)
    middle = space.hips.mean(axis=0)
    height_m = MINI_RGBD_CAMERA.focal_px[0] * space.trunk / TRUNK_PX
    away = np.stack(
        [world[..., 0] - middle[0], middle[1] - world[..., 1], height_m + middle[2] - world[..., 2]], axis=-1
    )
    kept = len(MINI_RGBD_POINTS)
    pixels = np.rint(MINI_RGBD_CAMERA.project(away))[:, :kept]
    seen = PointRecording(name, RATE_HZ, MINI_RGBD_POINTS, pixels, confidence[:, :kept], MINI_RGBD_CAMERA)
    return Filmed(seen, space)


SECONDS = 33.0  # Length of the recordings of MINI-RGBD, within a third of a second.
Progress = Callable[[int, int], None]


def no_progress(done: int, total: int) -> None:
    """Show nothing."""


def film_policy(
    infant: Bundle | WorldBundle | InfantSpec | str | Path,
    policy: str | PolicyMaker,
    seeds: Sequence[int],
    seconds: float = SECONDS,
    progress: Progress = no_progress,
) -> Iterator[Filmed]:
    """Film infants of a spec, a bundle or a world under a policy, for each seed, but for the first second.

    Raises an UnknownNameError for an unknown policy, and a MovementError if an episode ends before it is filmed.
    """
    source: Any = infant
    with closing(shared_world(source) if is_world_source(source) else open_infant(source)) as env:
        infants = infants_of("film_policy", env)
        step_s = ms_to_s(env.bundle.manifest.step_ms)
        steps = round((seconds + SETTLING_S) / step_s)
        label = policy if isinstance(policy, str) else env.bundle.manifest.name
        for number, seed in enumerate(seeds):
            films, done = {name: Film() for name in infants}, number * steps
            for step in rollout(env, policy, steps=steps, seed=seed):
                film = films[step.infant]
                if step.ended:
                    ended = f"the episode ended after {film.times_s[-1]:.1f} s; give fewer --seconds, or no task"
                    raise MovementError(f"{label}, seed {seed}: {ended}")
                film.watch(infants[step.infant])
                progress(done + step.number, len(seeds) * steps)
            for name, film in films.items():
                yield film.to_recording(f"{label}, seed {seed}" + (f", {name}" if name else ""))


def film_recording(folder: Path, progress: Progress = no_progress, name: str = "") -> Iterator[Filmed]:
    """Simulate the episodes of a recording again, and film each; the first second of each is left out.

    Raises a RecordingError if it is not whole, a MovementError if an episode is too short or does not come out again.
    """
    film = Film()
    recording = read_recording(folder)
    called = name or folder.name
    steps = [sum(episode.steps for episode in recording.of_infant(number)) for number in range(recording.infants)]

    def watch(infant: Infant, _observation: object) -> None:
        film.watch(infant)

    def progress_from(done: int) -> Progress:
        return lambda steps_done, _: progress(done + steps_done, sum(steps))

    for number, infant in enumerate(recording.description.infants):
        who = f"infant {number}" if infant.world is None else infant.name
        chosen = {"infant": number, "watch": watch, "progress": progress_from(sum(steps[:number]))}
        for replayed in replay_recording(recording, **chosen) if recording.of_infant(number) else ():
            if replayed.difference is not None:
                raise MovementError(f"{folder}: cannot be measured, for it does not come out again: {replayed}")
            which = f"{called}, {who}, episode {replayed.episode.number}"
            yield film.to_recording(which if len(recording) > 1 else called)
            film = Film()


POINTS = "points.npz"  # The recorded points in a folder that `mimoc retarget` wrote.
RECORDING, COHORT = "recording.json", "cohort.json"  # Marks of the folders of mimoc's recordings and of cohorts.
BUNDLE = "manifest.json"
SPECS = ".yaml", ".yml"
MAX_RECORDINGS = 1000


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
    chosen = sorted(islice(paths, MAX_RECORDINGS + 1))
    if len(chosen) > MAX_RECORDINGS:
        raise MovementError(f"{folder}: more than {MAX_RECORDINGS} files are in this folder; divide it")
    return chosen
