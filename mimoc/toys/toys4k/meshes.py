"""Conversion of a mesh of Toys4K to a toy."""

from mimoc.errors import ToyError
from mimoc.toys.model import Part, ToyModel
from mimoc.toys.toys4k.cache import MeshCache, key_of
from mimoc.toys.toys4k.dataset import Toys4K, category_of, is_named_as_toys4k, legible, read_mesh, unknown
from mimoc.toys.toys4k.processing import Shape, process

DENSITY_KG_M3 = 300.0
"""Density of hollow plastic toys: between foam (30 kg/m³) and solid plastic or wood (500 to 1100 kg/m³)."""
OWN_SOURCE = "the folder of toys"
SOURCE = "Toys4K (Stojanov et al. 2021), not to be passed on"


def load_toy(toys: Toys4K, name: str, cache: MeshCache | None = None) -> ToyModel:
    """Return the toy of an object of Toys4K.

    Args:
        toys: The objects of the folder.
        name: Name of the object.
        cache: Cache of processed meshes.

    Raises:
        ToyError: If the object does not exist or its mesh cannot be used; the error names the object.
    """
    if name not in toys.objects:
        raise ToyError(unknown(toys, [name]).get(name, f"'{name}' is a category; name one of its objects"), name)
    path = toys.objects[name]
    file = legible(path.relative_to(toys.root).as_posix())
    try:
        shape = _shape(read_mesh(path, toys.root), path.suffix[1:].lower(), cache)
    except ToyError as error:
        raise ToyError(f"'{name}' ({file}) {error}; exclude it with 'subset', or repair the file", name) from None
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
        if cache:
            cache.save(key, shape)
    return shape
