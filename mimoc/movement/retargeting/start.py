"""Where a fit starts: the resting infant, placed and turned as its trunk is seen in each frame."""

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.errors import RecordingError
from mimoc.motion.body_points import BodyPoint, body_points, locate
from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import MINI_RGBD_CAMERA, FloatArray, PointRecording
from mimoc.movement.retargeting.observations import STRAIGHT_DOWN_DEG, camera_from_world
from mimoc.movement.retargeting.result import LEVEL, Interval
from mimoc.movement.retargeting.skeleton import IntArray, Pose, Skeleton, exponential, rotation_vector

TRUNK = "neck", "left_hip", "right_hip"
SHOULDERS = "left_shoulder", "right_shoulder"
UPRIGHT = 0.7  # Cosine of the angle between trunk and vertical from which an infant is not taken to lie.


@dataclass(frozen=True)
class Start:
    """The root of an infant in each frame, and the height of the camera."""

    turned: FloatArray  # Mean orientation of the root, shape (3, 3).
    root: FloatArray  # Place, and rotation vector relative to the mean orientation, shape (t, 6).
    height_m: float
    lies: bool  # Whether the trunk is closer to horizontal than to vertical.
    face_down: float  # Share of the frames in which the front of the trunk looks down.


def start_of(
    recording: PointRecording,
    resting_m: FloatArray,
    root_m: FloatArray,
    turned: FloatArray,
    height_m: float | None,
    turn: FloatArray,
) -> Start:
    """Return where to start, from a recording without gaps.

    *resting_m* are neck, left and right hip of the infant on its back on the floor, shape (3, 3), with its root at
    *root_m*, of the orientation *turned*; *turn* is `camera_from_world`. A height of the camera that is not known
    follows, in two dimensions, from the trunk's length.
    """
    if recording.unit == "px" and recording.depth_m is None:
        return _of_pixels(recording, resting_m, root_m, turned, height_m, turn)
    seen_m, height_m = _in_space(recording, height_m, root_m[2], turn)
    return _of_places(seen_m, resting_m, root_m, turned, height_m)


def on_ground(recording: PointRecording, turn: FloatArray) -> FloatArray:
    """Return where rays to pixels meet a level plane one unit below the camera, shape (t, k, 2); NaN above it."""
    camera = recording.camera or MINI_RGBD_CAMERA
    across = (recording.positions - camera.centre_px) / camera.focal_px
    rays = np.concatenate([across, np.ones((*across.shape[:2], 1))], axis=-1) @ turn
    return np.where(rays[..., 2:] < 0, rays[..., :2] / np.maximum(-rays[..., 2:], 1e-9), np.nan)


def _of_pixels(
    recording: PointRecording,
    resting_m: FloatArray,
    root_m: FloatArray,
    turned: FloatArray,
    height_m: float | None,
    turn: FloatArray,
) -> Start:
    neck, hips = resting_m[0], resting_m[1:].mean(axis=0)
    ground, names = on_ground(recording, turn), recording.names
    place = {name: ground[:, names.index(name)] for name in (*TRUNK, *({*SHOULDERS} & {*names}))}
    a = place["neck"]
    b = (place["left_hip"] + place["right_hip"]) / 2
    if height_m is None:
        trunk = np.nanpercentile(np.linalg.norm(a - b, axis=1), 75)
        height_m = float(np.linalg.norm((neck - hips)[:2]) / trunk + neck[2])
    a, b = (height_m - neck[2]) * a, (height_m - neck[2]) * b
    face_down = _face_down(a - b, *(place[name] for name in SHOULDERS)) if {*SHOULDERS} <= {*names} else 0.0
    if face_down > 0.5:
        # The infant is turned about the long axis of its trunk to its front.
        axis = (neck - hips) * [1.0, 1.0, 0.0]
        half = exponential(np.pi * (axis / np.linalg.norm(axis))[None])[0][0]
        turned = half @ turned
        neck = root_m + half @ (neck - root_m)
        hips = root_m + half @ (hips - root_m)
    yaw = np.unwrap(np.arctan2(*(a - b).T[::-1])) - np.arctan2(*(neck - hips)[1::-1])
    mean = float(np.median(yaw))
    root = np.zeros((len(a), 6))
    root[:, 5] = yaw - mean
    offset = exponential(np.stack([0 * yaw, 0 * yaw, yaw], axis=-1))[0] @ (root_m - (neck + hips) / 2)
    root[:, :3] = offset + np.concatenate([(a + b) / 2, np.full((len(a), 1), (neck + hips)[2] / 2)], axis=1)
    return Start(exponential(np.array([[0.0, 0.0, mean]]))[0][0] @ turned, root, height_m, True, face_down)


def _face_down(up: FloatArray, left: FloatArray, right: FloatArray) -> float:
    """Return the share of frames in which shoulders are swapped: from above, a supine left is to the right of up."""
    across = left - right
    return float(np.mean(up[:, 0] * across[:, 1] - up[:, 1] * across[:, 0] > 0))


def _in_space(
    recording: PointRecording, height_m: float | None, resting_m: float, turn: FloatArray
) -> tuple[FloatArray, float]:
    """Return neck and hips in the world, shape (t, 3, 3), and the height; they lie as high as the resting infant's."""
    index = [recording.names.index(name) for name in TRUNK]
    if recording.depth_m is None:
        lowest = np.nanpercentile(recording.positions[:, index, 2], 10)
        offset = height_m if height_m is not None else float(lowest - resting_m)
        return recording.positions[:, index] - [0.0, 0.0, offset], offset
    camera = recording.camera or MINI_RGBD_CAMERA
    depth = recording.depth_m[:, index, None]
    across = (recording.positions[:, index] - camera.centre_px) / camera.focal_px * depth
    below = np.concatenate([across, depth], axis=-1) @ turn
    height_m = height_m if height_m is not None else float(resting_m - np.nanpercentile(below[..., 2], 10))
    return below + np.array([0.0, 0.0, height_m]), height_m


def _of_places(
    seen_m: FloatArray, resting_m: FloatArray, root_m: FloatArray, turned: FloatArray, height_m: float
) -> Start:
    """Return the start from neck and hips in space: their triangle is laid on the model's in each frame."""
    model = _frame(resting_m)
    turns = np.array([_frame(triangle) @ model.T for triangle in seen_m])
    left, _, right = np.linalg.svd(np.mean(turns[np.isfinite(turns).all((1, 2))], axis=0))
    mean = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    vectors = np.array([rotation_vector(turn @ mean.T) for turn in turns])
    places = seen_m.mean(axis=1) + turns @ (root_m - resting_m.mean(axis=0))
    lies = abs((mean @ model)[2, 0]) < UPRIGHT
    face_down = float(np.mean((turns @ model)[:, 2, 2] < 0)) if lies else 0.0
    return Start(mean @ turned, np.concatenate([places, _continuous(vectors)], axis=1), height_m, bool(lies), face_down)


def _frame(triangle: FloatArray) -> FloatArray:
    """Return the axes of a trunk as columns: up along it, to its left, and forwards."""
    neck, left, right = triangle
    up = neck - (left + right) / 2
    up = up / np.linalg.norm(up)
    across = left - right - ((left - right) @ up) * up
    across = across / np.linalg.norm(across)
    return np.stack([up, across, np.cross(across, up)], axis=1)


def _continuous(vectors: FloatArray) -> FloatArray:
    """Return rotation vectors without jumps: w and w (1 - 2 pi / |w|) are the same rotation."""
    result = vectors.copy()
    for index in range(1, len(result)):
        angle = np.linalg.norm(result[index])
        if angle > 1e-6:
            other = result[index] * (1 - 2 * np.pi / angle)
            if np.linalg.norm(other - result[index - 1]) < np.linalg.norm(result[index] - result[index - 1]):
                result[index] = other
    return result


SINK_M = 0.004  # Depth by which a part may sink into the floor or another part, as a standard deviation.
LIE_M = {"lb": 0.006, "ub2": 0.006, "head": 0.012}
"""How far hip, chest and head of one who lies are from where they are at rest, as a standard deviation; and how long
that stays alike:"""
LIE_S = 4.0
SOFT = 0.85  # Distance at which two parts touch, over the sum of their radii: skin gives way.
_LIMBS = ("upper_arm", "lower_arm", "hand", "fingers", "mfknuckle", "lower_leg", "foot", "toes")
_LEG = ("lower_leg", "foot", "toes")


@dataclass(frozen=True, slots=True)
class Sphere:
    """A sphere on a body."""

    name: str
    point: BodyPoint
    radius_m: float


@dataclass(frozen=True, slots=True)
class Pair:
    """A sphere, and the two spheres between which there is a capsule that it may not enter; indices of spheres."""

    sphere: int
    start: int
    end: int
    distance_m: float


@dataclass(frozen=True)
class Contacts:
    """The spheres of a body, which come after the recording's points among those of its skeleton."""

    first: int  # Index of the first sphere among the points.
    radii_m: FloatArray
    lying: tuple[tuple[int, float, float], ...]
    """Spheres that lie on the floor, how high their centres are then, and its standard deviation in [m]; empty for one
    who does not lie."""
    above: tuple[int, ...]  # Spheres that are above the floor.
    pairs: tuple[Pair, ...]

    def residuals(
        self, skeleton: Skeleton, pose: Pose, rate_hz: float
    ) -> Iterator[tuple[IntArray, FloatArray, FloatArray, FloatArray]]:
        """Yield, of what touches: frames (f,), residuals (f,), and derivatives by unknowns (f, n) and sizes (f, s).

        A sphere at height z that lies at the height l gives (z - l) / sd in every frame; one of radius r that is above
        the floor min(0, z - r) / sd; one at p that may not come nearer than d to the capsule around a b
        min(0, |p - c| - d) / sd, c the point of the line from a to b that is nearest.
        """
        alike = np.sqrt(max(1.0, LIE_S * rate_hz))
        above = [(index, float(self.radii_m[index]), SINK_M) for index in self.above]
        for index, level_m, scale in (*((i, level, sd * alike) for i, level, sd in self.lying), *above):
            point = self.first + index
            gap = pose.points_m[2, :, point, 0] - level_m
            frames = np.arange(len(gap)) if index not in self.above else np.flatnonzero(gap < 0)
            if len(frames):
                jacobian = skeleton.jacobian(pose, np.array([point]), frames)[2, :, 0]
                yield frames, gap[frames] / scale, jacobian / scale, pose.points_m[2, frames, point, 1:] / scale
        for pair in self.pairs:
            yield from self._of_pair(pair, skeleton, pose)

    def _of_pair(
        self, pair: Pair, skeleton: Skeleton, pose: Pose
    ) -> Iterator[tuple[IntArray, FloatArray, FloatArray, FloatArray]]:
        indices = [self.first + index for index in (pair.sphere, pair.start, pair.end)]
        p, a, b = (pose.points_m[:, :, index, 0] for index in indices)
        along = b - a
        share = np.clip(((p - a) * along).sum(0) / np.maximum((along**2).sum(0), 1e-12), 0.0, 1.0)
        apart = p - a - share * along
        distance = np.linalg.norm(apart, axis=0)
        frames = np.flatnonzero(distance < pair.distance_m)
        if not len(frames):
            return
        direction = apart[:, frames] / np.maximum(distance[frames], 1e-6)
        weights = np.stack([np.ones(len(frames)), share[frames] - 1, -share[frames]])
        by_unknown = np.zeros((len(frames), skeleton.unknowns))
        by_size = np.zeros((len(frames), pose.points_m.shape[3] - 1))
        for index, weight in zip(indices, weights, strict=True):
            jacobian = skeleton.jacobian(pose, np.array([index]), frames)[:, :, 0]
            by_unknown += np.einsum("cf,cfn->fn", direction * weight, jacobian)
            by_size += np.einsum("cf,cfs->fs", direction * weight, pose.points_m[:, frames, index, 1:])
        frames = frames.astype(np.intp)
        yield frames, (distance[frames] - pair.distance_m) / SINK_M, by_unknown / SINK_M, by_size / SINK_M


def spheres_of(model: mujoco.MjModel) -> list[Sphere]:
    """Return the spheres of an infant: ends of its trunk's capsules, its head, its joints, hands and feet."""
    spheres = []
    for name in ("lb", "ub2", "ub3"):
        geom = model.geom(name)
        radius_m, half_m = geom.size[:2]
        axis = np.zeros(3)
        mujoco.mju_rotVecQuat(axis, np.array([0.0, 0.0, 1.0]), geom.quat)
        for end in (-1, 1):
            point = BodyPoint(int(geom.bodyid[0]), geom.pos + end * half_m * axis)
            spheres.append(Sphere(name, point, float(radius_m)))
    skull = model.geom("head")
    spheres.append(Sphere("head", BodyPoint(int(skull.bodyid[0]), skull.pos.copy()), float(skull.size.min())))
    for side in SIDES:
        for limb in _LIMBS:
            body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, f"{side}_{limb}")
            if body >= 0 and limb != "upper_arm":
                spheres.append(Sphere(f"{side}_{limb}", BodyPoint(body, np.zeros(3)), _thickness(model, body)))
    return spheres


def contacts_of(spheres: list[Sphere], first: int, resting_m: FloatArray | None) -> Contacts:
    """Return what may touch what: hands keep out of trunk and head, and legs out of each other."""
    names = [sphere.name for sphere in spheres]
    place = {name: index for index, name in enumerate(names)}
    lying = ()
    if resting_m is not None:
        lying = tuple((i, float(resting_m[i]), LIE_M[name]) for i, name in enumerate(names) if name in LIE_M)
    used = {index for index, *_ in lying}
    above = tuple(index for index in range(len(spheres)) if index not in used and names[index] != "ub3")
    capsules = [(names.index(name), names.index(name) + 1) for name in ("lb", "ub2", "ub3")]
    capsules.append((place["head"], place["head"]))
    pairs = []
    for side, other in (SIDES, SIDES[::-1]):
        hands = [f"{side}_{name}" for name in ("hand", "fingers", "mfknuckle")]
        pairs += [(place[hand], *capsule) for hand in hands if hand in place for capsule in capsules]
        shin = (f"{other}_lower_leg", f"{other}_foot"), (f"{other}_foot", f"{other}_toes")
        legs = [place[f"{side}_{name}"] for name in _LEG if f"{side}_{name}" in place]
        pairs += [(leg, place[a], place[b]) for leg in legs for a, b in shin if a in place and b in place]
    radii = np.array([sphere.radius_m for sphere in spheres])
    return Contacts(
        first,
        radii,
        lying,
        above,
        tuple(Pair(p, a, b, SOFT * float(radii[p] + min(radii[a], radii[b]))) for p, a, b in pairs),
    )


def _thickness(model: mujoco.MjModel, body: int) -> float:
    """Return the radius of the first solid of a body; of a box, half of its shortest edge."""
    geom = int(model.body_geomadr[body])
    size = model.geom_size[geom]
    return float(size.min() if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX else size[0])


CANDIDATES_DEG = np.arange(15.0, STRAIGHT_DOWN_DEG + 1)
"""Angles that are tried: all are taken to be equally likely before."""
PROPORTIONS_SD = 0.06
"""How far the points of a trunk are from those of the average child's, as a share of its length (D: with it, intervals
of simulated films at 30 to 90 degrees hold the truth; the survey has .06-.08 for widths of shoulders and hips)."""
CLEARLY = 1.25
"""Difference of log likelihood from which a camera is taken to be slanted (D: of simulated films, those at 45 degrees
have 1.3 and more, those from straight above .8 and less)."""
ALIKE = 0.17
"""Distance of the points from those of a trunk that lies, likewise, above which this says nothing: one that turns."""

STRAIGHT = "the camera is taken to look straight down on a level floor"
SLANTED = (
    "the trunk looks foreshortened: the camera is taken to look down at {deg:.0f} degrees below the horizon"
    " ({low:.0f} to {high:.0f}, 90 %), the upper edge of its picture level; if you know the angle, say it"
    " (camera_pitch_deg=, --camera-pitch; 90 is straight down)"
)
GIVEN = "the camera looks down at {deg:g} degrees below the horizon, as given, the upper edge of its picture level"


@dataclass(frozen=True)
class Pitch:
    """The angle by which a camera looks down, below the horizon: 90 degrees if it looks straight down."""

    deg: Interval
    note: str


def pitch_of(recording: PointRecording, model: mujoco.MjModel, given_deg: float | None) -> Pitch:
    """Return the given angle or, if the trunk is clearly foreshortened, that which makes it look like one that lies.

    For the angle t, rays to neck, shoulders and hips meet the floor at z_k(t), complex numbers; those of the average
    child who lies are w_k. Their distance is min_a |a z(t) - w|, the median over frames d(t), over the trunk's length;
    the likelihood of t is exp(-d(t)^2 / (2 sd^2)), with the SD of proportions of bodies. Raises a RecordingError if the
    angle is impossible, or the trunk were above the horizon then.
    """
    if given_deg is not None:
        if recording.unit == "m":
            raise RecordingError(f"{recording.name}: points in space have no camera; leave camera_pitch_deg= out")
        if not 0 < given_deg <= STRAIGHT_DOWN_DEG:
            raise RecordingError(
                f"camera_pitch_deg={given_deg:g}: give degrees below the horizon, above 0 and up to 90"
            )
        trunk = recording.select(TRUNK).filled()
        if not np.isfinite(on_ground(trunk, camera_from_world(given_deg))[np.isfinite(trunk.positions).all(-1)]).all():
            reason = f"with camera_pitch_deg={given_deg:g} the trunk would be above the horizon in some frames"
            raise RecordingError(f"{recording.name}: {reason}; give the angle by which the camera looks down")
        return Pitch(Interval(given_deg, given_deg, given_deg), GIVEN.format(deg=given_deg))
    straight = Pitch(Interval(STRAIGHT_DOWN_DEG, STRAIGHT_DOWN_DEG, STRAIGHT_DOWN_DEG), STRAIGHT)
    names = (*TRUNK, *SHOULDERS)
    if recording.unit == "m" or not {*names} <= {*recording.names} or not all(body_points(model, names)):
        return straight
    trunk = recording.select(names).filled()
    if not np.isfinite(trunk.positions).all():
        return straight
    lying_m = locate(model, model.key("supine").qpos[None], names)[0]
    distance = np.array([_distance(on_ground(trunk, camera_from_world(t)), lying_m) for t in CANDIDATES_DEG])
    losses = distance**2 / (2 * PROPORTIONS_SD**2)
    best = int(losses.argmin())
    if losses[-1] - losses[best] < CLEARLY or distance[best] > ALIKE:
        return straight
    shares = np.cumsum(np.exp(losses[best] - losses))
    low, high = (CANDIDATES_DEG[np.searchsorted(shares / shares[-1], q)] for q in ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    deg = Interval(float(CANDIDATES_DEG[best]), float(min(low, CANDIDATES_DEG[best])), float(high))
    return Pitch(deg, SLANTED.format(deg=deg.value, low=deg.low, high=deg.high))


def _distance(ground: FloatArray, lying_m: FloatArray) -> float:
    """Return the median distance of points on the ground, shape (t, k, 2), from those of one who lies, shape (k, 3)."""
    if not np.isfinite(ground).all():
        return np.inf
    seen, lying = ground @ [1, 1j], lying_m[:, :2] @ [1, 1j]
    seen = seen - seen.mean(axis=1, keepdims=True)
    lying = lying - lying.mean()
    distances = []
    for side in (seen, seen.conj()):  # On its back, and on its belly.
        factor = (side.conj() * lying).sum(axis=1) / (np.abs(side) ** 2).sum(axis=1)
        distances.append(np.median(np.sqrt((np.abs(factor[:, None] * side - lying) ** 2).sum(axis=1))))
    return float(min(distances) / np.abs(lying[0] - (lying[1] + lying[2]) / 2))
