"""What a fit is of: the points that are seen, the hinges and sizes that these tell of, and where it starts."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from mimoc.motion.body_points import BodyPoint, body_points
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.movement.retargeting import prior
from mimoc.movement.retargeting.fitting import BoolArray, Problem, State
from mimoc.movement.retargeting.observations import Observed, camera_from_world
from mimoc.movement.retargeting.postures import AngleBounds, Scale, likely_postures
from mimoc.movement.retargeting.sizes import (
    LENGTH_SD,
    OVERALL_SD,
    SIZES,
    Child,
    Size,
    at_sizes,
    gives_length,
    lengths_of,
    matched,
    shape_of,
)
from mimoc.movement.retargeting.skeleton import (
    ROOT,
    Hinges,
    Shape,
    Skeleton,
    carrying,
    combined_limits,
    hinges_of,
    matrix_of,
)
from mimoc.movement.retargeting.start import TRUNK, Pitch, Start, contacts_of, pitch_of, spheres_of, start_of

THIN_HZ = 7.5  # Frames per second of the first fit, which finds postures and sizes.
FEWEST_THIN = 12  # Frames that it has at least, if there are as many.
NOISE_OF_TRUNK, NOISE_M = 0.012, 0.01  # Noise that a fit begins with: of places as a share of the trunk, and of depth.
MIN_OF_TRUNK, MIN_WITHOUT_DEPTH = 0.001, 0.007
"""Noise that is assumed at least, since no model is exact: with depth, and of one camera without it, which would take
each pixel for a difference in depth (D: fits of films without any noise are then as good as of those with 1 px)."""
HEIGHT_SD_M, KNOWN_SD_M = 0.5, 0.002  # How far the height is from where the fit starts, and from one that was measured.
AS_SURE = 8.0
"""How much surer sizes are taken to be while one camera is fitted: it tells of a limb's length only by how it is
foreshortened, and what is wrong in usual postures, or in where a joint is seen, is wrong in every frame alike."""
ROUNDS_LENGTH = 2  # How often a child is compiled again to be as long as its spec says: then it is so to .1 %.
HELD = 0.003  # Standard deviation of the mean logarithm of sizes while it is held.
ASSUMED_CAMERA = "the camera is not known: that of MINI-RGBD was assumed"
ASSUMED_SIZE = (
    "scale not known: overall size is that of the average child of the age, for one camera tells only proportions; the"
    " child's length in a spec, or the camera's height, fixes it"
)
GIVEN_SIZE = "overall size is that of the length that the spec gives; one camera tells only proportions"
CALIBRATED = (
    "one camera sees no depth: intervals of angles and lengths are as wide as simulated children that moved otherwise"
    " than is assumed asked for"
)
FAR_LENGTH = 0.02
"""Relative difference of a length that the recording gives from that of the spec which is said; a choice."""
NOT_LYING = "the trunk is upright: nothing is assumed of its contact with the floor"


@dataclass(frozen=True, slots=True)
class Noise:
    """Standard deviations of a recording."""

    places: float
    """Noise of places, in the unit of the recording."""
    depth_m: float
    least: float
    """Least noise of places."""


@dataclass(frozen=True)
class Setting:
    """What stays the same while problems of a fit differ in frames and noise."""

    recording: PointRecording  # Its points that the infant has and that are seen.
    child: Child
    hinges: Hinges
    rest: FloatArray
    sizes: tuple[Size, ...]
    shape: Shape  # At the child's sizes.
    start: Start
    height_m: float | None  # Height of the camera, if it is known.
    pitch: Pitch
    height_factors: tuple[float, float]
    """Least and largest factor on its height that this leaves, where it is estimated."""
    logs: FloatArray
    """Logarithms of the sizes that the child has, relative to the child that the fit started from, shape (s,)."""
    length_cm: float | None  # Length of the child, if its spec gives it.

    @property
    def sees_size(self) -> bool:
        """Whether the recording gives absolute size."""
        return self.recording.unit == "m" or self.recording.depth_m is not None or self.height_m is not None

    @property
    def size_is_known(self) -> bool:
        """Whether the recording or the spec gives absolute size."""
        return self.sees_size or self.length_cm is not None

    def shared_sd(self, as_sure: float = 1.0) -> FloatArray:
        """Return the SD of height and logarithms of sizes, (1 + s,), taken *as_sure* times as sure as usual."""
        height_m = HEIGHT_SD_M if self.height_m is None else KNOWN_SD_M
        overall = OVERALL_SD if self.length_cm is None else LENGTH_SD
        return np.array([height_m, overall, *(size.sd / as_sure for size in self.sizes)])

    @property
    def every(self) -> int:
        """Step, in frames, between those that the first fit takes."""
        return int(max(1, min(self.recording.rate_hz // THIN_HZ, self.recording.frames // FEWEST_THIN)))

    @property
    def free(self) -> BoolArray:
        """Which of the height and the sizes may change: overall size only if the recording tells of it."""
        return np.array([True, self.sees_size, *(True for _ in self.sizes)])

    @property
    def only_height(self) -> BoolArray:
        """The height, with sizes as they are."""
        return np.arange(2 + len(self.sizes)) == 0

    @property
    def notes(self) -> list[str]:
        """What is assumed."""
        in_pixels = self.recording.unit == "px"
        return [
            *([ASSUMED_CAMERA] if in_pixels and self.recording.camera is None else []),
            *([self.pitch.note] if in_pixels else []),
            *self._notes_on_size(),
            *([CALIBRATED] if in_pixels and self.recording.depth_m is None else []),
            *([] if self.start.lies else [NOT_LYING]),
        ]

    def _notes_on_size(self) -> Iterator[str]:
        if not self.size_is_known:
            yield ASSUMED_SIZE
        elif not self.sees_size:
            yield GIVEN_SIZE
        elif self.length_cm is not None:
            seen_cm = self.child.bundle.manifest.child.length_cm
            if abs(seen_cm / self.length_cm - 1) > FAR_LENGTH:
                yield f"the recording gives a length of {seen_cm:.1f} cm, and the spec {self.length_cm:.1f} cm"


def setting_of(
    recording: PointRecording, child: Child, height_m: float | None, pitch_deg: float | None = None
) -> Setting:
    """Return what a fit is of; a known *pitch_deg* is below the horizon, a RecordingError if impossible."""
    model = child.model
    seen = np.isfinite(recording.positions).all(-1) & (recording.confidence > 0)
    on_body = body_points(model, recording.names)
    names = [name for k, name in enumerate(recording.names) if on_body[k] and seen[:, k].any()]
    recording = recording.select(names)
    depth_m = recording.select(TRUNK).depth_m
    if depth_m is not None and not np.isfinite(depth_m).any(axis=0).all():
        recording = replace(recording, depth_m=None)
    points = [point for point in body_points(model, names) if point]
    hinges = hinges_of(model, points)
    rest = model.key("supine").qpos.copy()
    shape = shape_of(child, lambda other: _points(other, names), SIZES)
    moved = [_moves(model, points, shape, 2 + index, len(names)) for index in range(len(SIZES))]
    sizes = tuple(size for size, moves in zip(SIZES, moved, strict=True) if moves)
    columns = [0, 1, *(2 + index for index, moves in enumerate(moved) if moves)]
    shape = Shape(shape.bodies_m[..., columns], shape.anchors_m[..., columns], shape.points_m[..., columns])
    pitch = pitch_of(recording, model, pitch_deg)
    trunk = _resting(model, rest, [point for point in body_points(model, TRUNK) if point])
    root = rest[:3], matrix_of(rest[3:7])
    start, *others = (
        start_of(recording.filled(), trunk, *root, height_m, camera_from_world(deg))
        for deg in dict.fromkeys((pitch.deg.value, pitch.deg.low, pitch.deg.high))
    )
    heights = [1.0, *(other.height_m / start.height_m for other in others)]
    ends = (min(heights), max(heights))
    logs = np.zeros(1 + len(sizes))
    length_cm = child.bundle.manifest.child.length_cm if gives_length(child.spec) else None
    return Setting(recording, child, hinges, rest, sizes, shape, start, height_m, pitch, ends, logs, length_cm)


def problem_of(setting: Setting, recording: PointRecording, noise: Noise) -> Problem:
    """Return the problem of fitting some frames of a setting's recording."""
    model = setting.child.model
    hinges = setting.hinges
    start = setting.start
    spheres = spheres_of(model)
    points = _points(model, recording.names)
    pose = setting.rest if start.turned[2, 0] > 0 else model.key("prone").qpos
    resting = _resting(model, pose, [sphere.point for sphere in spheres])
    observed = Observed.of(recording, noise.places, noise.depth_m, setting.pitch.deg.value)
    skeleton = Skeleton(model, points, hinges, setting.rest, start.turned)
    low, high = prior.limits(model, hinges)
    sums, bounds = combined_limits(model, hinges)
    usual = np.concatenate([np.median(start.root, axis=0), prior.posture(model, hinges, setting.rest)])
    # Keeps the mean of sizes, weighted by how sure each is, as it is on average, if size is not known.
    weights = np.array([0.0, 0.0, *(size.sd**-2 for size in setting.sizes)])
    return Problem(
        skeleton=skeleton,
        shape=setting.shape,
        observed=observed,
        contacts=contacts_of(spheres, len(recording.names), resting[:, 2] if start.lies else None),
        rate_hz=recording.rate_hz,
        chain=prior.chain(prior.usual_of(hinges), recording.frames, recording.rate_hz),
        mean=np.tile(usual, (recording.frames, 1)),
        low=low,
        high=high,
        sums=sums,
        sum_bounds=bounds,
        shared_mean=np.array([start.height_m, *(-setting.logs)]),
        shared_sd=setting.shared_sd(1.0 if observed.tells_size else AS_SURE),
        held=weights / weights.sum() / HELD if not setting.sees_size else 0 * weights,
        pull=np.zeros(2 + len(setting.sizes)),
    )


def first_state(setting: Setting, problem: Problem) -> State:
    """Return likely postures, the trunk placed and turned as it is seen."""
    x, start = problem.mean.copy(), setting.start
    x[:, :ROOT] = start.root[:: setting.every]
    sd = np.array([usual.sd for usual in prior.usual_of(setting.hinges)[ROOT:]])
    scale = Scale(setting.recording.trunk, start.height_m, problem.rate_hz)
    bounds = AngleBounds(sd, problem.low, problem.high)
    x = likely_postures(problem.skeleton, problem.shape, problem.observed, x, bounds, scale)
    return State(x, start.height_m, np.zeros(1 + len(setting.sizes)))


def interpolated(x: FloatArray, every: int, frames: int) -> FloatArray:
    """Return unknowns of all frames from those of every second, third and so on."""
    known = np.arange(0, frames, every)
    return np.stack([np.interp(np.arange(frames), known, column) for column in x.T], axis=1)


def child_of(setting: Setting, logs: FloatArray) -> tuple[Child, float]:
    """Return the compiled child with the sizes that were fitted, and by which factor all of them were changed then.

    This is 1 unless the spec gives the length and the recording tells of proportions only. Raises a SpecError if there
    is no such child.
    """
    base = lengths_of(setting.child.model)
    names = [size.name for size in setting.sizes]
    factors = dict(zip(names, np.exp(logs[1:]).tolist(), strict=True))
    overall = float(np.exp(logs[0]))
    wanted = {name: length * overall * factors.get(name, 1.0) for name, length in base.items()}
    spec = setting.child.spec.with_(body={"size_is_known": setting.size_is_known})
    if setting.sees_size:
        return matched(spec, wanted, setting.child.bundle.manifest.child.length_cm * overall), 1.0
    child = matched(spec, {name: wanted[name] for name in names if name in wanted}, None)
    factor = 1.0
    if setting.length_cm is not None:
        for _ in range(ROUNDS_LENGTH):
            factor *= setting.length_cm / child.bundle.manifest.child.length_cm
            child = matched(child.spec, {name: factor * length for name, length in wanted.items()}, None)
    return child, factor


def of_child(setting: Setting, child: Child, logs: FloatArray) -> Setting:
    """Return the setting with a child that has been compiled with the sizes *logs* of the one before.

    Vectors are those of the compiled child; derivatives by sizes are those of the child before at these sizes.
    """
    scaled = at_sizes(setting.shape, logs)
    points = _points(child.model, setting.recording.names)
    vectors = child.model.body_pos, child.model.jnt_pos, np.array([point.offset_m for point in points])
    pairs = zip(vectors, (scaled.bodies_m, scaled.anchors_m, scaled.points_m), strict=True)
    columns = [np.concatenate([v[..., None], v[..., None], s[..., 2:]], axis=-1) for v, s in pairs]
    rest = setting.rest.copy()
    return replace(setting, child=child, rest=rest, shape=Shape(*columns), logs=setting.logs + logs)


def points_of(problem: Problem, state: State) -> FloatArray:
    """Return where the model's points are in the world, shape (t, k, 3)."""
    pose = problem.skeleton.pose(state.x, at_sizes(problem.shape, state.logs))
    return np.moveaxis(pose.points_m[:, :, : problem.observed.places.shape[1], 0], 0, -1)


def usual_noise(recording: PointRecording) -> Noise:
    """Return the noise that a fit begins with."""
    flat = recording.unit == "px" and recording.depth_m is None
    least = (MIN_WITHOUT_DEPTH if flat else MIN_OF_TRUNK) * recording.trunk
    return Noise(NOISE_OF_TRUNK * recording.trunk if recording.unit == "px" else NOISE_M, NOISE_M, least)


def _points(model: mujoco.MjModel, names: tuple[str, ...] | list[str]) -> list[BodyPoint]:
    """Return the points of a recording on a model, and then those of its contacts."""
    return [point for point in body_points(model, names) if point] + [sphere.point for sphere in spheres_of(model)]


def _resting(model: mujoco.MjModel, rest: FloatArray, points: list[BodyPoint]) -> FloatArray:
    """Return where points of the resting infant are in the world, shape (k, 3)."""
    data = mujoco.MjData(model)
    data.qpos[:] = rest
    mujoco.mj_kinematics(model, data)
    return np.array([data.xpos[p.body] + data.xmat[p.body].reshape(3, 3) @ p.offset_m for p in points])


def _moves(model: mujoco.MjModel, points: list[BodyPoint], shape: Shape, column: int, count: int) -> bool:
    if np.abs(shape.points_m[:count, :, column]).max() > 1e-6:
        return True
    bodies = carrying(model, [point.body for point in points])
    return bool(np.abs(shape.bodies_m[sorted(bodies - {int(model.jnt_bodyid[0])}), :, column]).max() > 1e-6)
