"""The toys that come with mimoc, as data that `.ci/task toys` makes (see `sculpt/toys/`)."""

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import UnknownToysError, suggestion
from mimoc.compiler.toys import Mesh, Part, Solid, Toybox, ToyModel
from mimoc.schema.objects import ToysSpec

MESHES, FIGURES = (Path(__file__).with_name(f"toys.{suffix}") for suffix in ("npz", "json"))
"""The meshes of the parts of all toys, `<toy>/<tint>/vertices` and `faces`; everything else by toy."""
NAMES: tuple[str, ...] = tuple(json.loads(FIGURES.read_text(encoding="utf-8")))
"""Names of the toys, sorted; each is also its category."""


def build(spec: ToysSpec, folder: Path) -> Toybox:
    """Return the built-in toys that a spec selects.

    Raises:
        UnknownToysError: If some of the selected names do not exist.
    """
    unknown = [name for name in spec.subset if name not in NAMES]
    if unknown:
        advice = {name: suggestion(name, NAMES) for name in unknown}
        raise UnknownToysError({name: f"'{name}' is not one of mimoc's toys; {advice[name]}" for name in unknown})
    return Toybox(tuple(sorted(spec.subset)) or NAMES, load_toy)


@cache
def load_toy(name: str) -> ToyModel:
    """Return a toy by its name, the same object each time."""
    figures: dict[str, Any] = json.loads(FIGURES.read_text(encoding="utf-8"))[name]
    with np.load(MESHES) as arrays:
        parts = tuple(
            Part(Mesh(arrays[f"{name}/{tint}/vertices"], arrays[f"{name}/{tint}/faces"].astype(np.intp)), tint)
            for tint in figures["tints"]
        )
    solids = tuple(
        Solid(solid["type"], tuple(solid["size"]), tuple(solid["pos"]), tuple(solid["quat"]))
        for solid in figures["solids"]
    )
    return ToyModel(name, name, parts, solids, figures["volume"], figures["density_kg_m3"], figures["source"])


BUILTIN_TOYS = Toybox(NAMES, load_toy)
