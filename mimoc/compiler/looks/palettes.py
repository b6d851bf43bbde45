"""Painted pictures in the colours of an infant: only their palettes are written anew.

Each colour of a palette is a mixture of inks, which `make pictures` stores beside the pictures. The texels stay as they
are compressed, so that a picture has the same bytes on all machines.
"""

import zlib
from collections.abc import Iterator, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.arrays import read_arrays
from mimoc.compiler.looks.colours import INKS, Colour
from mimoc.compiler.looks.pictures import FOLDER, read_picture

SIGNATURE_BYTES = 8
"""What a PNG begins with."""
MIXTURES = "mixtures.npz"
"""The file of mixtures: by picture, the amount of each ink in each colour; and `inks`, their names."""


@cache
def mixtures() -> Mapping[str, npt.NDArray[np.uint8]]:
    """Return the amounts of inks in the palette of each picture that is recoloured, shape (colours, inks)."""
    arrays = read_arrays(FOLDER / MIXTURES)
    inks = arrays.pop("inks").tolist()
    columns = [inks.index(ink) for ink in INKS]
    return MappingProxyType({name: amounts[:, columns] for name, amounts in arrays.items()})


def coloured_picture(name: str, inks: Mapping[str, Colour]) -> bytes:
    """Return a painted PNG in the colours of an infant; one that is not mixed of inks, as it was painted."""
    mixture, png = mixtures().get(name), read_picture(name)
    return png if mixture is None else with_palette(png, mixed(mixture, inks))


def mixed(amounts: npt.NDArray[Any], inks: Mapping[str, Colour]) -> npt.NDArray[np.uint8]:
    """Return the colours of some mixtures.

    The colour of a mixture is the mean of its inks, weighted by their amounts m: c = sum(m_i c_i) / sum(m_i). It is
    computed in whole numbers, and rounded half up.

    Args:
        amounts: Of inks in the order of `INKS`, whole numbers, shape (n, inks).
        inks: Their colours.

    Returns:
        Red, green and blue, shape (n, 3).
    """
    colours = np.array([inks[name] for name in INKS]).astype(np.int64)
    amounts = np.asarray(amounts, np.int64)
    total = amounts.sum(axis=1, keepdims=True)
    weighted = (amounts[:, :, None] * colours).sum(axis=1)
    return ((2 * weighted + total) // (2 * total)).astype(np.uint8)


def with_palette(png: bytes, colours: npt.NDArray[np.uint8]) -> bytes:
    """Return a PNG with other colours in its palette, shape (n, 3), as many as it has."""
    parts = [png[:SIGNATURE_BYTES]]
    for kind, content in _chunks(png):
        content = colours.tobytes() if kind == b"PLTE" else content
        parts += [len(content).to_bytes(4, "big"), kind, content, zlib.crc32(kind + content).to_bytes(4, "big")]
    return b"".join(parts)


def _chunks(png: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield the kind and the content of each chunk of a PNG."""
    start = SIGNATURE_BYTES
    while start < len(png):
        length = int.from_bytes(png[start : start + 4], "big")
        yield png[start + 4 : start + 8], png[start + 8 : start + 8 + length]
        start += length + 12
