"""One episode of a recording for a page: how the infant and what is around it moved, what it felt, saw and did."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MimocError
from mimoc.bundle.io import Bundle
from mimoc.compiler.building import build
from mimoc.compiler.variants import spec_of
from mimoc.motion.labels import BONES
from mimoc.movement.retargeting.folder import is_retargeted, read_retargeted
from mimoc.recording.reading import Episode, ReadRecording
from mimoc.recording.replaying import chosen_episodes, replay_recording
from mimoc.recording.video import SMALL, Mp4
from mimoc.runtime.infant import Infant
from mimoc.runtime.model_fields import expression_of
from mimoc.runtime.sense import Observation
from mimoc.viewer.appearance import bodies_around, describe_surroundings
from mimoc.viewer.encoding import EncodedArrays
from mimoc.viewer.growth import Own, own_parts
from mimoc.viewer.page import Place, Progress, composed, describe, fill, move_bodies, move_home, with_surroundings

FRAMES = 3000  # Frames of a page, at most: half a minute of every control step, or more of every other one and so on.
MAX_SHOWN = 1e300  # Largest number that is shown: the difference of two must be finite, too.
LEVELS = 65535  # Steps between the least and the largest value of a curve.

Array = npt.NDArray[Any]


def page_of_recording(
    recording: ReadRecording,
    infant: int | None = None,
    number: int | None = None,
    physics: bool = False,
    progress: Progress = lambda *_: None,
) -> tuple[str, str | None]:
    """Return the page of an episode, which is simulated again for it, and the first number that did not come out again.

    It is of the first infant and its first episode if these are not said. With *physics*, the page contains MuJoCo, so
    that the recorded actions can be tried again.

    Raises:
        RecordingError: If there is no such episode, or it cannot be simulated again.
        RenderingError: If the infant sees, and there is no OpenGL here.
        MimocError: See `mimoc.viewer.page.page_of`.
    """
    episode = chosen_episodes(recording, infant, number)[0]
    packed = EncodedArrays()
    bundle = recording.bundle(episode.infant)
    alone = build(spec_of(bundle)) if bundle.manifest.prefix else None
    if alone and physics:
        raise MimocError("physics on a page is that of a single infant, and this one shares its world with others")
    data = packed.put(describe(alone or bundle, physics))
    replayed, difference, model = describe_episode(recording, episode, progress, alone)
    if alone:
        replayed |= with_surroundings(data, replayed["surroundings"], model) | {"name": bundle.manifest.name}
    return fill({**data, **replayed}, packed), difference


def describe_episode(
    recording: ReadRecording, episode: Episode, progress: Progress = lambda *_: None, alone: Bundle | None = None
) -> tuple[dict[str, Any], str | None, mujoco.MjModel]:
    """Return what a page knows of an episode, which is simulated again.

    Args:
        recording: The recording.
        episode: The episode.
        progress: Called with how much is done, and how much there is to do.
        alone: An infant that shares its world with others, as it is alone: the page shows it where it starts then, with
            the others around it, as their solids.

    Returns:
        What the page knows, the first number that did not come out again, if any, and the first model.
    """
    film = _Film(-(-(episode.steps + 1) // FRAMES), alone)
    (replayed,) = replay_recording(
        recording, infant=episode.infant, episode=episode.number, watch=film, progress=progress
    )
    kept = list(range(0, episode.steps + 1, film.stride))
    data = {
        "surroundings": film.surroundings,
        "recording": {
            "episode": episode.number,
            "infant": episode.infant if recording.infants > 1 else None,
            "seconds": episode.time_s[kept] - episode.time_s[0],
            **film.describe(),
            "curves": list(_curves(episode, kept)),
            "pictures": dict(_videos(episode)),
            "picture_s": episode.step_ms / 1000,
            "stride": film.stride,
            "points": points_of(recording.path) if (episode.infant, episode.number) == (0, 0) else None,
        },
    }
    assert film.model
    return data, str(replayed) if replayed.difference else None, film.model


@dataclass(slots=True)
class _Film:
    """Keeps the motion of an infant while it is simulated again."""

    stride: int  # Control steps from one frame to the next.
    alone: Bundle | None = None  # An infant that shares its world, as it is alone.
    model: mujoco.MjModel | None = None  # The first model.
    surroundings: dict[str, Any] = field(default_factory=dict)
    frames: list[tuple[Array, float, str | None, Array]] = field(default_factory=list)
    """Configuration, age in months, expression, and places of the bodies around, shape (bodies, 7)."""
    felt: list[tuple[Array, Array]] = field(default_factory=list)
    """Skin points with any force, and its size, [N], as observed."""
    _own: Own | None = None
    _move: Place | None = None  # Brings it from where it starts in its world to where it starts alone.
    _row: int = 0

    def __call__(self, env: Infant, observation: Observation) -> None:
        if self._own is None:
            self.model = env.model
            self._own = own_parts(env.model, env.manifest)
            self.surroundings = describe_surroundings(env.model, env.data, self._own, solids=bool(self.alone))
            if self.alone:
                self._move = move_home(self.alone, env.bundle, env.model)
                move_bodies(self.surroundings["bodies"], self._move)
        self._row += 1
        if (self._row - 1) % self.stride:
            return
        bodies = bodies_around(env.model, self._own, solids=bool(self.alone))
        around = np.concatenate([env.data.xpos[bodies], env.data.xquat[bodies]], axis=1)
        qpos = env.data.qpos[self._own.qpos]
        if self._move is not None:
            for place in (*around, qpos[:7]):
                place[:] = np.concatenate(composed(self._move, (place[:3].copy(), place[3:].copy())))
        age_months = env.manifest.child.age_months
        expression = expression_of(env.manifest, env.model)
        self.frames.append((qpos, age_months, expression, around))
        if "touch" in observation:
            forces_n = np.linalg.norm(observation["touch"].reshape(len(env.skin.bodies), -1), axis=1)
            touched = np.flatnonzero(forces_n)
            self.felt.append((touched, forces_n[touched]))

    def describe(self) -> dict[str, Any]:
        """Return what was kept; what is around the infant only if it moves."""
        qpos, ages_months, shown, places = zip(*self.frames, strict=True)
        around = np.stack(places) if len({frame.shape for frame in places}) == 1 else np.zeros((1, 0, 7))
        expressions = [name for name in dict.fromkeys(shown) if name is not None]
        ends = np.cumsum([0, *(len(points) for points, _ in self.felt)])
        return {
            "qpos": np.stack(qpos),
            "frame_ages_months": np.array(ages_months),
            "expressions": {
                "names": expressions,
                "shown": np.array([expressions.index(name) for name in shown if name]),
            }
            if expressions
            else None,
            "around": around if np.ptp(around, axis=0).any() else None,
            "felt": {
                "ends": ends.astype(np.uint32),
                "points": np.concatenate([points for points, _ in self.felt]).astype(np.uint32),
                "forces_n": np.concatenate([forces for _, forces in self.felt]),
            }
            if self.felt
            else None,
        }


TOUCH = "sum of the sizes of forces, those of self-touch on both sides [N]"
"""What a page has of touch: a contact of the infant with itself counts twice, for both parts of the body feel it."""
VECTOR = " x [N]", " world x [N]"  # How the name of the first number of a point ends whose force has three.


def _curves(episode: Episode, rows: list[int]) -> Iterator[dict[str, Any]]:
    """Yield all that was recorded as numbers but touch, of which a page has the sum."""
    yield _curve("action", episode.layout("action"), episode.column("action")[rows])
    yield _curve("reward", ("reward",), episode.column("reward")[rows, None])
    for reading in episode.described.readings:
        if reading.name == "touch":
            is_vector = any(label.endswith(VECTOR) for label in reading.layout[:1])
            forces = episode.observation(reading.name)[rows].reshape(len(rows), -1, 3 if is_vector else 1)
            yield _curve("touch", (TOUCH,), np.linalg.norm(forces.astype(float), axis=-1).sum(axis=1, keepdims=True))
        elif reading.kind == "dense":
            values = episode.observation(reading.name)[rows]
            yield _curve(reading.name, reading.layout, values.reshape(len(rows), -1))


def _curve(name: str, layout: tuple[str, ...], values: Array) -> dict[str, Any]:
    """Return numbers by time, each in whole steps between its least and its largest value; NaN is 0."""
    known = np.clip(np.nan_to_num(values.astype(float)), -MAX_SHOWN, MAX_SHOWN)
    low, high = known.min(axis=0), known.max(axis=0)
    levels = np.rint((known - low) / np.where(high > low, high - low, 1) * LEVELS) - LEVELS // 2 - 1
    return {
        "name": name,
        "layout": list(layout) or [str(index) for index in range(values.shape[1])],
        "low": low,
        "high": high,
        "levels": levels.T.astype(np.int64),
    }


def _videos(episode: Episode) -> Iterator[tuple[str, bytes]]:
    for reading in episode.described.readings:
        if reading.kind == "picture":
            with TemporaryDirectory() as folder:
                video = Mp4(Path(folder, "seen.mp4"), episode.described.rate_hz, SMALL)
                for picture in episode.observation(reading.name):
                    video.add(picture)
                content = video.save().read_bytes()
            yield reading.name, content


EDGE = 0.06  # Empty margin around the points, as a share of the larger side of their picture.
FROM_ABOVE = np.array([1.0, -1.0])  # How places in space are drawn: x to the right, y upwards.


def points_of(folder: Path) -> dict[str, Any] | None:
    """Return the points of a retargeted recording, or None; MimocError if they are damaged."""
    if not is_retargeted(folder):
        return None
    retargeted = read_retargeted(folder)
    recording = retargeted.recording
    names = retargeted.recording.names
    distances = np.linalg.norm(recording.positions - retargeted.fitted.positions, axis=-1) / recording.trunk
    recorded = _drawn(recording.positions)
    fitted = _drawn(retargeted.fitted.positions)
    known = [bone for bone in BONES if {*bone} <= {*names}]
    both = np.concatenate([recorded, fitted]).reshape(-1, 2)
    low, high = np.nanmin(both, axis=0), np.nanmax(both, axis=0)
    edge = EDGE * float((high - low).max())
    return {
        "rate_hz": recording.rate_hz,
        "bones": np.array([[names.index(point) for point in bone] for bone in known], np.uint32).reshape(-1, 2),
        "recorded": recorded,
        "fitted": fitted,
        "errors": _medians(distances),
        "box": np.concatenate([low - edge, high - low + 2 * edge]),
    }


def _drawn(positions: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return positions if positions.shape[-1] == 2 else positions[..., :2] * FROM_ABOVE


def _medians(distances: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the median of each row, shape (t,); NaN for a row without any number."""
    known = np.isfinite(distances)
    filled = np.where(known, distances, np.inf)
    order = np.sort(filled, axis=1)
    count = known.sum(axis=1)
    rows = np.arange(len(order))
    middle = (order[rows, np.maximum(count - 1, 0) // 2] + order[rows, np.minimum(count // 2, order.shape[1] - 1)]) / 2
    return np.where(count > 0, middle, np.nan)
