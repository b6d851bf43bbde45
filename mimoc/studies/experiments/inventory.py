"""The contents of a random room: its size and textures, the position of the infant, and the toys."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from mimoc.compiler.building import Builder
from mimoc.mjcf.scene import Keyframe, SceneTree
from mimoc.mjcf.world import FreeObject
from mimoc.scenes.footprint import reachable_floor
from mimoc.studies.experiments.notebook import Cell
from mimoc.toys.placing import ReachableFloor

SIDES = ("floor", "ceiling", "wall_front", "wall_back", "wall_left", "wall_right")


@dataclass(frozen=True, slots=True)
class ToyPlace:
    """A toy and its position relative to the midpoint between the infant's shoulders."""

    name: str
    category: str
    size_m: float
    """Length of its longest side."""
    mass_kg: float
    ahead_m: float
    left_m: float
    within_reach: bool

    @property
    def distance_m(self) -> float:
        """Distance on the floor."""
        return math.hypot(self.ahead_m, self.left_m)


@dataclass(frozen=True, slots=True)
class Inventory:
    """The contents of a room."""

    seed: int
    size_m: tuple[float, float, float]
    """Depth, width and height."""
    textures: tuple[str, ...]
    """Textures of floor, ceiling and walls."""
    pictures: int
    lamps: int
    place_m: tuple[float, float]
    """Position of the infant's hip, from the centre of the room."""
    heading_rad: float
    """Direction that the infant faces, from the x axis to the left."""
    reach: ReachableFloor
    toys: tuple[ToyPlace, ...]

    @property
    def floor(self) -> str:
        """The texture of the floor."""
        return self.textures[0]

    @property
    def nearest_wall_m(self) -> float:
        """Distance from the infant's hip to the nearest wall."""
        return min(side / 2 - abs(place) for side, place in zip(self.size_m[:2], self.place_m, strict=True))

    @property
    def row(self) -> tuple[Cell, ...]:
        """The room as a row of a table."""
        within = sum(toy.within_reach for toy in self.toys)
        room = (self.seed, *self.size_m, self.floor, self.pictures, self.lamps)
        infant = (*self.place_m, math.degrees(self.heading_rad), self.nearest_wall_m)
        return (*room, *infant, len(self.toys), within)

    @property
    def toy_rows(self) -> Iterator[tuple[Cell, ...]]:
        """The toys as rows of a table."""
        for toy in self.toys:
            what = (self.seed, toy.name, toy.category, toy.size_m, toy.mass_kg)
            yield *what, toy.ahead_m, toy.left_m, toy.distance_m, int(toy.within_reach)


def take_inventory(builder: Builder, seed: int) -> Inventory:
    """Return the contents of a spec's room for a seed; the infant must have arms.

    Raises:
        SpecError: If there is not enough space for the toys.
    """
    furnished = builder.furnished(seed)
    room = furnished.scene
    start = next(keyframe for keyframe in room.keyframes if keyframe.name == builder.spec.scene.pose)
    reach = reachable_floor(builder.tree, start.qpos[: 7 + len(builder.tree.joints)])
    assert reach is not None
    heading_rad = _heading_rad(start)
    furniture = room.world.furniture
    names = [geom.name for geom in furniture.geoms]
    textures = {material.name: material.texture or "" for material in furniture.materials}
    return Inventory(
        seed=seed,
        size_m=_size_m(room),
        textures=tuple(textures[side] for side in SIDES),
        pictures=sum(name.startswith("picture") for name in names),
        lamps=sum(name.startswith("lamp") for name in names),
        place_m=(start.qpos[0], start.qpos[1]),
        heading_rad=heading_rad,
        reach=reach,
        toys=tuple(_relative_place(toy, reach, heading_rad) for toy in furnished.toys),
    )


def _size_m(room: SceneTree) -> tuple[float, float, float]:
    halves_m = {geom.name: geom.size_m for geom in room.world.furniture.geoms}
    depth_m, width_m = (2 * half_m for half_m in halves_m["floor"][:2])
    return depth_m, width_m, 2 * halves_m["wall_front"][1]


def _heading_rad(start: Keyframe) -> float:
    """Return the direction of the hip's x axis in the horizontal plane."""
    w, x, y, z = start.qpos[3:7]
    return math.atan2(2 * (x * y + w * z), w * w + x * x - y * y - z * z)


def _relative_place(toy: FreeObject, reach: ReachableFloor, heading_rad: float) -> ToyPlace:
    x_m, y_m = (place - centre for place, centre in zip(toy.pos_m, reach.centre_m, strict=False))
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
    return ToyPlace(
        name=toy.object,
        category=toy.category,
        size_m=toy.size_m,
        mass_kg=toy.mass_kg,
        ahead_m=cos * x_m + sin * y_m,
        left_m=cos * y_m - sin * x_m,
        within_reach=math.hypot(x_m, y_m) <= reach.radius_m,
    )
