"""Wooden blocks, to choose from."""

from functools import partial
from pathlib import Path

import trimesh

from mimoc.base.errors import UnknownToysError, suggestion
from mimoc.compiler.toys import Mesh, Solid, Toybox, ToyModel, assemble
from mimoc.schema.objects import ToysSpec

SIZES = {"cube": (1.0, 1.0, 1.0), "slab": (1.0, 0.5, 0.25), "column": (0.4, 0.4, 1.0)}
"""Edges, by name; toys are scaled to the size that a scene wants."""


def build(spec: ToysSpec, folder: Path) -> Toybox:
    """Return the blocks that a spec wants.

    Raises:
        UnknownToysError: If there are none of some names.
    """
    unknown = [name for name in spec.subset if name not in SIZES]
    if unknown:
        raise UnknownToysError({name: f"'{name}' is not a block; {suggestion(name, SIZES)}" for name in unknown})
    density_kg_m3 = spec.blocks.density_kg_m3
    return Toybox(tuple(sorted(spec.subset)) or tuple(SIZES), partial(_shape, density_kg_m3=density_kg_m3))


def _shape(name: str, density_kg_m3: float) -> ToyModel:
    x, y, z = SIZES[name]
    block = trimesh.creation.box((x, y, z))
    looks = {"main": [Mesh(block.vertices, block.faces)]}
    return assemble(name, looks, [Solid("box", (x / 2, y / 2, z / 2))], density_kg_m3)
