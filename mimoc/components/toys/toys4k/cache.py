"""Cache of processed meshes, by the content of the mesh file."""

import io
import os
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

import numpy as np

from mimoc.base.errors import OutputError
from mimoc.bundle.files import remove_temporary_files, write_file
from mimoc.compiler.toys.shape import Mesh, Solid
from mimoc.components.toys.toys4k.cleaning import has_simplifier
from mimoc.components.toys.toys4k.convex import has_coacd
from mimoc.components.toys.toys4k.processing import MAX_FACES_SEEN, VERSION, Shape

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
    """Return a shape as an archive."""
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
    """Return the shape in an archive, or None if it is not valid."""
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
    """Return a mesh after checking that it is valid; a `ValueError` says that it is not."""
    right = mesh.vertices.shape[1:] == mesh.faces.shape[1:] == (3,) and mesh.faces.dtype.kind == "i"
    right = right and len(mesh.faces) and np.isfinite(mesh.vertices).all()
    if not right or mesh.faces.min() < 0 or mesh.faces.max() >= len(mesh.vertices):
        raise ValueError("not a mesh")
    return mesh
