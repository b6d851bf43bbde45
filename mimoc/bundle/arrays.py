"""Large arrays of a bundle in one NumPy archive, `arrays.npz`, which is the same to the byte on every system."""

import io
import math
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import BundleError

ARRAYS = "arrays.npz"  # Path in the bundle; a bundle without arrays has no such file.
SUFFIX = ".npy"
FIRST_DATE = (1980, 1, 1, 0, 0, 0)  # The earliest that a ZIP archive can hold: a build has no date.
UNIX = 3
READABLE = 0o644 << 16  # System and permissions in the archive, which Python would take from where it runs.
NUMBERS = "biuf"  # Kinds of `numpy.dtype` that arrays may have: no objects, no text.

Array = npt.NDArray[Any]


class LazyArrays(Mapping[str, Array]):
    """Arrays by name, of which some are made when one of them is first asked for; all are read-only."""

    def __init__(self, ready: Mapping[str, Array], names: Sequence[str], make: Callable[[], Mapping[str, Array]]):
        self._ready, self._names, self._make = ready, tuple(names), make

    @cached_property
    def _made(self) -> Mapping[str, Array]:
        return self._make()

    def __getitem__(self, name: str) -> Array:
        return self._made[name] if name in self._names else self._ready[name]

    def __iter__(self) -> Iterator[str]:
        return iter((*self._ready, *self._names))

    def __len__(self) -> int:
        return len(self._ready) + len(self._names)


def pack_arrays(arrays: Mapping[str, Array]) -> bytes:
    """Return an archive that `numpy.load` reads: not compressed, sorted by name."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name in sorted(arrays):
            info = zipfile.ZipInfo(name + SUFFIX, FIRST_DATE)
            info.create_system, info.external_attr = UNIX, READABLE
            array = arrays[name]
            file = io.BytesIO()
            little_endian = np.asarray(array, array.dtype.newbyteorder("<"), order="C")
            np.lib.format.write_array(file, little_endian, version=(1, 0), allow_pickle=False)
            archive.writestr(info, file.getvalue())
    return packed.getvalue()


def unpack_arrays(content: bytes) -> dict[str, Array]:
    """Return the arrays that `pack_arrays` wrote, read-only views of the archive, or raise a BundleError."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
            is_plain = all(member.compress_type == zipfile.ZIP_STORED for member in members)
            if not is_plain or sum(member.file_size for member in members) > len(content):
                raise ValueError("it is compressed")
            return {member.filename.removesuffix(SUFFIX): _unpacked(archive.read(member)) for member in members}
    except Exception:  # Whatever a stranger's archive makes the readers of ZIP and NPY raise.
        raise BundleError(f"{ARRAYS} is damaged; build the bundle again") from None


def _unpacked(content: bytes) -> Array:
    file = io.BytesIO(content)
    if np.lib.format.read_magic(file) != (1, 0):
        raise ValueError("it is of another version")
    shape, is_fortran, kind = np.lib.format.read_array_header_1_0(file)
    if kind.kind not in NUMBERS or is_fortran or math.prod(shape) * kind.itemsize != len(content) - file.tell():
        raise ValueError("its size is not what it says")
    return np.frombuffer(content, kind, offset=file.tell()).reshape(shape)
