"""Where a body can touch the floor and itself: spheres on bodies, and capsules of the trunk and the legs."""

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.motion.body_points import BodyPoint
from mimoc.motion.point_recording import FloatArray
from mimoc.motion.points import SIDES
from mimoc.movement.retargeting.skeleton import IntArray, Pose, Skeleton

SINK_M = 0.004
"""Depth by which a part may sink into the floor or another part, as a standard deviation."""
LIE_M = {"lb": 0.006, "ub2": 0.006, "head": 0.012}
"""How far hip, chest and head of one who lies are from where they are at rest, as a standard deviation; and how long
that stays alike:"""
LIE_S = 4.0
SOFT = 0.85
"""Distance at which two parts touch, over the sum of their radii: skin gives way."""
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

    first: int
    """Index of the first sphere among the points."""
    radii_m: FloatArray
    lying: tuple[tuple[int, float, float], ...]
    """Spheres that lie on the floor, how high their centres are then, and its standard deviation in [m]; empty for one
    who does not lie."""
    above: tuple[int, ...]
    """Spheres that are above the floor."""
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
