"""What movement columns say of an episode: how each hand and foot moves, touches and bears, and what is looked at.

Left and right are quantities of their own; lengths and speeds are those in the world, in metres and seconds, but for
movement units, which are those of `mimoc.movement`.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import pairwise
from typing import Any

from mimoc.base.quantities.movement_details import VON_HOFSTEN
from mimoc.base.quantities.quantity import Quantity

Columns = Mapping[str, Any]
UNITS = "mimoc.runtime.quantities.movement_units"  # The module that counts movement units, here and in films.


def _path_m(part: str, columns: Columns) -> float:
    return math.fsum(math.dist(*points) for points in pairwise(_points(part, columns)))


def _straightness(part: str, columns: Columns) -> float | None:
    points, path_m = list(_points(part, columns)), _path_m(part, columns)
    return math.dist(points[0], points[-1]) / path_m if path_m else None


def _touching(part: str, columns: Columns) -> float:
    return _share(text != "" for text in columns[f"{part}_touches"])


def _looked_at(part: str, columns: Columns) -> float:
    return _share(text == part for text in columns["gaze_at"])


def _points(part: str, columns: Columns) -> Iterator[tuple[float, ...]]:
    return zip(*(map(float, columns[f"{part}_{axis}_m"]) for axis in "xyz"), strict=True)


def _share(flags: Iterable[bool]) -> float:
    values = list(flags)
    return sum(values) / len(values)


_COMPUTED: tuple[tuple[str, str, str, str, str | Callable[[str, Columns], float | None]], ...] = (
    ("path_m", "path", "m", "length of the path of its centre of mass", _path_m),
    (
        "straightness",
        "straightness",
        "",
        "distance from its first to its last place over the length of its path: 1 is straight",
        _straightness,
    ),
    (
        "movement_units",
        "movement units",
        "",
        "maxima of its speed in the frame of the trunk (neck and hips), without what is faster than 6 Hz, of at least"
        " .25 trunk/s, with a prominence of at least .125 trunk/s, as `mimoc movement` counts them, but in space",
        UNITS,
    ),
    ("touching_share", "share of time in contact", "", "share of rows in which it touches anything", _touching),
    (
        "looked_at_share",
        "share of time looked at",
        "",
        "share of rows in which the line of sight first meets it",
        _looked_at,
    ),
)
"""Name, label, unit, definition of what is computed of a part, and its function, or the module that has it by name."""
_REDUCED: tuple[tuple[str, str, str, str, str, Any], ...] = (
    ("speed_mean_m_s", "mean speed", "m/s", "mean speed of its centre of mass", "speed_m_s", "mean"),
    ("speed_max_m_s", "peak speed", "m/s", "largest speed of its centre of mass", "speed_m_s", "max"),
    ("load_max_n", "largest load", "N", "largest upward force of what is fixed on it", "ground_z_n", "max"),
)
"""Name, label, unit, definition, column and reduction of what is the mean or the largest of one column."""
_of_movement = partial(Quantity, over="movement", steps=("run",))


def _of_part(side: str, part: str) -> Iterator[Quantity]:
    name, title = f"{side}_{part}", f"{side.capitalize()} {part}"
    for end, label, unit, about, column, reduce in _REDUCED:
        field = f"{name}_{column}"
        yield _of_movement(f"{name}_{end}", f"{title}: {label}", unit, about, reduce=reduce, field=field)
    for end, label, unit, about, function in _COMPUTED:
        source = VON_HOFSTEN if function is UNITS else None
        compute = function if isinstance(function, str) else partial(function, name)
        yield _of_movement(f"{name}_{end}", f"{title}: {label}", unit, about, compute=compute, source=source)


OF_MOVEMENT = tuple(
    quantity for part in ("hand", "foot") for side in ("right", "left") for quantity in _of_part(side, part)
)
