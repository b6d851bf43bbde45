"""Functions for drawing seamless textures: all of them are periodic over a tile."""

import numpy as np
import numpy.typing as npt
from pictures.cubes import over

from mimoc.base.geometry.rotations import FloatArray
from mimoc.compiler.looks.pictures import Colour

TILE_PX = 256  # Size of a tile.
SOFT = 1.5 / TILE_PX  # Width of the blend at an edge, in tiles.

Field = FloatArray  # One value per texel, shape `(TILE_PX, TILE_PX)`.


def grid() -> tuple[Field, Field]:
    """Return the coordinates of each texel, rightwards and downwards, 0 to 1."""
    steps = (np.arange(TILE_PX, dtype=np.float64) + 0.5) / TILE_PX
    right, down = np.meshgrid(steps, steps)
    return right, down


def plain(colour: Colour, tone: Field | float = 0.0) -> FloatArray:
    """Return a tile of one colour, lightened by *tone*, or darkened where it is negative."""
    shade = np.broadcast_to(1 + np.asarray(tone, np.float64), (TILE_PX, TILE_PX))
    return lit(np.full((TILE_PX, TILE_PX, 3), colour, np.float64), shade)


def lit(image: FloatArray, shade: npt.NDArray[np.floating]) -> FloatArray:
    """Return an image with its brightness multiplied by *shade*."""
    return np.clip(image * shade[..., None], 0, 255)


def cells(along: Field, count: int) -> tuple[Field, Field]:
    """Return the index of each texel's cell among *count* equal ones, and its position in it, -0.5 to 0.5."""
    scaled = along * count
    index = np.floor(scaled)
    return index, scaled - index - 0.5


def half_drop(count: int) -> tuple[Field, Field]:
    """Return the position of each texel in its cell, -0.5 to 0.5 rightwards and downwards.

    As on wallpaper, every other column is half a cell lower.

    Args:
        count: Of cells in a row, and of rows; even.
    """
    right, down = grid()
    column, x = cells(right, count)
    _, y = cells((down + (column % 2) / (2 * count)) % 1, count)
    return x, y


def noise(seed: int, across_px: float, down_px: float) -> Field:
    """Return smooth noise, -1 to 1, with spots of about the given size."""
    white = np.random.Generator(np.random.PCG64(seed)).random((TILE_PX, TILE_PX)) - 0.5
    rows, columns = np.fft.fftfreq(TILE_PX)[:, None], np.fft.rfftfreq(TILE_PX)[None, :]
    spectrum = np.exp(-2 * ((columns * across_px) ** 2 + (rows * down_px) ** 2))
    spectrum[0, 0] = 0
    smooth = np.fft.irfft2(np.fft.rfft2(white) * spectrum, (TILE_PX, TILE_PX))
    return smooth / np.abs(smooth).max()


def tones(seed: int, row: Field, column: Field) -> Field:
    """Return one tone for each cell, -1 to 1, the same for all of its texels."""
    table = np.random.Generator(np.random.PCG64(seed)).random((16, 16)) * 2 - 1
    return table[row.astype(np.intp), column.astype(np.intp)]


def paint(image: FloatArray, colour: Colour, distance: Field, softness: float = SOFT) -> FloatArray:
    """Return *image* with *colour* where *distance* is negative; distance and softness in the same unit."""
    return over(image, colour, np.clip(0.5 - distance / softness, 0, 1))
