"""PNG pictures that ship with mimoc (`.ci/task pictures` paints them, see `sculpt/`), in an infant's colours.

The colours of a picture's palette are mixtures of inks, which are mixed anew for each infant. All
colours are chosen by eye on rendered pictures (D), in sRGB, 0 to 255.
"""

import io
import zlib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.base.arrays import read_arrays
from mimoc.schema.body import Clothes, LooksSpec

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


Colour = tuple[float, float, float]  # Red, green and blue, 0 to 255.


class SkinColours(NamedTuple):
    """The colours of skin of one tone."""

    skin: Colour
    blush: Colour  # Cheeks, knees, fingertips and the rims of ears, at their reddest.
    lip: Colour
    shade: Colour  # Creases, into which little light falls.
    white: Colour  # White of the eyes.
    inside: Colour  # The open mouth.


class ClothColours(NamedTuple):
    """The colours of one set of clothes."""

    shirt: Colour
    stripe: Colour  # Stripes of the shirt.
    band: Colour  # Knitted bands along the hems of the shirt.
    trousers: Colour
    trousers_band: Colour


SKINS: Mapping[str, SkinColours] = {
    tone: SkinColours(*colours)
    for tone, colours in {
        "light": ((250, 218, 198), (243, 166, 152), (228, 142, 138), (208, 144, 126), (250, 249, 247), (140, 57, 60)),
        "fair": ((244, 205, 178), (240, 150, 130), (224, 130, 120), (196, 122, 100), (250, 248, 244), (138, 56, 58)),
        "medium": ((229, 182, 147), (216, 130, 106), (198, 106, 96), (170, 106, 78), (248, 245, 240), (126, 48, 52)),
        "tan": ((202, 149, 112), (188, 104, 82), (186, 92, 86), (140, 86, 60), (246, 243, 237), (110, 40, 44)),
        "brown": ((154, 107, 79), (152, 82, 66), (168, 86, 82), (100, 62, 44), (244, 240, 233), (86, 28, 34)),
        "dark": ((114, 79, 62), (126, 67, 56), (148, 80, 78), (68, 43, 33), (242, 238, 230), (70, 21, 28)),
    }.items()
}
HAIR: Mapping[str, Colour] = {
    "black": (33, 28, 28),
    "dark": (64, 45, 36),
    "brown": (112, 77, 54),
    "light_brown": (152, 112, 76),
    "blond": (204, 165, 108),
    "red": (146, 82, 50),
}
EYES: Mapping[str, Colour] = {
    "dark": (54, 36, 28),
    "brown": (98, 63, 39),
    "hazel": (130, 100, 58),
    "green": (106, 126, 84),
    "blue": (94, 122, 152),
    "grey": (122, 130, 138),
}
MINT: Colour = (206, 227, 217)
YELLOW: Colour = (247, 204, 112)
ORANGE: Colour = (232, 142, 92)
TEAL: Colour = (112, 160, 172)
WHITE: Colour = (246, 244, 239)
CLOTHES: Mapping[Clothes, ClothColours] = {
    "bodysuit": ClothColours(MINT, (150, 196, 190), (104, 164, 152), MINT, (104, 164, 152)),
    "shirt_and_trousers": ClothColours(YELLOW, (252, 236, 196), ORANGE, TEAL, (84, 128, 142)),
    "trousers": ClothColours(YELLOW, (252, 236, 196), ORANGE, TEAL, (84, 128, 142)),
    "nappy": ClothColours(WHITE, WHITE, WHITE, WHITE, (196, 218, 226)),
}
FOLDED = "_fold"  # How the name of the ink of a cloth's folds ends.
FOLD = (0.20, 0.26, 0.30)  # How much darker cloth is in a fold: a little redder, too.
DARKEST: Colour = (46, 30, 27)  # What lashes and the edges of irises are darkened with.


def inks_of(looks: LooksSpec, clothes: Clothes) -> dict[str, Colour]:
    """Return the colours that the pictures of an infant are mixed of, by name, in whole numbers.

    Example:
        >>> from mimoc.compiler.looks.pictures import inks_of
        >>> from mimoc.schema.body import LooksSpec
        >>> inks_of(LooksSpec(hair="black"), "nappy")["hair"]
        (33, 28, 28)

    """
    hair = HAIR[looks.hair]
    iris = EYES[looks.eyes]
    cloth = CLOTHES[clothes]
    return {
        **SKINS[looks.skin]._asdict(),
        "hair": hair,
        "hair_light": blended(hair, (255, 232, 196), 0.16),
        "hair_dark": blended(hair, DARKEST, 0.4),
        "lash": blended(hair, DARKEST, 0.65),
        "iris": iris,
        "iris_light": blended(iris, (255, 244, 220), 0.22),
        "iris_rim": blended(iris, (20, 20, 24), 0.62),
        "pupil": (22, 18, 20),
        "glint": (255, 255, 255),
        "tongue": (214, 122, 118),
        **cloth._asdict(),
        **{f"{name}{FOLDED}": folded(colour) for name, colour in cloth._asdict().items()},
    }


def blended(colour: Colour, other: Colour, share: float) -> Colour:
    """Return a colour with a share of another in it, in whole numbers."""
    red, green, blue = (round(a + share * (b - a)) for a, b in zip(colour, other, strict=True))
    return red, green, blue


def folded(colour: Colour) -> Colour:
    """Return the colour of cloth in a fold."""
    red, green, blue = (round(value * (1 - depth)) for value, depth in zip(colour, FOLD, strict=True))
    return red, green, blue


INKS = tuple(inks_of(LooksSpec(), "shirt_and_trousers"))  # The names of the colours, in the order of mixtures.


SIGNATURE_BYTES = 8  # What a PNG begins with.
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
    """Return the colours of some mixtures of inks, red, green and blue, shape (n, 3).

    The colour of a mixture is the mean of its inks, weighted by their amounts m, in the order of `INKS`, shape
    (n, inks): c = sum(m_i c_i) / sum(m_i). It is computed in whole numbers, and rounded half up.

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
    start = SIGNATURE_BYTES
    while start < len(png):
        length = int.from_bytes(png[start : start + 4], "big")
        yield png[start + 4 : start + 8], png[start + 8 : start + 8 + length]
        start += length + 12
