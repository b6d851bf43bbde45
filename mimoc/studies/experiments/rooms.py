"""Rooms by seed: their contents, and where the toys lie (López et al. 2025, figure 6)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from statistics import mean, median
from time import perf_counter

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.compiler import building
from mimoc.compiler.building import Builder
from mimoc.compiler.looks.pictures import encode_palette_png
from mimoc.compiler.mjcf.world import FreeObject
from mimoc.compiler.scenes import reachable_floor
from mimoc.compiler.toys import ReachableFloor
from mimoc.components.scenes.room import CLEARANCE_M
from mimoc.components.toys.builtin import BUILTIN_TOYS
from mimoc.render.picture_files import Picture, captioned_grid
from mimoc.render.plots import Dots, Line, Plot
from mimoc.render.portrait import overview
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiment import Experiment, Measured, Results
from mimoc.studies.notebook import PAGES, Cell, yes

SIDES = ("floor", "ceiling", "wall_front", "wall_back", "wall_left", "wall_right")


@dataclass(frozen=True, slots=True)
class ToyPlace:
    """A toy and its position relative to the midpoint between the infant's shoulders."""

    name: str
    category: str
    size_m: float  # Length of its longest side.
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
    size_m: tuple[float, float, float]  # Depth, width and height.
    textures: tuple[str, ...]  # Textures of floor, ceiling and walls.
    pictures: int
    lamps: int
    place_m: tuple[float, float]  # Position of the infant's hip, from the centre of the room.
    heading_rad: float  # Direction that the infant faces, from the x axis to the left.
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
    def within_reach(self) -> int:
        """Number of toys within reach."""
        return sum(toy.within_reach for toy in self.toys)


def take_inventory(builder: Builder, seed: int) -> Inventory:
    """Return the contents of a spec's room for a seed; the infant must have arms."""
    furnished = builder.place_scene(seed)
    room = furnished.scene
    start = next(keyframe for keyframe in room.keyframes if keyframe.name == builder.spec.scene.pose)
    reach = reachable_floor(builder.tree, start.qpos[: 7 + len(builder.tree.joints)])
    assert reach is not None
    w, x, y, z = start.qpos[3:7]
    heading_rad = math.atan2(2 * (x * y + w * z), w * w + x * x - y * y - z * z)
    furniture = room.world.furniture
    halves_m = {geom.name: geom.size_m for geom in furniture.geoms}
    names = [geom.name for geom in furniture.geoms]
    textures = {material.name: material.texture or "" for material in furniture.materials}
    return Inventory(
        seed=seed,
        size_m=(2 * halves_m["floor"][0], 2 * halves_m["floor"][1], 2 * halves_m["wall_front"][1]),
        textures=tuple(textures[side] for side in SIDES),
        pictures=sum(name.startswith("picture") for name in names),
        lamps=sum(name.startswith("lamp") for name in names),
        place_m=(start.qpos[0], start.qpos[1]),
        heading_rad=heading_rad,
        reach=reach,
        toys=tuple(_relative_place(toy, reach, heading_rad) for toy in furnished.toys),
    )


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


PICTURE_PX = (176, 132)
COLOURS = 128  # Number of colours of the figure, which makes its file a third as large.
FARTHEST = 2.5  # Largest distance in the figure, in multiples of the reach.

SPEC = {  # The same as `configs/playroom.yaml`, without its senses.
    "mimoc": 1,
    "name": "playroom",
    "age_months": 10,
    "scene": {
        "kind": "room",
        "pose": "sitting",
        "room": {"size_m": [[2.5, 5], [2.5, 5], [2.2, 3]]},
        "toys": {"source": "builtin", "count": [3, 6], "size_cm": [4, 12]},
    },
}

ROOM_HEADING = (
    "seed,depth_m,width_m,height_m,floor,pictures,lamps,infant_x_m,infant_y_m,heading_deg,nearest_wall_m,"
    "toys,toys_within_reach"
)
TOY_HEADING = "seed,object,category,size_m,mass_kg,ahead_m,left_m,distance_m,within_reach"


@dataclass(frozen=True, slots=True)
class Built:
    """A room, as it was built."""

    inventory: Inventory
    picture: Picture
    seconds: float  # Time that building it took.


def build(development: Development, seed: int) -> Built:
    """Build and render the room of a seed."""
    builder = _builder(development)
    start_s = perf_counter()
    bundle = builder(seed, check=False)
    seconds = perf_counter() - start_s
    return Built(take_inventory(builder, seed), overview(bundle, *PICTURE_PX), seconds)


@cache
def _builder(law: Development) -> Builder:
    return building.builder(InfantSpec.model_validate({**SPEC, "development": law}))


def _inventories(results: Results) -> list[Inventory]:
    return [built.inventory for built in results.by_case[results.notebook.law]]


def _pictures(results: Results) -> bytes:
    pictures = [built.picture for built in results.by_case[results.notebook.law]]
    return encode_palette_png(captioned_grid(pictures, [f"seed {seed}" for seed in results.seeds]), COLOURS)


def _measured(results: Results) -> Measured:
    rooms = _inventories(results)
    again = take_inventory(_builder(results.notebook.law), results.seeds[0])
    share_of_toys = sum(room.within_reach for room in rooms) / sum(len(room.toys) for room in rooms)
    share_of_floor = mean(math.pi * room.reach.radius_m**2 / (room.size_m[0] * room.size_m[1]) for room in rooms)
    return {
        "rooms of random size": yes(len({room.size_m for room in rooms}) > 1),
        "random textures of floor, ceiling and walls": yes(len({room.textures for room in rooms}) > 1),
        "infant at a random place away from the walls": yes(min(room.nearest_wall_m for room in rooms) >= CLEARANCE_M),
        "random number of toys": yes(len({len(room.toys) for room in rooms}) > 1),
        "places within reach are likelier than others on the floor": yes(share_of_toys > share_of_floor),
        "the same seed gives the same room": yes(rooms[0].toys == again.toys and rooms[0].size_m == again.size_m),
    }


def _room_cells(room: Inventory) -> tuple[Cell, ...]:
    walls = (room.seed, *room.size_m, room.floor, room.pictures, room.lamps)
    infant = (*room.place_m, math.degrees(room.heading_rad), room.nearest_wall_m)
    return (*walls, *infant, len(room.toys), room.within_reach)


def _toy_cells(room: Inventory, toy: ToyPlace) -> tuple[Cell, ...]:
    description = (room.seed, toy.name, toy.category, toy.size_m, toy.mass_kg)
    return (*description, toy.ahead_m, toy.left_m, toy.distance_m, int(toy.within_reach))


def _plots(results: Results) -> list[Plot]:
    rooms = _inventories(results)
    toys = [toy for room in rooms for toy in room.toys]
    reach = rooms[0].reach
    around = np.array([(-toy.left_m, toy.ahead_m) for toy in toys]) / reach.radius_m
    distances = np.sort([toy.distance_m for toy in toys]) / reach.radius_m
    far = np.linspace(0, FARTHEST, 400)
    wide_m = np.linspace(0, reach.radius_m + 20 * reach.fading_m, 4000)
    shares = np.cumsum(wide_m * reach.density(wide_m))  # Share of toys on an infinite floor within each of these.
    x = Quantity("right", "To the right", "reaches")
    y = Quantity("ahead", "Ahead", "reaches")
    dots = (Dots(around[:, 0], around[:, 1], "toys"),)
    distance = Quantity("distance", "Distance", "reaches")
    nearer = Quantity("nearer", "Fraction of toys within distance")
    lines = (
        Line(distances, np.arange(1, len(toys) + 1) / len(toys), "measured", "marked"),
        Line(far, np.interp(far * reach.radius_m, wide_m, shares / shares[-1]), "law, on an empty floor"),
    )
    return [
        Plot(x, y, dots=dots, title="Positions of toys", ring=1.0, equal=True),
        Plot(distance, nearer, lines, title="Distances"),
    ]


def _numbers(results: Results) -> dict[str, object]:
    rooms = _inventories(results)
    seeds = results.seeds
    times_ms = [1000 * built.seconds for built in results.by_case[results.notebook.law]]
    toys = [toy for room in rooms for toy in room.toys]
    depths_m, widths_m, heights_m = zip(*(room.size_m for room in rooms), strict=True)
    counts = [len(room.toys) for room in rooms]
    masses_g = [1000 * toy.mass_kg for toy in toys]
    return {
        "first": seeds[0],
        "last": seeds[-1],
        "typical_ms": median(times_ms),
        "slowest_ms": max(times_ms),
        "count": len(rooms),
        "reach_cm": 100 * rooms[0].reach.radius_m,
        "sizes_m": f"{_span(depths_m)} by {_span(widths_m)} m, {_span(heights_m)} m",
        "floors": len({room.floor for room in rooms}),
        "sets": len({room.textures for room in rooms}),
        "walls_m": _span([room.nearest_wall_m for room in rooms]),
        "clearance_m": CLEARANCE_M,
        "fewest": min(counts),
        "most": max(counts),
        "average": mean(counts),
        "drawn": len({toy.name for toy in toys}),
        "builtin": len(BUILTIN_TOYS.names),
        "within": sum(room.within_reach for room in rooms),
        "toys": len(toys),
        "nearer_cm": 100 * median(toy.distance_m for toy in toys),
        "rooms_with": sum(room.within_reach > 0 for room in rooms),
        "sizes_cm": _span([100 * toy.size_m for toy in toys]),
        "lightest_g": min(masses_g),
        "heaviest_g": max(masses_g),
    }


def _span(values: Sequence[float]) -> str:
    return f"{min(values):.1f} to {max(values):.1f}"


EXPERIMENT = Experiment(
    name="rooms",
    trial=build,
    cases=lambda notebook: [notebook.law],
    seeds=range(24),
    kept=False,
    quick={"seeds": range(12)},
    files={
        "rooms.png": _pictures,
        "rooms.csv": lambda results: (ROOM_HEADING, map(_room_cells, _inventories(results))),
        "toys.csv": lambda results: (
            TOY_HEADING,
            (_toy_cells(room, toy) for room in _inventories(results) for toy in room.toys),
        ),
        "toys.png": _plots,
    },
    page=PAGES / "rooms.md",
    numbers=_numbers,
    measured=_measured,
    infants=lambda law: [_builder(law)(0, check=False)],
    development="maturing",
)
