"""Pictures as files, in the format that the name says; several in one, with captions; a bar of a round length."""

import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from mimoc.base.errors import OutputError
from mimoc.bundle.files import write_file
from mimoc.render.renderer import Picture

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
OPAQUE = {".jpg", ".jpeg", ".bmp"}  # Formats that have no transparent background.


def check_picture_name(path: str | Path, *, transparent: bool = False) -> None:
    """Pass the name of a file that a picture can be written to, transparent or not, or raise an OutputError."""
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


BACKGROUND, TEXT = (255, 255, 255), (40, 40, 40)
GAP_PX = 6
FONT_HEIGHT = 0.07  # Height of the letters, as a share of a picture's.
FONT_PX = 11, 24  # The least that can be read, and the most that is ever needed.


def tile_pictures(
    pictures: Sequence[Sequence[Picture]], columns: Sequence[str] = (), rows: Sequence[str] = ()
) -> Picture:
    """Return pictures of one size in rows with captions as one picture, shape (height, width, 3)."""
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
    """Return pictures of one size in rows as one picture, wider than high, each below its caption."""
    pairs = zip(pictures, captions, strict=True)
    return in_rows([tile_pictures([[picture]], columns=[caption]) for picture, caption in pairs])


def in_rows(pictures: Sequence[Picture]) -> Picture:
    """Return pictures of one size in rows as one picture, wider than high."""
    return tile_pictures(rows_of(pictures))


def rows_of(items: Sequence[Any]) -> list[Sequence[Any]]:
    """Return items in rows, more of them across than down."""
    across = math.ceil(math.sqrt(len(items) * 4 / 3))
    return [items[start : start + across] for start in range(0, len(items), across)]


def _label(text: str, width: int, height: int, font_px: int) -> Image.Image:
    """Return a caption in the middle of a box, in letters small enough to fit into its width."""
    label = Image.new("RGB", (width, height), BACKGROUND)
    pen = ImageDraw.Draw(label)
    font = ImageFont.load_default(font_px)
    shrunk = font_px * min(1.0, width / max(pen.textlength(text, font), 1.0))
    pen.text((width / 2, height / 2), text, TEXT, ImageFont.load_default(shrunk), anchor="mm")
    return label


LENGTHS_CM = (1, 2, 5, 10, 20, 50, 100, 200, 500)  # Lengths of bars: the longest that fits, or the shortest.
SHARE = 0.3  # Largest share of the width of a picture that a bar takes.
COLOUR, RIM = (20, 20, 20, 255), (255, 255, 255, 255)  # Dark with a light rim, which shows on any background.
LETTERS = 0.04  # Height of the letters, as a share of the picture's.
LETTERS_PX = 9, 60


def bar_length_cm(width_px: int, px_per_m: float) -> int:
    """Return how long the bar of a picture is."""
    return max((cm for cm in LENGTHS_CM if cm / 100 * px_per_m <= SHARE * width_px), default=LENGTHS_CM[0])


def with_scale_bar(picture: Picture, px_per_m: float) -> Picture:
    """Return a picture, maybe with opacity, with a bar and its length in its lower left corner.

    At the distance of what it shows, a metre takes *px_per_m* pixels.
    """
    height, width, _ = picture.shape
    length_cm = bar_length_cm(width, px_per_m)
    letters_px = int(np.clip(LETTERS * height, *LETTERS_PX))
    thick_px, rim_px = max(letters_px // 4, 2), max(letters_px // 12, 1)
    image = Image.fromarray(picture)
    pen = ImageDraw.Draw(image)
    left, bottom = letters_px, height - letters_px
    right = left + max(round(length_cm / 100 * px_per_m), 1) - 1  # Pillow draws both ends.
    top = bottom - thick_px + 1
    pen.rectangle((left - rim_px, top - rim_px, right + rim_px, bottom + rim_px), RIM)
    pen.rectangle((left, top, right, bottom), COLOUR)
    where = (left + right) / 2, top - rim_px - letters_px // 4
    text = f"{length_cm} cm"
    pen.text(where, text, COLOUR, ImageFont.load_default(letters_px), "mb", stroke_width=rim_px, stroke_fill=RIM)
    return np.asarray(image)
