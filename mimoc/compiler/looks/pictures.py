"""PNG pictures: those that ship with mimoc, which `make pictures` paints (see `sculpt/`), and encoding of others."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image

FOLDER = Path(__file__).parent / "painted"


def read_picture(name: str) -> bytes:
    """Return a PNG that ships with mimoc, such as `eye` or `floor_cork`."""
    return (FOLDER / f"{name}.png").read_bytes()


def encode_png(image: npt.NDArray[Any]) -> bytes:
    """Return the PNG of an RGB image of 0 to 255, shape (rows, columns, 3), without any metadata."""
    return png_of(Image.fromarray(np.rint(image).astype(np.uint8)))


def encode_palette_png(image: npt.NDArray[Any], colours: int = 64) -> bytes:
    """Return the PNG of an RGB image of 0 to 255, shape (rows, columns, 3), with a palette: a third of the size."""
    return png_of(Image.fromarray(np.rint(image).astype(np.uint8)).quantize(colours, Image.Quantize.MEDIANCUT))


def png_of(image: Image.Image, compress_level: int = 6) -> bytes:
    """Return the PNG of an image, the same on every system."""
    buffer = io.BytesIO()
    image.save(buffer, "PNG", compress_level=compress_level)
    return buffer.getvalue()
