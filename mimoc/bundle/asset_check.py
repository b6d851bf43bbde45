"""Whether pictures, meshes and skins of a bundle are as large as they say, and no larger than infants need."""

import struct
import zlib
from collections.abc import Callable, Mapping

import numpy as np

from mimoc.base.errors import BundleError
from mimoc.bundle.regular_files import UnusableFileError

MOST_SIDE_PX = 4096  # Pixels along a side of a picture; those of infants have 512 at most.
MOST_PIXELS = 2**26  # Pixels of all pictures of a bundle, which take three bytes each once they are decoded.
MOST_FACES = 20_000  # Triangles of a mesh; toys have at most 5,000.
MOST_MESH_BYTES = 10 * 2**20  # Of all meshes of a bundle together; fifty toys of 5,000 triangles each have 8 MB.
MOST_VERTICES = 200_000  # Vertices of all skins of a bundle; an infant has 7,500.
SURELY_SMALL = 2**16
"""Bytes of a picture that need not be tried: Deflate's ratio is at most 1032, so that they unpack to 64 MB at most, and
MuJoCo refuses the first one that is larger than it says."""

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_CHUNKS = (b"IHDR", b"PLTE", b"tRNS", b"IDAT", b"IEND")
"""Chunks that mimoc writes; others can have compressed texts inside."""
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # Numbers of a pixel by colour type (PNG specification, table 11.1).
_NAME_BYTES = 40  # The name of a bone in MuJoCo's files of skins.


def check_assets(files: Mapping[str, bytes], references: Mapping[str, str]) -> None:
    """Raise a BundleError if a file that the MJCF refers to, by element and path, is missing, damaged or too large."""
    sizes = dict.fromkeys(_CHECKS, 0)
    for path, element in references.items():
        if path not in files:
            raise BundleError(f"{path}: <{element}> refers to it, but it is not among the files of the bundle")
        try:
            sizes[element] += _CHECKS[element](files[path])
        except UnusableFileError as error:
            raise BundleError(f"{path}: {error}") from None
        if sizes[element] > _MOST[element]:
            raise BundleError(f"{path}: with this one, every <{element}> together is larger than any infant needs")


def pixels_of(content: bytes, *, is_ours: bool = True) -> int:
    """Return the number of pixels of a PNG; UnusableFileError if it is none, too large, or unpacks to more.

    If it *is_ours* it may only contain what mimoc writes; other programs also write 16 bits, texts and profiles.
    """
    data = b"".join(_chunks(content, is_ours))
    width, height, depth, colour = struct.unpack_from(">IIBB", content, 16)
    if not 0 < width <= MOST_SIDE_PX or not 0 < height <= MOST_SIDE_PX:
        raise UnusableFileError(
            f"it says that it has {width:,} x {height:,} pixels; at most {MOST_SIDE_PX:,} a side may be"
        )
    if depth > (8 if is_ours else 16) or colour not in _CHANNELS:
        raise UnusableFileError("its colours are of a kind that mimoc never writes")
    if len(data) > SURELY_SMALL:
        bytes_of_all = (1 + (width * _CHANNELS[colour] * depth + 7) // 8) * height
        most = bytes_of_all if is_ours else 2 * bytes_of_all  # Interlaced ones have more rows, each with a byte more.
        unpacked = zlib.decompressobj()
        try:
            size = len(unpacked.decompress(data, most + 1))
        except zlib.error:
            size = 0
        if not bytes_of_all <= size <= most:
            raise UnusableFileError("it has not as many pixels as it says")
    return width * height


def _chunks(content: bytes, is_ours: bool) -> list[bytes]:
    """Return the compressed data of a PNG, checked chunk by chunk."""
    if content[:8] != _SIGNATURE or content[12:16] != b"IHDR" or len(content) < 45:
        raise UnusableFileError("it is not a PNG")
    place, compressed = 8, []
    while place + 12 <= len(content):
        size, kind = struct.unpack_from(">I4s", content, place)
        if (is_ours and kind not in _CHUNKS) or place + 12 + size > len(content):
            raise UnusableFileError("it is damaged, or not a PNG as mimoc writes it")
        if kind == b"IDAT":
            compressed.append(content[place + 8 : place + 8 + size])
        place += 12 + size
    return compressed


def _mesh_bytes(content: bytes) -> int:
    if content.translate(None, b"0123456789-+.e \nvf") or content[:2] != b"v ":
        raise UnusableFileError("it is not an OBJ of vertices and triangles alone")
    if content.count(b"f") > MOST_FACES or content.count(b"v") > MOST_FACES:
        raise UnusableFileError(f"it has more than {MOST_FACES:,} triangles")
    return len(content)


def _vertices(content: bytes) -> int:
    if len(content) < 16:
        raise UnusableFileError("it is not a skin")
    verts, texcoords, faces, bones = np.frombuffer(content, "<i4", 4).tolist()
    if min(verts, faces, bones) < 1 or texcoords not in (0, verts) or verts > MOST_VERTICES:
        raise UnusableFileError("its sizes are not those of a skin")
    place = 16 + 12 * verts + 8 * texcoords
    indices = _indices(content, place, 3 * faces, verts)
    place += indices
    for _ in range(bones):
        head = place + _NAME_BYTES + 28
        count = int(_integers(content, head, 1)[0])
        place = head + 4 + 2 * _indices(content, head + 4, count, verts)
    if place != len(content):
        raise UnusableFileError("it is longer or shorter than it says")
    return verts


def _indices(content: bytes, place: int, count: int, verts: int) -> int:
    vertices = _integers(content, place, count)
    if len(vertices) and (vertices.min() < 0 or vertices.max() >= verts):
        raise UnusableFileError("it refers to vertices that it does not have")
    return 4 * count


def _integers(content: bytes, place: int, count: int) -> "np.ndarray":
    if count < 0 or place + 4 * count > len(content):
        raise UnusableFileError("it is longer or shorter than it says")
    return np.frombuffer(content, "<i4", count, place)


_CHECKS: Mapping[str, Callable[[bytes], int]] = {"texture": pixels_of, "mesh": _mesh_bytes, "skin": _vertices}
_MOST = {"texture": MOST_PIXELS, "mesh": MOST_MESH_BYTES, "skin": MOST_VERTICES}
