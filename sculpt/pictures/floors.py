"""Textures of floors and ceilings, and what draws seamless ones: all functions are periodic over a tile."""

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


BOARDS = 6  # Number of boards side by side in a tile.
MAT_COLOURS: tuple[Colour, ...] = ((238, 130, 112), (250, 205, 104), (126, 190, 150), (112, 160, 208))


def oak_boards() -> FloatArray:
    """Return light boards with their ends staggered."""
    return _boards((206, 160, 108), (132, 92, 56), 0.13)


def dark_boards() -> FloatArray:
    """Return walnut boards with their ends staggered."""
    return _boards((126, 82, 54), (66, 40, 26), 0.2)


def parquet() -> FloatArray:
    """Return blocks of four staves, each block across its neighbours."""
    right, down = grid()
    column, x = cells(right, 4)
    row, y = cells(down, 4)
    lying = (row + column) % 2 == 0
    stave, inside = cells(np.where(lying, y, x) + 0.5, 4)
    grain = np.where(lying, noise(31, 14, 1.2), noise(32, 1.2, 14))
    tone = 0.1 * tones(33, row * 4 + stave, column * 4 + stave) + 0.16 * grain + np.where(lying, 0.05, -0.05)
    image = plain((192, 138, 88), tone)
    image = paint(image, (112, 74, 44), 0.44 - np.abs(inside), 0.12)
    return paint(image, (98, 62, 36), 0.485 - np.maximum(np.abs(x), np.abs(y)), 0.02)


def chequered_tiles() -> FloatArray:
    """Return a checkerboard of cream and blue tiles."""
    right, down = grid()
    column, x = cells(right, 2)
    row, y = cells(down, 2)
    cream, blue = (240, 232, 214), (92, 122, 146)
    dark = (row + column) % 2 == 1
    image = np.where(dark[..., None], plain(blue), plain(cream))
    image = lit(image, 1 + 0.05 * noise(41, 9, 9) + 0.02 * tones(42, row, column))
    return paint(image, (198, 190, 176), 0.488 - np.maximum(np.abs(x), np.abs(y)), 0.012)


def terracotta() -> FloatArray:
    """Return square terracotta tiles, each of a different colour."""
    right, down = grid()
    column, x = cells(right, 4)
    row, y = cells(down, 4)
    tone = 0.13 * tones(51, row, column) + 0.08 * noise(52, 5, 5)
    image = plain((196, 106, 72), tone)
    rounded = np.maximum(np.abs(x), np.abs(y)) + 0.12 * np.minimum(np.abs(x), np.abs(y)) ** 2
    image = paint(image, (150, 76, 50), 0.46 - rounded, 0.04)
    return paint(image, (214, 196, 172), 0.475 - rounded, 0.02)


def carpet() -> FloatArray:
    """Return a blue carpet with diamonds."""
    right, down = grid()
    _, x = cells(right, 4)
    _, y = cells(down, 4)
    diamond = np.abs(x) + np.abs(y)
    image = plain((78, 104, 142))
    image = paint(image, (222, 206, 170), np.abs(diamond - 0.42) - 0.04, 0.03)
    image = paint(image, (186, 92, 84), diamond - 0.2, 0.03)
    return lit(image, 1 + 0.12 * noise(61, 0.9, 0.9))


def play_mat() -> FloatArray:
    """Return four colours of foam squares, linked like a jigsaw."""
    right, down = grid()
    column, x = cells((right + _teeth(down)) % 1, 2)
    row, y = cells((down + _teeth(right)) % 1, 2)
    image = np.asarray(MAT_COLOURS, np.float64)[(2 * row + column).astype(np.intp)]
    image = lit(image, 1 + 0.03 * noise(71, 1, 1))
    image = paint(image, (90, 84, 80), 0.49 - np.maximum(np.abs(x), np.abs(y)), 0.012)
    ring = np.hypot(cells(right, 2)[1], cells(down, 2)[1])
    return paint(image, (252, 244, 226), np.abs(ring - 0.2) - 0.03, 0.02)


def cork() -> FloatArray:
    """Return brown grains, large and small."""
    image = plain((194, 146, 96), 0.14 * noise(81, 30, 30) + 0.12 * noise(82, 1.2, 1.2))
    image = paint(image, (122, 80, 48), 0.34 - noise(83, 4, 3), 0.12)
    return paint(image, (228, 188, 140), 0.40 - noise(84, 4.5, 4.5), 0.12)


def _boards(colour: Colour, gap: Colour, contrast: float) -> FloatArray:
    """Return vertical boards, each with its own tone, grain and end."""
    right, down = grid()
    board, x = cells(right, BOARDS)
    end = (0.37 * board + 0.11) % 1
    below = (down - end) % 1
    grain = noise(21, 0.8, 20) + 0.5 * noise(22, 2, 46)
    image = plain(colour, contrast * tones(23, board, 0 * board) + 0.7 * contrast * grain)
    image = paint(image, gap, 0.474 - np.abs(x), 0.03)
    return paint(image, gap, np.minimum(below, 1 - below) - 0.0035, 0.004)


def _teeth(along: Field) -> Field:
    """Return the offset of the edge of a foam square: eight rounded teeth per tile."""
    return 0.014 * np.clip(2.5 * np.sin(16 * np.pi * along), -1, 1)


def plaster() -> FloatArray:
    """Return white plaster with the marks of a trowel."""
    return plain((238, 235, 226), 0.07 * noise(101, 24, 9) + 0.02 * noise(102, 2, 2))


def boards() -> FloatArray:
    """Return boards painted white, with a shadow in each groove."""
    right, _ = grid()
    _, x = cells(right, 6)
    image = plain((236, 232, 220), 0.035 * noise(111, 1, 26))
    image = paint(image, (214, 208, 194), 0.40 - x, 0.06)
    return paint(image, (160, 152, 138), 0.455 - np.abs(x), 0.05)


def panels() -> FloatArray:
    """Return square coffers, lit from one side."""
    right, down = grid()
    _, x = cells(right, 2)
    _, y = cells(down, 2)
    square = np.maximum(np.abs(x), np.abs(y))
    bevel = (square > 0.32) & (square < 0.38)
    light = np.where(np.abs(x) > np.abs(y), np.sign(x), np.sign(y))
    image = plain((240, 236, 226), 0.02 * noise(121, 8, 8))
    image = paint(image, (226, 218, 200), square - 0.32, 0.015)
    image = lit(image, 1 - bevel * (0.10 + 0.09 * light))
    return paint(image, (178, 168, 150), 0.488 - square, 0.015)


def clouds() -> FloatArray:
    """Return a pale sky."""
    thick = 0.8 * noise(131, 44, 26) + 0.2 * noise(132, 12, 7)
    image = plain((150, 196, 228))
    return paint(image, (246, 247, 244), 0.08 - thick, 0.5)


def golden_stars() -> FloatArray:
    """Return stars on a blue sky."""
    x, y = half_drop(2)
    image = plain((126, 148, 190), 0.05 * noise(141, 18, 18))
    image = paint(image, (250, 226, 150), star(x, y, 0.2), 0.02)
    return paint(image, (236, 238, 240), star(x, (y + 1) % 1 - 0.5, 0.1), 0.02)


def star(x: FloatArray, y: FloatArray, radius: float) -> FloatArray:
    """Return the distance of each texel to a five-pointed star that stands on two points; negative inside."""
    angle = np.arctan2(x, -y)
    sector = np.pi / 5
    folded = np.abs((angle + sector) % (2 * sector) - sector)
    distance = np.hypot(x, y)
    # The edge runs straight from a point at `radius` to an inner corner at 0.42 of it, in the folded sector.
    along, aside = distance * np.cos(folded), distance * np.sin(folded)
    inner_along, inner_aside = 0.42 * radius * np.cos(sector), 0.42 * radius * np.sin(sector)
    edge = np.hypot(radius - inner_along, inner_aside)
    return ((along - radius) * inner_aside + aside * (radius - inner_along)) / edge
