"""Placement of objects in the world, one after another, and of an infant that starts on, in or at furniture."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mimoc.base.errors import ObjectError, UnsupportedTaskError
from mimoc.base.geometry.rotations import (
    Quaternion,
    Vec3,
    matrix_from_axis,
    matrix_from_quaternion,
    quaternion_from_axis,
    quaternion_product,
)
from mimoc.base.kinds import function_of
from mimoc.base.units import cm_to_m, m_to_cm
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.sensor_sites import PREFIX, keypoint_sites
from mimoc.compiler.mjcf.world import ObjectBody, PlacedObject, Ribbon
from mimoc.compiler.objects.built_object import BuiltObject, PlacedThing, Surroundings, Tie
from mimoc.compiler.objects.places import WHOLE, Spot, find_place
from mimoc.compiler.scenes import Placement
from mimoc.compiler.task_setup import Hold
from mimoc.schema.kinds import OBJECTS
from mimoc.schema.objects import ObjectEntry, ObjectSpec, PointSpec
from mimoc.schema.scene import SceneSpec

State = tuple[float, ...]  # Position and quaternion of the hip, then the hinges (qpos).


@dataclass(frozen=True, slots=True)
class FurnitureStart:
    """How an infant can start at a piece of furniture, in the frame of the infant: x ahead, floor at z = 0."""

    states: Mapping[str, State]  # By the name of its pose; the hip is at x = y = 0.
    ahead_m: float = 0.0  # How far ahead of the hip the origin of the furniture is.
    holds: tuple[Hold, ...] = ()  # What holds on, or is held.


def turned(state: State, turn: Quaternion, middle_m: Vec3) -> State:
    """Return a state on another plane than the floor: turned about the world's origin, which is then moved."""
    w, i, j, k = state[3:7]
    x, y, z = (matrix_from_quaternion(turn) @ state[:3] + middle_m).tolist()
    return (x, y, z, *quaternion_product(turn, (w, i, j, k)), *state[7:])


def start_at(scene: SceneSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant starts at the furniture that its scene names.

    Args:
        scene: The scene.
        tree: The infant's body.
        states: Its poses on the floor, by name.

    Raises:
        UnsupportedTaskError: If this infant cannot start there, or lacks a part that a belt holds.
    """
    item = next(item for item in scene.objects if item.name == scene.start_at)
    start = OBJECTS[item.kind].start
    assert start is not None  # The spec was checked.
    try:
        at: FurnitureStart = function_of(start, "start")(item, tree, states)
    except UnsupportedTaskError as error:
        raise UnsupportedTaskError(str(error), ("scene", "start_at")) from None
    bodies = {body.name for body in tree.bodies}
    if missing := sorted(hold.body for hold in at.holds if hold.body not in bodies):
        raise UnsupportedTaskError(f"this infant has no '{missing[0]}' to hold", ("scene", "start_at"))
    return replace(at, states={pose: state for pose, state in at.states.items() if pose in OBJECTS[item.kind].poses})


def place_furniture(scene: SceneSpec, start: Placement, ahead_m: float) -> tuple[Sequence[ObjectSpec], Placement]:
    """Return the objects of a scene, and where its infant is, who starts at one of them.

    Furniture with coordinates takes the infant to itself; furniture without a place comes to the infant.

    Args:
        scene: The scene.
        start: Where the infant would be without.
        ahead_m: How far ahead of it the furniture is.
    """
    number = next((number for number, item in enumerate(scene.objects) if item.name == scene.start_at), None)
    if number is None:
        return scene.objects, start
    item = scene.objects[number]
    if isinstance(item.at, PointSpec):
        yaw_rad = math.radians(item.yaw_deg)
        x_m, y_m = cm_to_m(item.at.x_cm), cm_to_m(item.at.y_cm)
        start = Placement(x_m - ahead_m * math.cos(yaw_rad), y_m - ahead_m * math.sin(yaw_rad), yaw_rad)
    else:
        x_m, y_m = start.x_m + ahead_m * math.cos(start.yaw_rad), start.y_m + ahead_m * math.sin(start.yaw_rad)
    at = PointSpec(x_cm=m_to_cm(x_m), y_cm=m_to_cm(y_m), z_cm=0.0)
    placed = item.model_copy(update={"at": at, "yaw_deg": math.degrees(start.yaw_rad)})
    return (*scene.objects[:number], placed, *scene.objects[number + 1 :]), start


UP = (0.0, 0.0, 1.0)


def place_objects(objects: Sequence[ObjectSpec], infants: Mapping[str, Surroundings]) -> tuple[PlacedThing, ...]:
    """Return the objects of a scene at their places.

    Args:
        objects: The objects; each may name the infant that its place is about, otherwise it is the first.
        infants: By name, the surroundings of each infant.

    Raises:
        ObjectError: If one cannot be built or placed.
    """
    first, things = next(iter(infants)), tuple[PlacedThing, ...]()
    taken = {*(body.name for around in infants.values() for body in around.tree.bodies), WHOLE}
    for number, spec in enumerate(objects):
        if spec.name in taken:
            raise ObjectError("name", f"'{spec.name}' is a part of the infant; give the object another name", number)
        surroundings = replace(infants[spec.infant or first], things=things)
        try:
            built: BuiltObject = function_of(OBJECTS[spec.kind].build, "build")(spec, surroundings)
            place = find_place(spec, built, surroundings)
            thing = _placed(spec, built, place, surroundings)
        except ObjectError as error:
            raise ObjectError(error.key, str(error), number) from None
        things = (*things, thing)
    return things


def _placed(spec: ObjectSpec, built: BuiltObject, spot: Spot, around: Surroundings) -> PlacedThing:
    pos_m, yaw_rad = spot.pos_m, math.radians(spec.yaw_deg) + spot.yaw_rad
    x, y, z = (matrix_from_axis(UP, yaw_rad) @ built.root.pos_m + pos_m).tolist()
    turn = quaternion_product(quaternion_from_axis(UP, yaw_rad), built.root.quat)
    root = replace(built.root, pos_m=(x, y, z), quat=turn)
    ribbons = (tie_ribbon(built.tie, root, around),) if built.tie else ()
    bodies = tuple(root.subtree())
    entry = ObjectEntry(
        name=spec.name,
        kind=spec.kind,
        body=root.name,
        joint=next(iter((*root.free_joints, *(joint.name for joint in root.joints))), None),
        motion=built.motion,
        geoms=tuple(geom.name for body in bodies for geom in body.geoms if geom.contype or geom.conaffinity),
        material=built.material,
        size_m=built.size_m,
        mass_kg=built.mass_kg,
        height_m=built.height_m,
        origin_m=built.root.pos_m[2],
        surface_m=built.surface_m,
        where=spot.where,
        bells=built.bells,
        ribbon=ribbons[0].name if ribbons else None,
        tied_to=around.prefix + built.tie.limb if built.tie else None,
        slack_m=built.tie.slack_m if built.tie else 0.0,
        water=built.water,
    )
    elements = PlacedObject(root, built.materials, built.meshes, ribbons)
    return PlacedThing(spec.name, built, elements, entry, pos_m, yaw_rad)


def trace_objects(things: Sequence[PlacedThing]) -> Mapping[str, Entry]:
    """Return an entry for each number of each object, by key in `provenance.json`."""
    return {key: entry for number, thing in enumerate(things) for key, entry in _trace(number, thing)}


def _trace(number: int, thing: PlacedThing) -> list[tuple[str, Entry]]:
    key, at = f"object.{thing.name}", f"scene.xml: body[@name='{thing.entry.body}']"
    source = ["spec.scene.objects"]
    rule = f"its body's, {thing.entry.origin_m:.4g} m above its lowest point, which is {thing.entry.where}"
    place: Entry = {"value": thing.elements.root.pos_m, "unit": "m", "rule": rule}
    entries = [(f"{key}.pos", {**place, "from": source, "xml": f"{at}/@pos"})]
    return [*entries, *((f"{key}.{end}", entry) for end, entry in thing.built.origins.items())]


KEYPOINTS = {"foot": "Ankle", "hand": "Wrist"}  # Where a ribbon is tied, by what the name of the limb ends with.


def tie_ribbon(tie: Tie, root: ObjectBody, around: Surroundings) -> Ribbon:
    """Return the ribbon of an object whose outermost body is in the world.

    Raises:
        ObjectError: If the infant has no such limb.
    """
    side, _, limb = tie.limb.partition("_")
    name = f"{PREFIX}{side[0].upper()}{KEYPOINTS[limb]}"
    places = {site.name: (body, site) for body, sites in keypoint_sites(around.tree).items() for site in sites}
    if name not in places:
        raise ObjectError("tied_to", f"this infant has no {tie.limb}; tie it to another limb, or leave this out")
    body, site = places[name]
    origin, turn = around.frames[body]
    (start,) = (mine for mine in root.sites if mine.name == tie.site)
    start_m = matrix_from_quaternion(root.quat) @ start.pos_m + root.pos_m
    way_m = float(np.linalg.norm(origin + turn @ site.pos_m - start_m))
    return Ribbon(f"{root.name}_ribbon", (tie.site, around.prefix + name), (0.0, way_m + tie.slack_m), tie.rgba)
