"""What builders of scenes take and return, and the floor that an infant in a pose covers and reaches."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mimoc.base.geometry.reach import leaning_reach
from mimoc.body.kinematics import FloatArray, Posed, hip_in_world, pose
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree, Geom
from mimoc.compiler.mjcf.elements import DirectionalLight, Headlight
from mimoc.compiler.mjcf.world import World
from mimoc.compiler.toys import FADING, ReachableFloor

FINE = 0.5  # Distance of the discs that cover a long part, in its radii.
NOT_OF_ARMS = ("leg", "foot", "toe", "eye")  # Parts of the names of a side's other geoms.


def footprint(tree: BodyTree, states: Sequence[Sequence[float]]) -> FloatArray:
    """Return discs that cover an infant in some states (qpos), seen from above: x, y and radius, shape (n, 3), [m]."""
    return np.concatenate([np.array(list(_discs(_placed(tree, state)))) for state in states])


def reach_of(discs: FloatArray) -> float:
    """Return how far some discs reach from the origin, in [m]."""
    return float((np.linalg.norm(discs[:, :2], axis=1) + discs[:, 2]).max())


def reachable_floor(tree: BodyTree, state: Sequence[float]) -> ReachableFloor | None:
    """Return the floor that an infant's hands reach from a pose with the arms stretched; None without arms."""
    placed, stretched = _placed(tree, state), pose(tree, {})
    shoulders, lengths = [], []
    for side in ("right", "left"):
        upper_arm = f"{side}_uarm1"
        if upper_arm in tree.geoms:
            shoulders.append(_shoulder(placed, upper_arm))
            lengths.append(_arm_length(stretched, upper_arm, side))
    if not shoulders:
        return None
    length_m, (x_m, y_m, height_m) = max(lengths), np.mean(shoulders, axis=0).tolist()
    across_m = float(np.linalg.norm(np.subtract(shoulders, (x_m, y_m, height_m))[:, :2], axis=1).max())
    return ReachableFloor((x_m, y_m), across_m + leaning_reach(length_m, height_m, state[2]), FADING * length_m)


@dataclass(frozen=True, slots=True)
class Arm:
    """An arm in a pose."""

    shoulder_m: FloatArray  # Where it begins in the world, shape (3,).
    length_m: float  # From there to the tip of the hand.
    on_floor_m: float  # How far from below the shoulder the hand reaches the floor, if the infant leans over.


def arm_of(tree: BodyTree, state: Sequence[float], side: str) -> Arm | None:
    """Return an arm of an infant in a state (qpos); None without it."""
    upper_arm = f"{side}_uarm1"
    if upper_arm not in tree.geoms:
        return None
    shoulder_m = _shoulder(_placed(tree, state), upper_arm)
    length_m = _arm_length(pose(tree, {}), upper_arm, side)
    return Arm(shoulder_m, length_m, leaning_reach(length_m, float(shoulder_m[2]), state[2]))


def _placed(tree: BodyTree, state: Sequence[float]) -> Posed:
    hip, turn = hip_in_world(state)
    posed = pose(tree, dict(zip(tree.joints, state[7:], strict=True)))
    return Posed(posed.geoms, posed.centres @ turn.T + hip, turn @ posed.rotations)


def _shoulder(posed: Posed, upper_arm: str) -> FloatArray:
    """Return where an upper arm begins, shape (3,): at one end of its axis."""
    index = next(index for index, geom in enumerate(posed.geoms) if geom.name == upper_arm)
    return posed.centres[index] - posed.rotations[index][:, 2] * posed.geoms[index].size_m[1]


def _arm_length(posed: Posed, upper_arm: str, side: str) -> float:
    shoulder = _shoulder(posed, upper_arm)
    of_side = [(index, geom.name) for index, geom in enumerate(posed.geoms) if side in geom.name]
    arm = posed.only([index for index, name in of_side if not any(part in name for part in NOT_OF_ARMS)])
    offsets = arm.centres - shoulder
    distances = np.linalg.norm(offsets, axis=1)
    local = np.einsum("nij,ni->nj", arm.rotations, offsets / distances[:, None])
    return float((distances + arm.extents.along(local)).max())


def _discs(posed: Posed) -> Iterator[tuple[float, float, float]]:
    for geom, centre, turn in zip(posed.geoms, posed.centres, posed.rotations, strict=True):
        axis, half_m, radius_m = _spine(geom)
        count = max(1, math.ceil(2 * half_m / (FINE * radius_m)) + 1)
        for offset_m in np.linspace(-half_m, half_m, count) if count > 1 else (0.0,):
            x, y, _ = centre + turn[:, axis] * offset_m
            yield float(x), float(y), radius_m


def _spine(geom: Geom) -> tuple[int, float, float]:
    """Return the axis along which a geom is longest, how long, halved, and the radius of discs that cover it."""
    if geom.type == "box":
        axis = int(np.argmax(geom.size_m))
        return axis, geom.size_m[axis], math.hypot(*np.delete(geom.size_m, axis))
    if geom.type in ("sphere", "ellipsoid"):
        return 2, 0.0, max(geom.size_m)
    return 2, geom.size_m[1], geom.size_m[0]


WEIGHTLESS = (0.0, 0.0, 0.0)
ENDLESS_M = (1e3, 1e3)  # Half size of a floor without walls.
HEADLIGHT = Headlight((0.66, 0.66, 0.66), (0.08, 0.08, 0.08))

SUN = DirectionalLight("sun", (1.8, -0.9, 2.4), (-0.6, 0.3, -0.8), (0.46, 0.46, 0.46), castshadow=True)
WINDOW = DirectionalLight("window", (1.2, -0.6, 3.0), (-0.4, 0.2, -1.0), (0.3, 0.3, 0.3), castshadow=True)
"""Daylight indoors."""


@dataclass(frozen=True, slots=True)
class Placement:
    """Where an infant is on the floor."""

    x_m: float
    y_m: float
    yaw_rad: float  # About the vertical, 0 to 2 pi.


ORIGIN = Placement(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Occupant:
    """The infant that a scene is built for."""

    body: BodyTree
    discs: FloatArray
    """The floor that it covers in all its poses, at the origin: discs by x, y and radius, shape (n, 3), [m].

    Empty if the kind of scene does not need it.
    """


@dataclass(frozen=True, slots=True)
class BuiltScene:
    """A world without toys, where the infant is in it, and where toys can be."""

    world: World
    start: Placement = ORIGIN
    half_size_m: tuple[float, float] = ENDLESS_M
    """Half lengths along x and y of the floor that toys can be on, at z = 0, with its middle at the origin."""
    origins: Mapping[str, Entry] = field(default_factory=dict)
    """Where its numbers come from, by key in `provenance.json`."""
