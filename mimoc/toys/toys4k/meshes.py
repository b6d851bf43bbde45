"""The toys that the meshes of Toys4K become."""

import os
from pathlib import Path

from mimoc.errors import ToyError
from mimoc.toys.model import Part, ToyModel
from mimoc.toys.toys4k.cache import MeshCache, key_of
from mimoc.toys.toys4k.dataset import Toys4K, category_of, is_named_as_toys4k, legible, lies_in, unknown
from mimoc.toys.toys4k.processing import Shape, process

DENSITY_KG_M3 = 300.0
"""Of toys of hollow plastic: between those of foam (30 kg/m³) and of solid plastic or wood (500 to 1100 kg/m³)."""
MOST_BYTES = 500 * 10**6
OWN_SOURCE = "the folder of toys"
SOURCE = "Toys4K (Stojanov et al. 2021), not to be passed on"


def load_toy(found: Toys4K, name: str, cache: MeshCache | None = None) -> ToyModel:
    """Return the toy that an object of Toys4K becomes.

    Args:
        found: Where it is.
        name: Of the object.
        cache: Of what meshes became before.

    Raises:
        ToyError: If there is no such object, or nothing can be made of its mesh; it names the object.
    """
    if name not in found.objects:
        raise ToyError(unknown(found, [name]).get(name, f"'{name}' is a category; name one of its objects"), name)
    path = found.objects[name]
    file = legible(path.relative_to(found.root).as_posix())
    try:
        shape = _shape(_content(path, found.root), path.suffix[1:].lower(), cache)
    except ToyError as error:
        raise ToyError(f"'{name}' ({file}) {error}; leave it out with 'subset', or repair the file", name) from None
    return ToyModel(
        name=name,
        category=category_of(name),
        parts=(Part(shape.looks),),
        solids=shape.solids,
        volume=shape.volume,
        density_kg_m3=DENSITY_KG_M3,
        source=f"{file} of {SOURCE if is_named_as_toys4k(name) else OWN_SOURCE}",
    )


def _shape(content: bytes, kind: str, cache: MeshCache | None) -> Shape:
    key = key_of(content, kind)
    shape = cache.load(key) if cache else None
    if shape is None:
        shape = process(content, kind)
        if cache and shape.lasting:
            cache.save(key, shape)
    return shape


def _content(path: Path, root: Path) -> bytes:
    """Return all of a file of a size that can be worked with, that is still below the root."""
    if not lies_in(path, root):
        raise ToyError(f"is a link to a file out of {root}")
    try:
        with open(os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)), "rb") as file:
            content = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise ToyError(f"cannot be read ({error.strerror})") from None
    if not content:
        raise ToyError("is an empty file")
    if len(content) > MOST_BYTES:
        raise ToyError(f"has more than {MOST_BYTES / 1e6:.0f} MB")
    return content
