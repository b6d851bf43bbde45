"""Pictures for floors and walls that are changed by chance: PNGs and others by that name."""

import io
from pathlib import Path
from zlib import crc32

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import changed_bytes, pick
from PIL import Image

from mimoc.compiler.looks.wallpaper import read_textures

FORMATS = ("PNG",) * 8 + ("JPEG", "BMP", "GIF", "TIFF")
MODES = ("RGB", "RGBA", "L", "P", "1", "I;16")  # Of PNGs.


def prepare(folder: Path | None) -> list[bytes]:
    colours = np.arange(24 * 16 * 3, dtype=np.uint8).reshape(24, 16, 3)
    image = Image.fromarray(colours)
    deep = Image.fromarray(colours[..., 0].astype(np.uint16) * 200)
    modes = [deep if mode == "I;16" else image.convert(mode) for mode in MODES]
    return [_encoded(each, "PNG") for each in modes] + [_encoded(image, kind) for kind in FORMATS]


def _encoded(image: Image.Image, kind: str) -> bytes:
    content = io.BytesIO()
    image.save(content, kind)
    return content.getvalue()


def attempt(prepared: list[bytes], generator: np.random.Generator, folder: Path) -> None:
    content = pick(generator, prepared)
    kind = generator.random()
    if kind < 0.2:
        content = resized(content, *(int(2 ** generator.uniform(0, 32)) for _ in range(2)))
    elif kind < 0.3:
        content = content[: int(generator.integers(len(content)))]
    elif kind < 0.9:
        content = changed_bytes(generator, content)
    (folder / "picture.png").write_bytes(content)
    for texture in read_textures(folder / "picture.png"):
        assert texture.png


def resized(content: bytes, width_px: int, height_px: int) -> bytes:
    header = b"IHDR" + width_px.to_bytes(4, "big") + height_px.to_bytes(4, "big") + content[24:29]
    return content[:12] + header + crc32(header).to_bytes(4, "big") + content[33:]


FUZZER = Fuzzer(prepare, attempt, short=60)
