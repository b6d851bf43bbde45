"""From a place as a spec says it to a place in the world, free of the infant and of other objects."""

import math
from dataclasses import dataclass

import numpy as np

from mimoc.base.errors import ObjectError, suggestion
from mimoc.base.geometry.reach import STRETCHED, places_around
from mimoc.base.geometry.rotations import Vec3
from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import FloatArray
from mimoc.compiler.objects.built_object import BuiltObject, PlacedThing, Surroundings
from mimoc.compiler.scenes import arm_of
from mimoc.schema.objects import ObjectSpec, PointSpec, in_words

GAP_M = 0.01  # Smallest gap between an object that a place is looked for and anything next to it.
HEIGHT_CM, DISTANCE_CM = 20.0, 10.0
"""Of an object above something, and of one in front of or beside something, unless the spec says."""
STEP_M = 0.005  # Step of the search for a free place along a direction.
FARTHEST_M = 2.0  # How far from a part an object is at most that is in front of it or beside it.
DIRECTIONS = 32  # In which a place within reach is looked for, beginning with that away from the infant.
STEEP = math.sqrt(0.5)  # Vertical part of a direction from which on it is upwards or downwards, not ahead.
WHOLE, MIDDLE = "infant", "chest"  # Word for the whole infant, and the part that is meant by it.


@dataclass(frozen=True, slots=True)
class Spot:
    """A place in the world."""

    pos_m: Vec3  # Of the origin of the object's own frame: the object's middle is above it, its lowest point there.
    where: str  # In words.
    yaw_rad: float = 0.0  # Of the axes that the object's own yaw is from.


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
    """Return the place of an object.

    Raises:
        ObjectError: If there is none, such as in the air for something that lies.
    """
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
        cosine, sine, yaw_rad = math.cos(start.yaw_rad), math.sin(start.yaw_rad), start.yaw_rad
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
    towards, words = (
        search.around.frames[search.around.tree.home(MIDDLE if region == "limb" else part)][1][:, 0],
        f"in front of {search.named(name)}",
    )
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
