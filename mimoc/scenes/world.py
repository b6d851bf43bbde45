"""What is around an infant, before toys are put there."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from mimoc.body import BodyTree
from mimoc.body.kinematics import FloatArray
from mimoc.body.stature import stature
from mimoc.geometry.rotations import matrix_from_axis, quaternion_from_axis, quaternion_product
from mimoc.mjcf.tree import Ground, Keyframe, Light, Prop, World
from mimoc.random_streams import stream
from mimoc.scenes.crib.build import crib
from mimoc.scenes.footprint import reach_of
from mimoc.scenes.room.build import HEADLIGHT, Decor, Placement, draw_room, place_infant
from mimoc.scenes.spec import SceneSpec
from mimoc.units import cm_to_m

WEIGHTLESS = (0.0, 0.0, 0.0)
UP = (0.0, 0.0, 1.0)
ENDLESS_M = (1e3, 1e3)
"""Half size of a floor without walls."""

_SUN = Light("sun", (1.8, -0.9, 2.4), (-0.6, 0.3, -0.8), (0.46, 0.46, 0.46), castshadow=True)
_WINDOW = Light("window", (1.2, -0.6, 3.0), (-0.4, 0.2, -1.0), (0.3, 0.3, 0.3), castshadow=True)
"""The sun indoors."""
ORIGIN = Placement(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Setting:
    """A world without toys, and what has a place in it."""

    world: World
    start: Placement = ORIGIN
    """Where the infant is."""
    half_size_m: tuple[float, float] = ENDLESS_M
    """Of the floor that toys can be on, at z = 0, from its middle at the origin."""


def empty_world(spec: SceneSpec, decor: Decor, tree: BodyTree, discs: FloatArray) -> Setting:
    """Return nothing at all: the infant floats."""
    return Setting(World(gravity_m_s2=WEIGHTLESS, lights=(_SUN,)))


def flat_world(spec: SceneSpec, decor: Decor, tree: BodyTree, discs: FloatArray) -> Setting:
    """Return a floor at z = 0."""
    return Setting(World(grounds=(Ground("floor", 0.0),), lights=(_SUN,)))


def crib_world(spec: SceneSpec, decor: Decor, tree: BodyTree, discs: FloatArray) -> Setting:
    """Return a crib that fits the infant, which lies on its mattress."""
    x_m, y_m = (np.abs(discs[:, :2]) + discs[:, 2:]).max(axis=0).tolist()
    made = crib(cm_to_m(stature(tree)["length_cm"]), (x_m, y_m))
    length, width = made.inner_m
    floor = Ground("floor", made.floor_m)
    world = World(grounds=(floor,), lights=(_WINDOW,), headlight=HEADLIGHT, furniture=made.furniture)
    return Setting(world, half_size_m=(length / 2, width / 2))


def room_world(spec: SceneSpec, decor: Decor, tree: BodyTree, discs: FloatArray) -> Setting:
    """Return a room drawn from the seed, the infant anywhere in it that is clear of the walls."""
    room = draw_room(spec.room.size_m, spec.seed, decor)
    depth, width, _ = room.size_m
    return Setting(
        World(headlight=room.headlight, furniture=room.furniture),
        place_infant(room.size_m, reach_of(discs), stream(spec.seed, "infant.place")),
        (depth / 2, width / 2),
    )


WORLDS: Mapping[str, Callable[[SceneSpec, Decor, BodyTree, FloatArray], Setting]] = {
    "empty": empty_world,
    "flat": flat_world,
    "crib": crib_world,
    "room": room_world,
}
"""By kind of scene; each is told the discs that the infant takes up in all its poses, which are at the origin."""


def put(pose: Keyframe, start: Placement) -> Keyframe:
    """Return a pose somewhere else on the floor, turned about the vertical."""
    x, y, z, *turn = pose.qpos[:7]
    ((x, y, z),) = moved(np.array([(x, y, z)]), start).tolist()
    w, i, j, k = turn
    turned = quaternion_product(quaternion_from_axis(UP, start.yaw_rad), (w, i, j, k))
    return Keyframe(pose.name, (x, y, z, *turned, *pose.qpos[7:]), pose.settings)


def put_prop(prop: Prop, start: Placement) -> Prop:
    """Return a prop somewhere else on the floor; it is a ball, or looks the same from all sides."""
    (x, y, _), z = moved(np.array([prop.pos_m]), start)[0].tolist(), prop.pos_m[2]
    return replace(prop, pos_m=(x, y, z))


def moved(discs: FloatArray, start: Placement) -> FloatArray:
    """Return discs somewhere else on the floor, turned about the vertical with what is at the origin."""
    places = discs[:, :2] @ matrix_from_axis(UP, start.yaw_rad)[:2, :2].T + (start.x_m, start.y_m)
    return np.column_stack([places, discs[:, 2]])
