"""Builds the set of toys from a folder of meshes, each of which is converted to a toy."""

import os
from functools import cache, partial
from pathlib import Path

from mimoc.base.errors import ToyError
from mimoc.compiler.toys.placing import Toybox
from mimoc.compiler.toys.shape import Part, ToyModel
from mimoc.components.toys.toys4k import dataset
from mimoc.components.toys.toys4k.cache import MeshCache, key_of
from mimoc.components.toys.toys4k.convex import has_coacd
from mimoc.components.toys.toys4k.dataset import Toys4K, find_toys
from mimoc.components.toys.toys4k.processing import Shape, process
from mimoc.schema.toys import ToysSpec

DENSITY_KG_M3 = 300.0
"""Density of hollow plastic toys: between foam (30 kg/m³) and solid plastic or wood (500 to 1100 kg/m³)."""
OWN_SOURCE, OWN_MESH = "the folder of toys", "a mesh of the user's own"
SOURCE = "Toys4K (Stojanov et al. 2021), not to be passed on"


def load_toy(toys: Toys4K, name: str, cache: MeshCache | None = None) -> ToyModel:
    """Return the toy of one of the objects of a folder; the cache is of processed meshes.

    Raises:
        ToyError: If the object does not exist or its mesh cannot be used; the error names the object.
    """
    if name not in toys.objects:
        raise ToyError(
            dataset.unknown(toys, [name]).get(name, f"'{name}' is a category; name one of its objects"), name
        )
    path = toys.objects[name]
    file = dataset.legible(path.relative_to(toys.root).as_posix())
    try:
        shape = _shape(dataset.read_mesh(path, toys.root), path.suffix[1:].lower(), cache)
    except ToyError as error:
        raise ToyError(f"'{name}' ({file}) {error}; exclude it with 'subset', or repair the file", name) from None
    return ToyModel(
        name=name,
        category=dataset.category_of(name),
        parts=(Part(shape.looks),),
        solids=shape.solids,
        volume=shape.volume,
        density_kg_m3=DENSITY_KG_M3,
        source=f"{file} of {SOURCE if dataset.is_named_as_toys4k(name) else OWN_SOURCE}",
        notes=_notes(name, file, shape),
    )


def load_mesh(path: Path, cache: MeshCache | None = None) -> ToyModel:
    """Return the toy that a mesh file is.

    Raises:
        ToyError: If it cannot be read or used.
    """
    file, kind = dataset.legible(path.name), path.suffix[1:].lower()
    if kind not in dataset.FORMATS:
        raise ToyError(
            f"'{file}' is no mesh that can be read; give a file that ends with .{', .'.join(dataset.FORMATS)}"
        )
    try:
        shape = _shape(dataset.read_mesh(path, Path(os.path.realpath(path.parent))), kind, cache)
    except ToyError as error:
        raise ToyError(f"'{file}' {error}; give another file, or repair it") from None
    name, parts, source = dataset.legible(path.stem), (Part(shape.looks),), f"{file}, {OWN_MESH}"
    notes = _notes(name, file, shape)
    return ToyModel(name, name, parts, shape.solids, shape.volume, DENSITY_KG_M3, source, notes)


def _notes(name: str, file: str, shape: Shape) -> tuple[str, ...]:
    return (f"'{name}' ({file}) has holes: what is open collides as its convex hull",) if shape.has_holes else ()


def _shape(content: bytes, kind: str, cache: MeshCache | None) -> Shape:
    key = key_of(content, kind)
    shape = cache.load(key) if cache else None
    if shape is None:
        shape = process(content, kind)
        if cache:
            cache.save(key, shape)
    return shape


HULLS_ONLY = "each toy collides as its convex hull; for a closer fit, run: pip install 'mimoc[toys]', and build again"


def build(spec: ToysSpec, folder: Path) -> Toybox:
    """Return the toys that a spec selects from its `root`, which is relative to *folder*.

    Raises:
        ToyError: If there are no toys.
        UnknownToysError: If some of the selected names do not exist.
    """
    toys = find_toys(dataset.expand_root(str(spec.root), folder))
    notes = () if has_coacd() else (HULLS_ONLY,)
    return Toybox(dataset.choose(toys, spec.subset), cache(partial(load_toy, toys, cache=MeshCache())), notes)
