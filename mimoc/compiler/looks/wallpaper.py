"""Wallpapers: textures for floors, ceilings and walls, and pictures that hang on them; mimoc's, and a user's own."""

import math
import os
import re
import stat
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np
from PIL import Image

from mimoc.base.errors import TextureError
from mimoc.compiler.looks.pictures import encode_png, read_picture

WHOLE = math.inf  # Width or height of a tile that spans the whole surface.


@dataclass(frozen=True, slots=True)
class Wallpaper:
    """A texture and its size in the scene."""

    name: str  # Name of the material and of the file: [a-z0-9_]+.
    tile_m: tuple[float, float]  # Width and height of one repeat, or of a picture with its frame.
    content: bytes | None = None  # A user's PNG; None for those that ship with mimoc.

    @property
    def png(self) -> bytes:
        """The PNG, whose top is up on a wall."""
        return read_picture(self.name) if self.content is None else self.content


def _table(kind: str, **tiles_m: tuple[float, float]) -> Mapping[str, Wallpaper]:
    return MappingProxyType({name: Wallpaper(f"{kind}_{name}", tile_m) for name, tile_m in tiles_m.items()})


FLOORS = _table(
    "floor",
    oak_boards=(0.84, 1.4),
    dark_boards=(0.84, 1.4),
    parquet=(1.0, 1.0),
    chequered_tiles=(0.6, 0.6),
    terracotta=(0.9, 0.9),
    carpet=(0.8, 0.8),
    play_mat=(0.7, 0.7),
    cork=(0.5, 0.5),
)
CEILINGS = _table(
    "ceiling",
    plaster=(1.2, 1.2),
    boards=(0.9, 1.2),
    panels=(1.2, 1.2),
    clouds=(2.0, 2.0),
    golden_stars=(1.0, 1.0),
)
WALLS = _table(
    "wall",
    plaster=(1.0, 1.0),
    stripes=(0.6, 0.6),
    dots=(0.6, 0.6),
    stars=(0.7, 0.7),
    triangles=(0.7, 0.6),
    flowers=(0.7, 0.7),
    leaves=(0.7, 0.7),
    bricks=(0.96, 0.6),
    wainscot=(0.9, WHOLE),
    gingham=(0.6, 0.6),
)
PICTURES = _table(
    "picture",
    mountains=(0.60, 0.45),
    house=(0.60, 0.45),
    boat=(0.48, 0.36),
    sunny_hills=(0.64, 0.48),
    duck=(0.48, 0.36),
    cat=(0.48, 0.36),
)


@dataclass(frozen=True, slots=True)
class Wallpapers:
    """The wallpapers to choose from for floors, ceilings and walls."""

    floors: Sequence[Wallpaper] = tuple(FLOORS.values())
    ceilings: Sequence[Wallpaper] = tuple(CEILINGS.values())
    walls: Sequence[Wallpaper] = tuple(WALLS.values())
    pictures: Sequence[Wallpaper] = tuple(PICTURES.values())


OWN_WALLPAPERS = Wallpapers()  # The wallpapers that come with mimoc.


TILE_PX = 256  # Maximum number of texels per side: that of images of a bundle.
MAX_PX = 20_000_000
LONGER_SIDE_M = 1.0  # Width and height of one repeat.


def read_textures(path: str | Path) -> tuple[Wallpaper, ...]:
    """Return the textures in one PNG, or in every `*.png` of a folder, by name, in a bundle's resolution.

    A TextureError has a line for each image that cannot be read.

    """
    textures, problems = [], []
    for file in _files(Path(path)):
        try:
            textures.append(_texture(file, taken={texture.name for texture in textures}))
        except TextureError as error:
            problems.append(str(error))
    if problems:
        raise TextureError("\n".join(problems))
    return tuple(textures)


def read_picture_file(path: Path) -> bytes:
    """Return the PNG of one picture, scaled down as textures are; a TextureError says why it cannot be read."""
    return _texture(path, set()).png


def _files(path: Path) -> list[Path]:
    try:
        path = path.expanduser()
        if not stat.S_ISDIR(os.stat(path).st_mode):
            return [path]
        files = [path / name for name in sorted(os.listdir(path)) if name.lower().endswith(".png") and name[0] != "."]
    except OSError as error:
        raise TextureError(f"{path}: cannot be read ({error.strerror}); {_ADVICE}") from None
    except (ValueError, RuntimeError):  # A null character, or the home folder of an unknown user.
        raise TextureError(f"{str(path)!r}: is not a path; {_ADVICE}") from None
    if not files:
        raise TextureError(f"{path}: the folder contains no *.png files; add some, or give another folder")
    return files


def _texture(file: Path, taken: set[str]) -> Wallpaper:
    # Each texel is the mean of what it covers and of nothing beyond, so that what was seamless stays so.
    image = _decode(file)
    longer = max(image.size)
    if longer > TILE_PX:
        width, height = (max(1, round(side * TILE_PX / longer)) for side in image.size)
        image = image.resize((width, height), Image.Resampling.BOX)
    image = np.asarray(image, np.float64)
    rows, columns, _ = image.shape
    tile_m = (LONGER_SIDE_M * columns / max(rows, columns), LONGER_SIDE_M * rows / max(rows, columns))
    # A name that is valid in MJCF and in every file system, and not taken.
    slug = re.sub("[^a-z0-9]+", "_", file.stem.lower()).strip("_")[:40] or "texture"
    name, number = f"own_{slug}", 1
    while name in taken:
        number += 1
        name = f"own_{slug}_{number}"
    return Wallpaper(name, tile_m, encode_png(image))


def _decode(file: Path) -> Image.Image:
    try:
        if not stat.S_ISREG(os.stat(file).st_mode):
            raise TextureError(f"{file}: is not a file; replace it with a PNG file, or remove it")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow warns of sizes that are rejected here anyway.
            with Image.open(file, formats=["PNG"]) as image:
                if image.width * image.height > MAX_PX:
                    raise TextureError(f"{file}: {_TOO_LARGE}")
                if image.mode.startswith("I"):  # 16 bits per channel, which Pillow would clip instead of scaling.
                    return Image.fromarray((np.asarray(image).astype(np.uint32) >> 8).astype(np.uint8)).convert("RGB")
                layer = image.convert("RGBA")
                return Image.alpha_composite(Image.new("RGBA", layer.size, "white"), layer).convert("RGB")
    except TextureError:
        raise
    except Image.DecompressionBombError:
        raise TextureError(f"{file}: {_TOO_LARGE}") from None
    except OSError as error:
        fault = f"cannot be read ({error.strerror})" if error.strerror else "is not a PNG, or is damaged"
        raise TextureError(f"{file}: {fault}; save it as a PNG again, or remove it") from None
    except Exception:  # On a damaged file, Pillow can raise any error.
        raise TextureError(f"{file}: is damaged; save it as a PNG again, or remove it") from None


_ADVICE = "give a PNG file or a folder of PNG files"
_TOO_LARGE = f"has more than {MAX_PX // 1_000_000} megapixels; reduce it: {TILE_PX} px per side are enough"
