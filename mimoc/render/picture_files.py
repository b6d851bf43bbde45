"""Pictures as files, in the format that the file's name says."""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.bundle.files import write_file
from mimoc.errors import OutputError

_JPEG = ("JPEG", {"quality": 95, "subsampling": 0})
_TIFF = ("TIFF", {"compression": "tiff_deflate"})
FORMATS: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    ".png": ("PNG", {"compress_level": 6}),
    ".jpg": _JPEG,
    ".jpeg": _JPEG,
    ".webp": ("WEBP", {"lossless": True}),
    ".bmp": ("BMP", {}),
    ".tif": _TIFF,
    ".tiff": _TIFF,
}
"""Pillow's name of the format, and how it is to be written, by the end of a file's name."""


OPAQUE = {".jpg", ".jpeg", ".bmp"}
"""Formats that have no transparent background."""


def check_picture_name(path: str | Path, *, transparent: bool = False) -> None:
    """Pass the name of a file that a picture can be written to, before anything is drawn.

    Raises:
        OutputError: If it ends in no format that is known, or in one that cannot be transparent.
    """
    suffix = Path(path).suffix.lower()
    if transparent and suffix in OPAQUE:
        fitting = ", ".join(ending for ending in FORMATS if ending not in OPAQUE)
        raise OutputError(f"{path}: a picture of this format has no transparent background; end its name in {fitting}")
    if suffix not in FORMATS:
        raise OutputError(f"{path}: no picture is written to a file of this name; end it in {', '.join(FORMATS)}")


def write_picture(path: str | Path, picture: npt.NDArray[Any]) -> Path:
    """Write an RGB or RGBA picture of 0 to 255, shape (height, width, 3 or 4), without any metadata.

    Raises:
        OutputError: If its name ends in no format that is known, or it cannot be written.
    """
    check_picture_name(path, transparent=picture.shape[-1] == 4)
    return write_file(path, encoded(picture, Path(path).suffix.lower()))


def encoded(picture: npt.NDArray[Any], suffix: str) -> bytes:
    """Return an RGB or RGBA picture of 0 to 255, shape (height, width, 3 or 4), in a format of FORMATS."""
    name, settings = FORMATS[suffix]
    buffer = io.BytesIO()
    Image.fromarray(np.rint(picture).astype(np.uint8)).save(buffer, name, **settings)
    return buffer.getvalue()
