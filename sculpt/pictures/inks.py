"""Pictures that are painted with named inks, so that a spec can choose their colours.

The colour of a texel is not red, green and blue but a mixture: how much of each ink of `looks.pictures` is in it.
`ink("hair")` and `mixed(skin=0.4, shade=0.6)` are used as colours elsewhere are: `plain(shape, SKIN)` is a canvas of
bare skin, and `over(canvas, HAIR, coverage)` of `pictures.cubes` paints on it. In the end, `with_palette(canvas, 128)`
makes a PNG with a palette of 128 mixtures, which `make_pictures.py` stores; `coloured(canvas)` shows its colours.

    canvas = plain((64, 64), ink("skin"))
    canvas = over(canvas, mixed(blush=0.8, skin=0.2), coverage)
    yield "skin_knee", with_palette(canvas, 64)
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.base.geometry.rotations import FloatArray
from mimoc.compiler.looks.pictures import CLOTHES, EYES, HAIR, INKS, SKINS, inks_of, mixed as mixed_inks, png_of
from mimoc.schema.body import LooksSpec

WHOLE = 255  # Amount of an ink in a mixture of nothing else.
SHOWN = [
    inks_of(LooksSpec.model_validate({"skin": skin, "hair": hair, "eyes": eyes}), clothes)
    for skin, hair, eyes, clothes in zip(SKINS, HAIR, EYES, [*CLOTHES, *CLOTHES], strict=False)
]
"""The colours in which mixtures have to differ, to be different colours of a palette."""
DEFAULT = inks_of(LooksSpec(), "shirt_and_trousers")


@dataclass(frozen=True, slots=True)
class Painted:
    """A picture with a palette of mixtures."""

    png: bytes  # In the default colours.
    mixtures: npt.NDArray[np.uint8]  # Amounts of inks in each colour of the palette, shape (colours, inks).


def ink(name: str) -> FloatArray:
    """Return the mixture that is one ink, shape (inks,)."""
    return mixed(**{name: 1.0})


def mixed(**shares: float) -> FloatArray:
    """Return the mixture of some inks by their shares, which sum to 1, shape (inks,)."""
    mixture = np.zeros(len(INKS))
    for name, share in shares.items():
        mixture[INKS.index(name)] = share
    return mixture


def plain(shape: Sequence[int], mixture: FloatArray) -> FloatArray:
    """Return a canvas of one colour, shape (rows, columns, inks)."""
    return np.full((*shape[:2], len(INKS)), mixture, np.float64)


def coloured(canvas: FloatArray, inks: dict[str, tuple[float, float, float]] = DEFAULT) -> FloatArray:
    """Return the red, green and blue of a canvas, 0 to 255, shape (rows, columns, 3)."""
    colours = mixed_inks(_amounts(canvas).reshape(-1, len(INKS)), inks)
    return colours.reshape(*canvas.shape[:2], 3).astype(np.float64)


def with_palette(canvas: FloatArray, colours: int) -> Painted:
    """Return the picture of a canvas, shape (rows, columns, inks), with at most that many colours, up to 256.

    Mixtures are alike that look alike on infants of all looks. Median cut, where what varies most is cut at its mean:
    of a group of n texels, variance counts by the square root of n, lest small things lose their colours.
    """
    rows, which, count = np.unique(
        _amounts(canvas).reshape(-1, len(INKS)), axis=0, return_inverse=True, return_counts=True
    )
    seen = np.hstack([mixed_inks(rows, inks) for inks in SHOWN]).astype(np.float64)
    group = _groups(seen, count.astype(np.float64), colours)
    mixtures = np.zeros((group.max() + 1, len(INKS)))
    np.add.at(mixtures, group, rows * count[:, None])
    mixtures = mixtures / np.bincount(group, count)[:, None]
    mixtures = np.rint(mixtures).astype(np.uint8)
    picture = Image.fromarray(group[which.reshape(canvas.shape[:2])].astype(np.uint8), "P")
    picture.putpalette(mixed_inks(mixtures, DEFAULT).tobytes())
    return Painted(png_of(picture, compress_level=9), mixtures)


def _amounts(canvas: FloatArray) -> npt.NDArray[np.uint8]:
    return np.rint(WHOLE * np.clip(canvas, 0, 1)).astype(np.uint8)


def _groups(seen: FloatArray, count: FloatArray, most: int) -> npt.NDArray[np.intp]:
    """Return the group of each of n colours, shape (n,), of at most some groups of similar ones.

    Args:
        seen: Each colour as it looks on some infants, shape (n, 3 * infants).
        count: Its texels, shape (n,).
        most: Number of groups.
    """
    groups = [np.arange(len(seen))]
    spreads = [_spread(seen, count)]
    while len(groups) < most and max(spread.max() for spread in spreads) > 0:
        widest = int(np.argmax([spread.max() for spread in spreads]))
        members, along = groups.pop(widest), int(spreads.pop(widest).argmax())
        values = seen[members, along]
        is_low = values <= (values * count[members]).sum() / count[members].sum()
        for part in (members[is_low], members[~is_low]):
            groups.append(part)
            spreads.append(_spread(seen[part], count[part]))
    order = np.zeros(len(seen), np.intp)
    for index, members in enumerate(groups):
        order[members] = index
    return order


def _spread(seen: FloatArray, count: FloatArray) -> FloatArray:
    """Return the variance of some colours along each axis, times the square root of the number of texels."""
    total = count.sum()
    mean = (seen * count[:, None]).sum(axis=0) / total
    spread = ((seen - mean) ** 2 * count[:, None]).sum(axis=0) / total
    return np.where(np.ptp(seen, axis=0) > 0, spread * np.sqrt(total), 0.0)
