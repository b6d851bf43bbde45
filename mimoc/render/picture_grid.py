"""Several pictures in one, in rows and columns with captions."""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

Picture = npt.NDArray[np.uint8]
"""Shape (height, width, 3)."""

BACKGROUND, TEXT = (255, 255, 255), (40, 40, 40)
GAP_PX = 6
FONT_HEIGHT = 0.07
"""Height of the letters, as a share of a picture's."""
FONT_PX = 11, 24
"""The least that can be read, and the most that is ever needed."""


def tile_pictures(
    pictures: Sequence[Sequence[Picture]], columns: Sequence[str] = (), rows: Sequence[str] = ()
) -> Picture:
    """Return pictures in rows and columns as one picture, shape (height, width, 3).

    Args:
        pictures: In rows, all of one size; a row may be shorter than others.
        columns: Caption above each column.
        rows: Caption to the left of each row, running upwards.
    """
    height, width, _ = pictures[0][0].shape
    font_px = int(np.clip(FONT_HEIGHT * height, *FONT_PX))
    left, top = (GAP_PX + bool(labels) * 2 * font_px for labels in (rows, columns))
    down, across = height + GAP_PX, width + GAP_PX
    size = left + across * max(map(len, pictures)), top + down * len(pictures)
    canvas = Image.new("RGB", size, BACKGROUND)
    for row, line in enumerate(pictures):
        for column, picture in enumerate(line):
            canvas.paste(Image.fromarray(picture), (left + column * across, top + row * down))
    for column, text in enumerate(columns):
        canvas.paste(_label(text, width, top, font_px), (left + column * across, 0))
    for row, text in enumerate(rows):
        canvas.paste(_label(text, height, left, font_px).rotate(90, expand=True), (0, top + row * down))
    return np.asarray(canvas)


def captioned_grid(pictures: Sequence[Picture], captions: Sequence[str]) -> Picture:
    """Return pictures in rows as one picture, wider than high, each below its caption.

    Args:
        pictures: All of one size.
        captions: One for each.
    """
    captioned = [
        tile_pictures([[picture]], columns=[caption]) for picture, caption in zip(pictures, captions, strict=True)
    ]
    return in_rows(captioned)


def in_rows(pictures: Sequence[Picture]) -> Picture:
    """Return pictures of one size in rows as one picture, wider than high."""
    across = math.ceil(math.sqrt(len(pictures) * 4 / 3))
    return tile_pictures([pictures[start : start + across] for start in range(0, len(pictures), across)])


def _label(text: str, width: int, height: int, font_px: int) -> Image.Image:
    """Return a caption in the middle of a box, in letters small enough to fit into its width."""
    label = Image.new("RGB", (width, height), BACKGROUND)
    pen = ImageDraw.Draw(label)
    font = ImageFont.load_default(font_px)
    shrunk = font_px * min(1.0, width / max(pen.textlength(text, font), 1.0))
    pen.text((width / 2, height / 2), text, TEXT, ImageFont.load_default(shrunk), anchor="mm")
    return label
