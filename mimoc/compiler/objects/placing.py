"""Places of objects, from a spec's words to the world, and of an infant that starts on, in or at furniture."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mimoc.base.errors import ObjectError, UnsupportedTaskError, suggestion
from mimoc.base.geometry.reach import STRETCHED, places_around
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
from mimoc.body.kinematics import FloatArray
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.sensor_sites import PREFIX, keypoint_sites
from mimoc.compiler.mjcf.world import ObjectBody, PlacedObject, Ribbon
from mimoc.compiler.objects.built_object import BuiltObject, PlacedThing, Surroundings, Tie
from mimoc.compiler.scenes import Placement, arm_of
from mimoc.compiler.task_setup import Hold
from mimoc.schema.kinds import OBJECTS
from mimoc.schema.objects import ObjectEntry, ObjectSpec, PointSpec, in_words
from mimoc.schema.scene import SceneSpec

GAP_M = 0.01  # Smallest gap between an object that a place is looked for and anything next to it.
HEIGHT_CM, DISTANCE_CM = 20.0, 10.0
"""Height of an object above something, and distance of one in front of or beside something, unless the spec says."""
STEP_M = 0.005  # Step of the search for a free place along a direction.
FARTHEST_M = 2.0  # How far from a part an object is at most that is in front of it or beside it.
DIRECTIONS = 32  # Directions in which a place within reach is looked for, first away from the infant.
STEEP = math.sqrt(0.5)  # Vertical part of a direction from which on it is upwards or downwards, not ahead.
WHOLE, MIDDLE = "infant", "chest"  # Word for the whole infant, and the part that is meant by it.


@dataclass(frozen=True, slots=True)
class Spot:
    """A place in the world."""

    pos_m: Vec3  # Origin of the object's own frame: the object's middle is above it, its lowest point there.
    where: str  # The place in words.
    yaw_rad: float = 0.0  # Yaw of the axes that the object's own yaw is measured from.


@dataclass(frozen=True, slots=True)
class Search:
    """An object that needs a place, and what it is placed among."""

    spec: ObjectSpec
    built: BuiltObject
    around: Surroundings

    @property
    def rests(self) -> bool:
        """Whether it lies on something."""
        return self.built.motion in ("free", "sliding")

    def refusal(self, key: str, message: str) -> ObjectError:
        """Return the error that says why it cannot be there."""
        return ObjectError(key, message)

    def thing(self, name: str) -> PlacedThing | None:
        """Return the object of some name that is placed already."""
        return next((thing for thing in self.around.things if thing.name == name), None)

    def part(self, name: str, key: str) -> str:
        """Return a part of the infant, or refuse the name."""
        part = MIDDLE if name == WHOLE else name
        bodies = {body.name for body in self.around.tree.bodies}
        if self.around.tree.home(part) not in bodies:
            known = [*bodies, *(thing.name for thing in self.around.things)]
            raise self.refusal(
                key, f"'{name}' is no part of this infant and no object before this one; {suggestion(name, known)}"
            )
        return part

    def named(self, name: str) -> str:
        """Return the name of an object or a part of the infant in the model, in which infants have prefixes."""
        return name if self.thing(name) else self.around.prefix + name

    def box(self, name: str, key: str) -> tuple[FloatArray, FloatArray]:
        """Return the lowest and the highest corner of the box around a part or an object, or refuse the name."""
        if (thing := self.thing(name)) is None:
            return self.around.box(self.part(name, key))
        radius_m, (x, y, z) = thing.built.radius_m, thing.pos_m
        return np.array([x - radius_m, y - radius_m, z]), np.array([x + radius_m, y + radius_m, thing.top_m])

    def support_m(self, x_m: float, y_m: float, key: str) -> float:
        """Return the height of what is below a place: the level top of an object, or the floor.

        Only what is free begins on water.
        """
        floats = self.built.motion == "free"
        tops = [item.top_m for item in self.around.things if item.bears(x_m, y_m) and (floats or not item.built.water)]
        if not tops and not self.around.has_floor:
            raise self.refusal(
                key, "there is no floor that it could lie on; fix it or hang it, or give its height z_cm"
            )
        return max(tops, default=0.0)

    def is_free(self, x_m: float, y_m: float) -> bool:
        """Return whether there is room, on the floor or on what bears all of it there."""
        others = (thing for thing in self.around.things if not thing.bears(x_m, y_m, self.built.radius_m))
        taken = np.array([*map(tuple, self.around.discs), *(disc for thing in others for disc in thing.discs)])
        gaps_m = np.hypot(taken[:, 0] - x_m, taken[:, 1] - y_m) - taken[:, 2] - self.built.radius_m
        is_inside = np.abs((x_m, y_m)) + self.built.radius_m <= self.around.half_size_m
        return bool((gaps_m >= GAP_M).all() and is_inside.all())


def find_place(spec: ObjectSpec, built: BuiltObject, around: Surroundings) -> Spot:
    """Return the place of an object; ObjectError if there is none, such as in the air for something that lies."""
    search = Search(spec, built, around)
    spot = _spot(search)
    discs = np.array(built.discs_at(spot.pos_m, spot.yaw_rad + math.radians(spec.yaw_deg)))
    if (np.abs(discs[:, :2]) + discs[:, 2:] > around.half_size_m).any():
        message = "it is outside of the floor, or in a wall; give another place, or make it smaller"
        raise search.refusal("at" if spec.above is None else "above", message)
    return spot


def _spot(search: Search) -> Spot:
    spec = search.spec
    if spec.above is not None:
        low, high = search.box(spec.above, "above")
        height_cm = HEIGHT_CM if search.spec.height_cm is None else search.spec.height_cm
        (x_m, y_m, _), z_m = ((low + high) / 2).tolist(), float(high[2])
        return Spot((x_m, y_m, z_m + cm_to_m(height_cm)), f"{height_cm:g} cm above {search.named(spec.above)}")
    if isinstance(spec.at, PointSpec):
        return _at_point(search, spec.at)
    if spec.at is None:
        raise search.refusal("name", "it has no place; add 'at' or 'above'")
    relation, name = in_words(spec.at)
    finders = {"within reach of": _within_reach, "in front of": _in_front, "beside": _beside, "on": _on}
    return finders[relation](search, name)


def _at_point(search: Search, point: PointSpec) -> Spot:
    start, yaw_rad = search.around.start, 0.0
    x_m, y_m = cm_to_m(point.x_cm), cm_to_m(point.y_cm)
    if point.frame == "infant":
        cosine = math.cos(start.yaw_rad)
        sine = math.sin(start.yaw_rad)
        yaw_rad = start.yaw_rad
        x_m, y_m = start.x_m + cosine * x_m - sine * y_m, start.y_m + sine * x_m + cosine * y_m
    z_m = search.support_m(x_m, y_m, "at") if point.z_cm is None else cm_to_m(point.z_cm)
    frame = search.named(WHOLE) if point.frame == "infant" else point.frame
    height = "" if point.z_cm is None else f", z {point.z_cm:g} cm"
    return Spot((x_m, y_m, z_m), f"x {point.x_cm:g} cm, y {point.y_cm:g} cm{height} ({frame})", yaw_rad)


def _on(search: Search, name: str) -> Spot:
    thing = search.thing(name)
    if thing is None:
        raise search.refusal("at", f"there is no object '{name}' before this one that it could be on")
    if thing.built.surface_m is None:
        raise search.refusal("at", f"'{name}' has no level top that something could lie on")
    return Spot((*thing.pos_m[:2], thing.top_m), f"on {name}", thing.yaw_rad)


def _within_reach(search: Search, name: str) -> Spot:
    """Return the free place nearest to a hand that its arm reaches."""
    side, _, limb = name.partition("_")
    arm = arm_of(search.around.tree, search.around.qpos, side) if limb == "hand" else None
    if arm is None:
        raise search.refusal("at", f"'{name}' is no hand of this infant; write left_hand or right_hand")
    if not search.rests:
        ahead = search.around.frames[search.part(MIDDLE, "at")][1][:, 0]
        x_m, y_m, z_m = (arm.shoulder_m + STRETCHED * arm.length_m * ahead).tolist()
        return Spot((x_m, y_m, z_m - search.built.height_m / 2), f"within reach of {search.named(name)}")
    hand_m = search.around.part(name).centres.mean(axis=0)
    outwards = math.atan2(*(hand_m - search.around.posed.centre_of_mass)[1::-1])
    for across_m in places_around(outwards, 2 * arm.length_m, STEP_M, DIRECTIONS):
        x_m, y_m = (hand_m[:2] + across_m).tolist()
        is_near = math.hypot(x_m - arm.shoulder_m[0], y_m - arm.shoulder_m[1]) <= arm.on_floor_m
        if is_near and search.is_free(x_m, y_m):
            return Spot((x_m, y_m, search.support_m(x_m, y_m, "at")), f"within reach of {search.named(name)}")
    raise search.refusal(
        "at", f"there is no free place on the floor within reach of {name}; give coordinates, or hang it"
    )


def _in_front(search: Search, name: str) -> Spot:
    """Return the first free place where a part faces; in the air for what does not lie."""
    part = search.part(name, "at")
    # The part whose direction is meant: its own of head and trunk, the chest's of limbs.
    region = next(body.region for body in search.around.tree.bodies if body.name == search.around.tree.home(part))
    towards = search.around.frames[search.around.tree.home(MIDDLE if region == "limb" else part)][1][:, 0]
    words = f"in front of {search.named(name)}"
    distance_cm = DISTANCE_CM if search.spec.distance_cm is None else search.spec.distance_cm
    if not search.rests:
        reach_m = float(
            search.around.part(part).reaches(towards).max() - search.around.part(part).centres.mean(0) @ towards
        )
        size_m = max(search.built.radius_m, search.built.height_m / 2)
        middle_m = search.around.part(part).centres.mean(0) + towards * (reach_m + cm_to_m(distance_cm) + size_m)
        x_m, y_m, z_m = middle_m.tolist()
        return Spot((x_m, y_m, z_m - search.built.height_m / 2), words)
    if abs(towards[2]) > STEEP:
        where = "above" if towards[2] > 0 else "below"
        raise search.refusal(
            "at", f"what is {words} is {where} it as it starts; hang it or fix it, or write 'beside {name}'"
        )
    return _along(search, part, towards, distance_cm, words)


def _beside(search: Search, name: str) -> Spot:
    """Return the first free place outwards of a part: to its own side, or to the left of the trunk and the head."""
    part = search.part(name, "at")
    leftwards = search.around.frames[search.around.tree.home(MIDDLE)][1][:, 1]
    outwards = -leftwards if part.startswith("right_") else leftwards
    distance_cm = DISTANCE_CM if search.spec.distance_cm is None else search.spec.distance_cm
    return _along(search, part, outwards, distance_cm, f"beside {search.named(name)}")


def _along(search: Search, part: str, towards: FloatArray, distance_cm: float, words: str) -> Spot:
    """Return the first free place from a part on along the level part of a direction."""
    level = towards[:2] / np.linalg.norm(towards[:2])
    geoms = search.around.part(part)
    start_m = geoms.centres.mean(axis=0)
    first_m = float(geoms.reaches(np.array([*level, 0.0])).max() - start_m[:2] @ level) + search.built.radius_m
    for away_m in np.arange(first_m + cm_to_m(distance_cm), FARTHEST_M, STEP_M):
        x_m, y_m = (start_m[:2] + away_m * level).tolist()
        if search.is_free(x_m, y_m):
            z_m = search.support_m(x_m, y_m, "at") if search.rests else float(start_m[2] - search.built.height_m / 2)
            return Spot((x_m, y_m, max(z_m, 0.0)), words)
    raise search.refusal("at", f"there is no free place {words}; give coordinates")


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
    """Return how an infant starts at the furniture that its scene names; *states* are its poses on the floor, by name.

    An UnsupportedTaskError says that this infant cannot start there, or lacks a part that a belt holds.

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
    """Return the objects of a scene, and where its infant is, which starts at one of them.

    Furniture with coordinates takes the infant to itself; furniture without a place comes to the infant, which would
    be at *start* otherwise. The furniture is *ahead_m* ahead of it.

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
    """Return the objects of a scene at their places among infants, by name; each may name the one that it is by.

    An ObjectError has the number of the object that cannot be built or placed.

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
    pos_m = spot.pos_m
    yaw_rad = math.radians(spec.yaw_deg) + spot.yaw_rad
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
    key = f"object.{thing.name}"
    at = f"scene.xml: body[@name='{thing.entry.body}']"
    source = ["spec.scene.objects"]
    rule = f"its body's, {thing.entry.origin_m:.4g} m above its lowest point, which is {thing.entry.where}"
    place: Entry = {"value": thing.elements.root.pos_m, "unit": "m", "rule": rule}
    entries = [(f"{key}.pos", {**place, "from": source, "xml": f"{at}/@pos"})]
    return [*entries, *((f"{key}.{end}", entry) for end, entry in thing.built.origins.items())]


KEYPOINTS = {"foot": "Ankle", "hand": "Wrist"}  # Where a ribbon is tied, by what the name of the limb ends with.


def tie_ribbon(tie: Tie, root: ObjectBody, around: Surroundings) -> Ribbon:
    """Return the ribbon of an object in the world; ObjectError if the infant has no limb to tie it to."""
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
