"""Textures of walls, whose top is the top of the image, and framed pictures to hang there."""

import numpy as np
from pictures.floors import cells, grid, half_drop, lit, noise, paint, plain, star, tones
from PIL import Image, ImageDraw

from mimoc.base.geometry.rotations import FloatArray
from mimoc.compiler.looks.pictures import Colour


def plaster() -> FloatArray:
    """Return sponged plaster in a warm yellow."""
    image = plain((232, 196, 132), 0.04 * noise(201, 3, 3))
    return paint(image, (250, 234, 198), 0.05 - noise(202, 14, 14), 0.6)


def stripes() -> FloatArray:
    """Return broad and narrow stripes from top to bottom."""
    right, _ = grid()
    _, x = cells(right, 4)
    image = plain((246, 240, 226))
    image = paint(image, (132, 172, 184), np.abs(x) - 0.2, 0.03)
    return paint(image, (222, 158, 122), np.abs(np.abs(x) - 0.35) - 0.025, 0.03)


def dots() -> FloatArray:
    """Return dots of two colours."""
    x, y = half_drop(4)
    image = paint(plain((248, 238, 222)), (224, 108, 96), np.hypot(x, y) - 0.22, 0.03)
    return paint(image, (92, 148, 160), np.hypot(x, (y + 1) % 1 - 0.5) - 0.11, 0.03)


def stars() -> FloatArray:
    """Return dark stars on a light wall."""
    x, y = half_drop(4)
    return paint(plain((226, 230, 238)), (66, 84, 128), star(x, y, 0.3), 0.03)


def triangles() -> FloatArray:
    """Return triangles in three colours."""
    right, down = grid()
    row, y = cells(down, 4)
    column, x = cells((right + (row % 2) / 12) % 1, 6)
    height, half_width = y + 0.28, np.abs(x)
    outside = np.maximum(half_width - 0.55 * height, y - 0.3)
    colours = np.array([(232, 134, 92), (106, 158, 138), (238, 188, 86)], np.float64)
    motif = colours[((column + row) % 3).astype(np.intp)]
    cover = np.clip(0.5 - outside / 0.03, 0, 1)[..., None]
    return plain((246, 242, 232)) * (1 - cover) + motif * cover


def flowers() -> FloatArray:
    """Return pink flowers with two leaves each."""
    x, y = half_drop(4)
    image = plain((238, 240, 222))
    image = paint(image, (112, 154, 104), _leaf(x - 0.2, y - 0.27, 0.8), 0.03)
    image = paint(image, (112, 154, 104), _leaf(x + 0.2, y - 0.27, -0.8), 0.03)
    petals = np.hypot(x, y + 0.06) - 0.2 * (0.8 + 0.25 * np.cos(5 * np.arctan2(x, -(y + 0.06))))
    image = paint(image, (220, 112, 134), petals, 0.03)
    return paint(image, (250, 214, 110), np.hypot(x, y + 0.06) - 0.075, 0.03)


def leaves() -> FloatArray:
    """Return twigs of green leaves that climb the wall."""
    right, down = grid()
    column, x = cells(right, 4)
    shifted = (down + (column % 2) / 8) % 1
    _, y = cells(shifted, 4)
    sway = 0.08 * np.sin(2 * np.pi * 2 * shifted)
    stem, side = x - sway, np.abs(x - sway)
    image = plain((244, 240, 224))
    image = paint(image, (120, 138, 96), side - 0.022, 0.03)
    image = paint(image, (88, 136, 98), _leaf(side - 0.2, y + 0.1, -0.75), 0.04)
    return paint(image, (150, 182, 116), _leaf(stem - 0.17, y - 0.33, 0.75), 0.04)


def bricks() -> FloatArray:
    """Return bricks in half bond."""
    right, down = grid()
    row, y = cells(down, 8)
    column, x = cells((right + (row % 2) / 8) % 1, 4)
    tone = 0.14 * tones(261, row, column) + 0.08 * noise(262, 2.5, 2)
    image = plain((178, 92, 70), tone)
    joint = np.minimum(0.5 - np.abs(y), 2.2 * (0.5 - np.abs(x)))
    image = lit(image, 1 - 0.18 * ((joint < 0.17) & (y > 0)))
    return paint(image, (214, 200, 182), joint - 0.075, 0.05)


def wainscot() -> FloatArray:
    """Return panels up to a third of the wall's height, a ledge, and plain green above; a tile is as high as a wall."""
    right, down = grid()
    _, x = cells(right, 2)
    image = plain((164, 190, 160), 0.03 * noise(271, 6, 6))
    panelled = down > 0.64
    image = np.where(panelled[..., None], plain((240, 234, 220)), image)
    frame = np.maximum(np.abs(x) / 0.36, np.abs(down - 0.805) / 0.105)
    groove = panelled & (np.abs(frame - 1) < 0.055)
    image = lit(image, np.where(groove, np.where(down < 0.8, 0.7, 0.84), 1.0))
    image = paint(image, (252, 248, 238), np.abs(down - 0.645) - 0.014)
    image = paint(image, (150, 136, 116), np.abs(down - 0.664) - 0.004)
    image = paint(image, (206, 194, 172), 0.945 - down)
    return paint(image, (150, 136, 116), np.abs(down - 0.945) - 0.003)


def gingham() -> FloatArray:
    """Return woven squares, darkest where two stripes cross."""
    right, down = grid()
    _, x = cells(right, 8)
    _, y = cells(down, 8)
    across, along = (np.clip(0.5 - (np.abs(each) - 0.25) / 0.05, 0, 1) for each in (x, y))
    image = plain((250, 246, 238))
    return image + 0.5 * (across + along)[..., None] * (np.array((120.0, 146, 196)) - image)


def _leaf(x: FloatArray, y: FloatArray, turn: float) -> FloatArray:
    """Return the distance of each texel to a pointed leaf, which is upright at a rotation of 0 rad; negative inside."""
    along = -np.sin(turn) * x + np.cos(turn) * y
    aside = np.cos(turn) * x + np.sin(turn) * y
    return np.abs(aside) - 0.4 * (0.18 - np.minimum(along**2 / 0.18, 1))


WIDTH_PX, HEIGHT_PX = 256, 192
FRAME_PX, MOUNT_PX = 12, 10
SCALE = 2  # Factor of supersampling, in each direction.
WOOD: Colour = (122, 82, 52)
EDGE: Colour = (164, 118, 78)
MOUNT: Colour = (246, 242, 232)
SKY: Colour = (172, 212, 234)
SUN: Colour = (250, 206, 92)

Point = tuple[float, float]


class Canvas:
    """A framed picture; coordinates are in hundredths of its width, from the top left corner."""

    def __init__(self, ground: Colour):
        self._image = Image.new("RGB", (SCALE * WIDTH_PX, SCALE * HEIGHT_PX), _ints(ground))
        self._draw = ImageDraw.Draw(self._image)

    def polygon(self, colour: Colour, *points: Point) -> None:
        """Fill a polygon."""
        self._draw.polygon([_texel(point) for point in points], _ints(colour))

    def ellipse(self, colour: Colour, middle: Point, half_width: float, half_height: float) -> None:
        """Fill an ellipse."""
        x, y = middle
        corners = (x - half_width, y - half_height), (x + half_width, y + half_height)
        self._draw.ellipse([_texel(corner) for corner in corners], _ints(colour))

    def framed(self) -> FloatArray:
        """Return the picture, shape `(HEIGHT_PX, WIDTH_PX, 3)`."""
        for colour, edge in (WOOD, 0), (EDGE, 3), (WOOD, 8), (MOUNT, FRAME_PX):
            self._border(colour, edge)
        return np.asarray(self._image.reduce(SCALE), np.float64)

    def _border(self, colour: Colour, edge_px: int) -> None:
        width = SCALE * (FRAME_PX + MOUNT_PX - edge_px)
        box = [SCALE * edge_px, SCALE * edge_px, SCALE * (WIDTH_PX - edge_px) - 1, SCALE * (HEIGHT_PX - edge_px) - 1]
        self._draw.rectangle(box, outline=_ints(colour), width=width)


def mountains() -> FloatArray:
    """Return snowy mountains behind a lake."""
    canvas = Canvas(SKY)
    canvas.polygon((116, 132, 158), (0, 50), (22, 20), (42, 48), (60, 26), (100, 56), (100, 75), (0, 75))
    canvas.polygon((248, 248, 246), (16, 28.5), (22, 20), (28, 28), (25, 31), (22, 28), (19, 32))
    canvas.polygon((248, 248, 246), (54, 32), (60, 26), (68, 32), (64, 35), (60, 32), (57, 35))
    canvas.polygon((96, 146, 96), (0, 48), (30, 44), (60, 50), (100, 44), (100, 60), (0, 60))
    canvas.polygon((92, 152, 190), (0, 56), (100, 54), (100, 75), (0, 75))
    for x in (14, 80, 88):
        canvas.polygon((48, 92, 66), (x - 5, 56), (x, 38), (x + 5, 56))
    return canvas.framed()


def house() -> FloatArray:
    """Return a house with a red roof and a tree."""
    canvas = Canvas(SKY)
    canvas.polygon((132, 180, 104), (0, 56), (100, 53), (100, 75), (0, 75))
    canvas.polygon((246, 228, 188), (24, 36), (60, 36), (60, 60), (24, 60))
    canvas.polygon((196, 82, 68), (19, 38), (42, 17), (65, 38))
    canvas.polygon((122, 82, 52), (38, 46), (47, 46), (47, 60), (38, 60))
    for x in (28, 50):
        canvas.polygon((96, 140, 176), (x, 42), (x + 7, 42), (x + 7, 49), (x, 49))
    canvas.polygon((112, 76, 50), (77, 40), (81, 40), (82, 61), (76, 61))
    canvas.ellipse((82, 138, 82), (79, 34), 11, 13)
    canvas.ellipse(SUN, (84, 16), 5.5, 5.5)
    return canvas.framed()


def boat() -> FloatArray:
    """Return a sailing boat at sea."""
    canvas = Canvas((196, 224, 236))
    canvas.ellipse(SUN, (22, 22), 7, 7)
    canvas.polygon((62, 122, 164), (0, 52), (100, 52), (100, 75), (0, 75))
    canvas.polygon((110, 78, 54), (53, 15), (54.5, 15), (54.5, 54), (53, 54))
    canvas.polygon((248, 244, 232), (52, 17), (52, 47), (32, 47))
    canvas.polygon((222, 96, 80), (56, 20), (56, 47), (74, 47))
    canvas.polygon((154, 70, 54), (30, 50), (78, 50), (70, 60), (38, 60))
    for x in range(10, 100, 16):
        canvas.ellipse((142, 186, 208), (x, 63), 5, 1)
    return canvas.framed()


def sunny_hills() -> FloatArray:
    """Return the sun over green hills."""
    canvas = Canvas((252, 226, 176))
    canvas.ellipse((246, 158, 74), (64, 38), 15, 15)
    canvas.ellipse(SUN, (64, 38), 12, 12)
    canvas.ellipse((126, 168, 122), (20, 82), 52, 40)
    canvas.ellipse((86, 138, 98), (88, 88), 48, 38)
    canvas.ellipse((168, 196, 116), (40, 96), 60, 36)
    return canvas.framed()


def duck() -> FloatArray:
    """Return a yellow duck on a pond."""
    canvas = Canvas((206, 228, 214))
    canvas.polygon((98, 158, 186), (0, 52), (100, 52), (100, 75), (0, 75))
    canvas.ellipse((248, 200, 72), (46, 50), 22, 12)
    canvas.polygon((248, 200, 72), (22, 34), (38, 46), (30, 56))
    canvas.ellipse((248, 200, 72), (64, 32), 11, 11)
    canvas.polygon((236, 120, 56), (73, 29), (85, 34), (73, 37))
    canvas.ellipse((40, 34, 34), (67, 29), 1.8, 1.8)
    canvas.ellipse((226, 168, 50), (44, 49), 11, 6)
    for x, y in ((20, 64), (52, 66), (80, 62)):
        canvas.ellipse((168, 206, 220), (x, y), 7, 0.9)
    return canvas.framed()


def cat() -> FloatArray:
    """Return the face of a cat."""
    canvas = Canvas((184, 206, 176))
    for side in (-1, 1):
        canvas.polygon((92, 84, 88), (50 + 20 * side, 38), (50 + 19 * side, 13), (50 + 4 * side, 24))
        canvas.polygon((222, 160, 156), (50 + 17 * side, 28), (50 + 16.5 * side, 19), (50 + 9 * side, 24))
    canvas.ellipse((92, 84, 88), (50, 42), 22, 20)
    canvas.ellipse((236, 230, 222), (50, 51), 11, 8)
    for side in (-1, 1):
        canvas.ellipse((240, 220, 120), (50 + 9 * side, 38), 4.6, 5)
        canvas.ellipse((30, 28, 28), (50 + 9 * side, 38), 1.6, 4.2)
    canvas.polygon((206, 112, 112), (47.5, 45.5), (52.5, 45.5), (50, 48.5))
    canvas.polygon((70, 60, 62), (49.6, 48), (50.4, 48), (50.4, 53), (49.6, 53))
    return canvas.framed()


def _texel(point: Point) -> tuple[float, float]:
    x, y = point
    return x / 100 * WIDTH_PX * SCALE, y / 100 * WIDTH_PX * SCALE


def _ints(colour: Colour) -> tuple[int, int, int]:
    red, green, blue = colour
    return round(red), round(green), round(blue)
