"""A user's own images as wallpapers."""

import os
import re
import stat
import warnings
from pathlib import Path

import numpy as np
from PIL import Image

from mimoc.base.errors import TextureError
from mimoc.base.geometry.rotations import FloatArray
from mimoc.compiler.looks.pictures import encode_png
from mimoc.compiler.looks.wallpaper import Wallpaper

TILE_PX = 256
"""Maximum number of texels per side: that of images of a bundle."""
MOST_PX = 20_000_000
LONGER_SIDE_M = 1.0
"""Width and height of one repeat."""


def read_textures(path: str | Path) -> tuple[Wallpaper, ...]:
    """Return the textures in one PNG, or in every `*.png` of a folder, by name.

    They are scaled down to a bundle's resolution, and metadata is dropped.

    Raises:
        TextureError: If there is no image, or if some cannot be read; the message has a line for each of them.
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
    """Return the PNG of one picture, scaled down as textures are.

    Raises:
        TextureError: If it is no picture, or cannot be read.
    """
    return _texture(path, set()).png


def _files(path: Path) -> list[Path]:
    """Return the file itself, or the PNGs of a folder, sorted by name."""
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
    image = _small(_decode(file))
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
    """Return an image as RGB, with transparent areas in white."""
    try:
        if not stat.S_ISREG(os.stat(file).st_mode):
            raise TextureError(f"{file}: is not a file; replace it with a PNG file, or remove it")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow warns of sizes that are rejected here anyway.
            with Image.open(file, formats=["PNG"]) as image:
                if image.width * image.height > MOST_PX:
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
_TOO_LARGE = f"has more than {MOST_PX // 1_000_000} megapixels; reduce it: {TILE_PX} px per side are enough"


def _small(image: Image.Image) -> FloatArray:
    """Return an image of at most `TILE_PX` per side.

    Each texel is the mean of what it covers and of nothing beyond, so that what was seamless stays so.
    """
    longer = max(image.size)
    if longer > TILE_PX:
        width, height = (max(1, round(side * TILE_PX / longer)) for side in image.size)
        image = image.resize((width, height), Image.Resampling.BOX)
    return np.asarray(image, np.float64)
