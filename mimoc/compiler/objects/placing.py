"""Placement of objects in the world, one after another, each among those before it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mimoc.base.errors import ObjectError
from mimoc.base.geometry.rotations import (
    matrix_from_axis,
    matrix_from_quaternion,
    quaternion_from_axis,
    quaternion_product,
)
from mimoc.base.kinds import function_of
from mimoc.body.origins import Entry
from mimoc.compiler.mjcf.sensor_sites import PREFIX, keypoint_sites
from mimoc.compiler.mjcf.world import ObjectBody, PlacedObject, Ribbon
from mimoc.compiler.objects.built_object import BuiltObject, PlacedThing, Surroundings, Tie
from mimoc.compiler.objects.places import WHOLE, Spot, find_place
from mimoc.schema.components.objects import OBJECTS
from mimoc.schema.object_base import ObjectEntry, ObjectSpec

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


KEYPOINTS = {"foot": "Ankle", "hand": "Wrist"}
"""Where a ribbon is tied, by what the name of the limb ends with."""


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
