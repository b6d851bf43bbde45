"""MIMo3's sizes of geoms as factors of parts, which what hangs on a part follows."""

from collections.abc import Mapping
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.compiler.child import child_of
from mimoc.schema.infant import InfantSpec

LIMBS = {
    "left_uarm1": "left_upper_arm",
    "left_larm": "left_lower_arm",
    "geom:left_upper_leg1": "left_upper_leg",
    "geom:left_lower_leg1": "left_lower_leg",
}
"""The capsules of limbs, by MIMo3's names, and the parts that they belong to."""
SIZES = ("girth", "length")
"""What each size of a capsule depends on: its radius, then half of its length without the caps."""
STEP = 0.05
"""By how much a factor is changed to see what a size makes of it."""


def factors_of_geoms(spec: InfantSpec, sizes: Mapping[Any, float]) -> dict[str, dict[str, float]]:
    """Return factors of both sides' parts that give geoms of the left side sizes in [m], or raise a MimocError."""
    factors: dict[str, dict[str, float]] = {}
    for key in sizes:
        if not isinstance(key, tuple) or len(key) != 2 or key[0] not in LIMBS or key[1] not in (0, 1):
            raise MimocError(
                f"custom_measurements: {key!r} is not translated; give a measurement in cm, such as 'hand_length_cm', "
                f"or (geom, 0) for the radius and (geom, 1) for the half length of {', '.join(LIMBS)}"
            )
    for geom, index in sorted(sizes, key=lambda key: key[1]):  # Lengths depend on girths.
        factors = _with_size(spec, factors, geom, index, float(sizes[geom, index]))
    return factors


def _with_size(
    spec: InfantSpec, factors: dict[str, dict[str, float]], geom: str, index: int, size_m: float
) -> dict[str, dict[str, float]]:
    """Return the factors with the one of a size: sizes are straight lines over their factors."""
    part, key = LIMBS[geom], SIZES[index]

    def with_factor(factor: float) -> dict[str, dict[str, float]]:
        sides = (part, part.replace("left", "right"))
        return {**factors, **{side: {**factors.get(side, {}), key: factor} for side in sides}}

    def size_at(factor: float) -> float:
        tree = child_of(spec.with_(body={"parts": with_factor(factor)})).tree
        name = geom.removeprefix("geom:")
        return next(shape.size_m[index] for body in tree.bodies for shape in body.geoms if shape.name == name)

    now_m = size_at(1.0)
    return with_factor(1 + STEP * (size_m - now_m) / (size_at(1 + STEP) - now_m))
