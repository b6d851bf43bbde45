"""Rooms by seed: their contents, and where the toys lie (López et al. 2025, figure 6)."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean, median
from time import perf_counter

import numpy as np
import numpy.typing as npt

from mimoc.compiler import building
from mimoc.compiler.building import Builder
from mimoc.looks.pictures import encode_palette_png
from mimoc.mjcf.scene import Keyframe, SceneTree
from mimoc.mjcf.world import FreeObject
from mimoc.quantities import Quantity
from mimoc.render.picture_files import Picture, captioned_grid
from mimoc.render.plots.plot import Dots, Line, Plot
from mimoc.render.portrait import overview
from mimoc.scenes.footprint import reachable_floor
from mimoc.scenes.room.build import CLEARANCE_M
from mimoc.schema.infant import InfantSpec
from mimoc.studies.experiments.notebook import Cell, Notebook, markdown_table, page_texts
from mimoc.toys.builtin import BUILTIN_TOYS
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


SEEDS, QUICK_SEEDS = range(24), range(12)
PICTURE_PX = (176, 132)
COLOURS = 128
"""Number of colours of the figure, which makes its file a third as large."""
FARTHEST = 2.5
"""Largest distance in the figure, in multiples of the reach."""

SPEC = {
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
"""The same as `configs/playroom.yaml`, without its senses."""

ROOM_HEADINGS = (
    "seed",
    "depth_m",
    "width_m",
    "height_m",
    "floor",
    "pictures",
    "lamps",
    "infant_x_m",
    "infant_y_m",
    "heading_deg",
    "nearest_wall_m",
    "toys",
    "toys_within_reach",
)
TOY_HEADINGS = ("seed", "object", "category", "size_m", "mass_kg", "ahead_m", "left_m", "distance_m", "within_reach")

TEXTS = page_texts("rooms")


def run(notebook: Notebook) -> Path:
    """Build and render the rooms of some seeds, and return the path of the report."""
    seeds = QUICK_SEEDS if notebook.quick else SEEDS
    builder = building.builder(InfantSpec.model_validate(SPEC))
    rooms: list[Inventory] = []
    pictures: list[Picture] = []
    times_s = []
    for done, seed in enumerate(seeds, start=1):
        start_s = perf_counter()
        bundle = builder(seed, check=False)
        times_s.append(perf_counter() - start_s)
        rooms.append(take_inventory(builder, seed))
        pictures.append(overview(bundle, *PICTURE_PX))
        notebook.progress(done, len(seeds))
    sheet = captioned_grid(pictures, [f"seed {seed}" for seed in seeds])
    notebook.write_picture("rooms.png", encode_palette_png(sheet, COLOURS))
    notebook.write_table("rooms.csv", ROOM_HEADINGS, (room.row for room in rooms))
    notebook.write_table("toys.csv", TOY_HEADINGS, (row for room in rooms for row in room.toy_rows))
    notebook.write_plots("toys.png", _plots(rooms))
    about = TEXTS["about"].format(
        count=len(seeds), first=seeds[0], last=seeds[-1], reach_cm=100 * rooms[0].reach.radius_m
    )
    compared = TEXTS["compared"].format(
        table=_table(rooms), typical_ms=1000 * median(times_s), slowest_ms=1000 * max(times_s)
    )
    return notebook.write_page(
        "Rooms", (about, compared), seeds=f"Seeds: {seeds[0]} to {seeds[-1]}.", libraries=["matplotlib"]
    )


def _plots(rooms: Sequence[Inventory]) -> list[Plot]:
    toys = [toy for room in rooms for toy in room.toys]
    reach = rooms[0].reach
    around = np.array([(-toy.left_m, toy.ahead_m) for toy in toys]) / reach.radius_m
    distances = np.sort([toy.distance_m for toy in toys]) / reach.radius_m
    far = np.linspace(0, FARTHEST, 400)
    return [
        Plot(
            x=Quantity("right", "To the right", "reaches"),
            y=Quantity("ahead", "Ahead", "reaches"),
            dots=(Dots(around[:, 0], around[:, 1], "toys"),),
            title="Positions of toys",
            ring=1.0,
            equal=True,
        ),
        Plot(
            x=Quantity("distance", "Distance", "reaches"),
            y=Quantity("nearer", "Fraction of toys within distance"),
            lines=(
                Line(distances, np.arange(1, len(toys) + 1) / len(toys), "measured", "marked"),
                Line(far, _share_nearer(reach, far * reach.radius_m), "law, on an empty floor"),
            ),
            title="Distances",
        ),
    ]


def _share_nearer(reach: ReachableFloor, distances_m: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the fraction of toys on an infinite floor that lies within each of some evenly spaced distances."""
    wide_m = np.linspace(0, reach.radius_m + 20 * reach.fading_m, 4000)
    nearer = np.cumsum(wide_m * reach.density(wide_m))
    return np.interp(distances_m, wide_m, nearer / nearer[-1])


def _table(rooms: Sequence[Inventory]) -> str:
    return markdown_table(
        ("paper", f"mimoc, {len(rooms)} rooms"),
        [
            ("rooms of random size", _sizes(rooms)),
            ("random textures", _textures(rooms)),
            ("infant at a random position away from the walls", _places(rooms)),
            ("random number of toys", _counts(rooms)),
            ("toys more likely within reach", _distances(rooms)),
            ("(not in the paper) toys that an infant can hold", _toys(rooms)),
            ("reproducible by seed", "the same seeds give the same tables, to the byte"),
        ],
    )


def _sizes(rooms: Sequence[Inventory]) -> str:
    depths, widths, heights = zip(*(room.size_m for room in rooms), strict=True)
    return f"{_span(depths)} by {_span(widths)} m, {_span(heights)} m high"


def _textures(rooms: Sequence[Inventory]) -> str:
    floors, sets = {room.floor for room in rooms}, {room.textures for room in rooms}
    return f"{len(floors)} different floors; {len(sets)} different combinations of floor, ceiling and walls"


def _places(rooms: Sequence[Inventory]) -> str:
    nearest = _span([room.nearest_wall_m for room in rooms])
    return (
        f"{nearest} m from the hip to the nearest wall; {CLEARANCE_M:g} m around it are kept free if the room permits"
    )


def _counts(rooms: Sequence[Inventory]) -> str:
    counts = [len(room.toys) for room in rooms]
    kinds = {toy.name for room in rooms for toy in room.toys}
    drawn = f"{len(kinds)} of mimoc's {len(BUILTIN_TOYS.names)} toys in all"
    return f"{min(counts)} to {max(counts)}, {mean(counts):.1f} on average; {drawn}"


def _distances(rooms: Sequence[Inventory]) -> str:
    toys = [toy for room in rooms for toy in room.toys]
    within = sum(toy.within_reach for toy in toys)
    rooms_with = sum(any(toy.within_reach for toy in room.toys) for room in rooms)
    nearer_cm = 100 * median(toy.distance_m for toy in toys)
    return (
        f"{within} of {len(toys)} toys are within reach, half of all within {nearer_cm:.0f} cm;"
        f" {rooms_with} of {len(rooms)} rooms have at least one within reach"
    )


def _toys(rooms: Sequence[Inventory]) -> str:
    sizes_cm = [100 * toy.size_m for room in rooms for toy in room.toys]
    weights_g = [1000 * toy.mass_kg for room in rooms for toy in room.toys]
    return f"{_span(sizes_cm)} cm, {min(weights_g):.0f} to {max(weights_g):.0f} g"


def _span(values: Sequence[float]) -> str:
    return f"{min(values):.1f} to {max(values):.1f}"
