"""Rooms by seed: what each holds, and where toys lie (López et al. 2025, figure 6)."""

from collections.abc import Sequence
from pathlib import Path
from statistics import mean, median
from time import perf_counter

import numpy as np
import numpy.typing as npt

from mimoc.compiler import building
from mimoc.experiments.inventory import Inventory, take_inventory
from mimoc.experiments.notebook import Notebook, markdown_table
from mimoc.looks.drawing import encode_palette_png
from mimoc.render.overview import overview
from mimoc.render.picture_grid import Picture, captioned_grid
from mimoc.render.plots.curves import Curve, Panel, draw_panels
from mimoc.render.plots.figure import png
from mimoc.scenes.room.build import CLEARANCE_M
from mimoc.schema.infant import InfantSpec
from mimoc.toys.builtin.library import BUILTIN
from mimoc.toys.placing import ReachableFloor

SEEDS, QUICK_SEEDS = range(24), range(12)
PICTURE_PX = (176, 132)
COLOURS = 128
"""Of the sheet, which is a third as large then."""
FARTHEST = 2.5
"""How far the figure goes, in reaches."""

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
"""`configs/playroom.yaml`, but for its senses."""

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

ABOUT = """\
The child of ten months in `configs/playroom.yaml` sits in {count} rooms, those of seeds {first} to {last}. Nothing
but the seed differs between them. Where a room leaves little space for the camera, its lens is wider.

![Rooms by seed](rooms.png)

`rooms.csv` has a row for each room, `toys.csv` one for each toy. Distances are those on the floor, between the
middle of the toy and the middle between the child's shoulders; its hands get {reach_cm:.0f} cm far there, when it
leans forward.

![Toys of all rooms about the child, and how far away they lie](toys.png)

On the left is where the toys of all rooms lie, the child in the middle and looking up; the circle is what it
reaches. On the right is how many of them lie nearer than a distance, next to the law that they are drawn by if
nothing is in the way. They keep clear of each other and of the child, in whichever pose it starts, and so lie a
little farther away."""

COMPARED = """\
## Next to the paper

{table}

A room takes {typical_ms:.0f} ms to build in memory (the median; the slowest of them {slowest_ms:.0f} ms), its
picture not counted."""


def run(notebook: Notebook) -> Path:
    """Build and draw the rooms of some seeds, and return the page."""
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
    notebook.write_picture("toys.png", png(draw_panels(_panels(rooms))))
    about = ABOUT.format(count=len(seeds), first=seeds[0], last=seeds[-1], reach_cm=100 * rooms[0].reach.radius_m)
    compared = COMPARED.format(table=_table(rooms), typical_ms=1000 * median(times_s), slowest_ms=1000 * max(times_s))
    return notebook.write_page(
        "Rooms", (about, compared), seeds=f"Seeds: {seeds[0]} to {seeds[-1]}.", libraries=["matplotlib"]
    )


def _panels(rooms: Sequence[Inventory]) -> list[Panel]:
    toys = [toy for room in rooms for toy in room.toys]
    reach = rooms[0].reach
    around = np.array([(-toy.left_m, toy.ahead_m) for toy in toys]) / reach.radius_m
    distances = np.sort([toy.distance_m for toy in toys]) / reach.radius_m
    far = np.linspace(0, FARTHEST, 400)
    return [
        Panel(
            "To the right [reaches]",
            "Ahead [reaches]",
            [Curve("toys", *around.T, marker="o", joined=False)],
            "Where toys lie",
            ring=1.0,
            equal=True,
        ),
        Panel(
            "Distance [reaches]",
            "Share of toys that lie nearer",
            [
                Curve("measured", distances, np.arange(1, len(toys) + 1) / len(toys), marker="."),
                Curve("law, on a floor that is free", far, _share_nearer(reach, far * reach.radius_m)),
            ],
            "How far away",
        ),
    ]


def _share_nearer(reach: ReachableFloor, distances_m: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return what share of the toys on an endless floor lies within each distance; these are evenly spaced."""
    wide_m = np.linspace(0, reach.radius_m + 20 * reach.fading_m, 4000)
    nearer = np.cumsum(wide_m * reach.density(wide_m))
    return np.interp(distances_m, wide_m, nearer / nearer[-1])


def _table(rooms: Sequence[Inventory]) -> str:
    return markdown_table(
        ("paper", f"mimoc, {len(rooms)} rooms"),
        [
            ("rooms of random size", _sizes(rooms)),
            ("textures drawn one by one", _papers(rooms)),
            ("the infant anywhere, well away from the walls", _places(rooms)),
            ("a random number of toys", _counts(rooms)),
            ("likelier near what it can reach", _distances(rooms)),
            ("(not in the paper) toys that an infant can hold", _toys(rooms)),
            ("all from one seed", "so is this: the same seeds give the same tables, to the byte"),
        ],
    )


def _sizes(rooms: Sequence[Inventory]) -> str:
    depths, widths, heights = zip(*(room.size_m for room in rooms), strict=True)
    return f"{_span(depths)} by {_span(widths)} m, {_span(heights)} m high"


def _papers(rooms: Sequence[Inventory]) -> str:
    floors, sets = {room.floor for room in rooms}, {room.papers for room in rooms}
    return f"{len(floors)} kinds of floor; {len(sets)} different sets of floor, ceiling and walls"


def _places(rooms: Sequence[Inventory]) -> str:
    nearest = _span([room.nearest_wall_m for room in rooms])
    return (
        f"{nearest} m from its hip to the nearest wall; {CLEARANCE_M:g} m beside it are left free where there is room"
    )


def _counts(rooms: Sequence[Inventory]) -> str:
    counts = [len(room.toys) for room in rooms]
    kinds = {toy.name for room in rooms for toy in room.toys}
    return (
        f"{min(counts)} to {max(counts)}, {mean(counts):.1f} in the mean; {len(kinds)} of mimoc's {len(BUILTIN)} in all"
    )


def _distances(rooms: Sequence[Inventory]) -> str:
    toys = [toy for room in rooms for toy in room.toys]
    within = sum(toy.within_reach for toy in toys)
    rooms_with = sum(any(toy.within_reach for toy in room.toys) for room in rooms)
    nearer_cm = 100 * median(toy.distance_m for toy in toys)
    return (
        f"{within} of {len(toys)} toys within reach, half of all nearer than {nearer_cm:.0f} cm;"
        f" at least one within reach in {rooms_with} of {len(rooms)} rooms"
    )


def _toys(rooms: Sequence[Inventory]) -> str:
    sizes_cm = [100 * toy.size_m for room in rooms for toy in room.toys]
    weights_g = [1000 * toy.mass_kg for room in rooms for toy in room.toys]
    return f"{_span(sizes_cm)} cm, {min(weights_g):.0f} to {max(weights_g):.0f} g"


def _span(values: Sequence[float]) -> str:
    return f"{min(values):.1f} to {max(values):.1f}"
