"""Toys from a folder of meshes, each of which is processed once and cached by the content of its file."""

import io
import os
from contextlib import suppress
from functools import cache, partial
from hashlib import sha256
from pathlib import Path

import numpy as np

from mimoc.base.errors import OutputError, ToyError
from mimoc.bundle.files import remove_temporary_files, write_file
from mimoc.compiler.toys import Mesh, Part, Solid, Toybox, ToyModel
from mimoc.components.toys.toys4k import dataset
from mimoc.components.toys.toys4k.dataset import Toys4K, find_toys
from mimoc.components.toys.toys4k.meshes import has_coacd, has_simplifier
from mimoc.components.toys.toys4k.processing import MAX_FACES_SEEN, VERSION, Shape, process
from mimoc.schema.objects import ToysSpec

VARIABLE = "MIMOC_CACHE"
MAX_BYTES = 2**25  # Maximum size of an entry; intact entries are far smaller.


class MeshCache:
    """A folder of processed shapes, one file each; missing or damaged ones are processed again.

    Any number of processes can use it at the same time; if it cannot be written, nothing is cached.
    """

    def __init__(self, folder: Path | None = None):
        self.folder = (folder or default_folder()) / "meshes"

    def load(self, key: str) -> Shape | None:
        """Return the shape that was saved as *key*, or None if it is missing or damaged."""
        try:
            path = self._path(key)
            return _unpacked(path.read_bytes()) if path.stat().st_size <= MAX_BYTES else None
        except Exception:  # A damaged archive can raise any error; the shape is then processed again.
            return None

    def save(self, key: str, shape: Shape) -> None:
        """Save a shape, if the folder can be written, and remove what killed processes have left behind there."""
        with suppress(OSError, OutputError):
            self.folder.mkdir(parents=True, exist_ok=True)
            remove_temporary_files(self.folder)
            write_file(self._path(key), _packed(shape))

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}.npz"


def key_of(content: bytes, kind: str) -> str:
    """Return the digest of everything a shape depends on: the mesh file, its format and the processing libraries."""
    tools = f"{VERSION} {kind} coacd={has_coacd()} fast_simplification={has_simplifier()}"
    return sha256(tools.encode() + b"\n" + sha256(content).digest()).hexdigest()


def default_folder() -> Path:
    """Return the folder given by `MIMOC_CACHE`, by default the user's cache folder on this system."""
    import platformdirs

    return Path(os.path.expanduser(os.environ.get(VARIABLE) or platformdirs.user_cache_dir("mimoc")))


def _packed(shape: Shape) -> bytes:
    boxes = [(*solid.size, *solid.pos, *solid.quat) for solid in shape.solids if solid.mesh is None]
    hulls = [solid.mesh for solid in shape.solids if solid.mesh is not None]
    file = io.BytesIO()
    np.savez_compressed(
        file,
        boxes=np.array(boxes).reshape(-1, 10),
        counts=np.array([(len(mesh.vertices), len(mesh.faces)) for mesh in (shape.looks, *hulls)]),
        vertices=np.concatenate([mesh.vertices for mesh in (shape.looks, *hulls)]),
        faces=np.concatenate([mesh.faces for mesh in (shape.looks, *hulls)]),
        volume=np.array(shape.volume),
        has_holes=np.array(shape.has_holes),
    )
    return file.getvalue()


def _unpacked(content: bytes) -> Shape | None:
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        boxes, counts, vertices, faces, volume, has_holes = (
            arrays[name] for name in ("boxes", "counts", "vertices", "faces", "volume", "has_holes")
        )
    ends = np.cumsum(counts, axis=0)[:-1]
    pairs = zip(np.split(vertices, ends[:, 0]), np.split(faces, ends[:, 1]), strict=True)
    looks, *hulls = (_checked(Mesh(*pair)) for pair in pairs)
    solids = [
        *(Solid("box", (a, b, c), (x, y, z), (qw, qx, qy, qz)) for a, b, c, x, y, z, qw, qx, qy, qz in boxes.tolist()),
        *(Solid("mesh", (), mesh=mesh) for mesh in hulls),
    ]
    whole = len(looks.faces) <= MAX_FACES_SEEN and solids and 0 < volume < np.inf
    return Shape(looks, tuple(solids), float(volume), bool(has_holes)) if whole else None


def _checked(mesh: Mesh) -> Mesh:
    right = mesh.vertices.shape[1:] == mesh.faces.shape[1:] == (3,) and mesh.faces.dtype.kind == "i"
    right = right and len(mesh.faces) and np.isfinite(mesh.vertices).all()
    if not right or mesh.faces.min() < 0 or mesh.faces.max() >= len(mesh.vertices):
        raise ValueError("not a mesh")
    return mesh


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
    """Return the toy that a mesh file is; raise a ToyError if it cannot be read or used."""
    file, kind = dataset.legible(path.name), path.suffix[1:].lower()
    if kind not in dataset.FORMATS:
        raise ToyError(
            f"'{file}' is no mesh that can be read; give a file that ends with .{', .'.join(dataset.FORMATS)}"
        )
    try:
        shape = _shape(dataset.read_mesh(path, Path(os.path.realpath(path.parent))), kind, cache)
    except ToyError as error:
        raise ToyError(f"'{file}' {error}; give another file, or repair it") from None
    name = dataset.legible(path.stem)
    parts = (Part(shape.looks),)
    source = f"{file}, {OWN_MESH}"
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
