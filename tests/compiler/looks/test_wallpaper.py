import io
import math
import os
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, PngImagePlugin

from mimoc.base.errors import MimocError, TextureError
from mimoc.compiler.looks.wallpaper import CEILINGS, FLOORS, PICTURES, WALLS, Wallpaper, read_textures

TILES = [*FLOORS.values(), *CEILINGS.values(), *WALLS.values()]
ALL = [*TILES, *PICTURES.values()]


def pixels(paper: Wallpaper) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(paper.png)).convert("RGB"), float)


def by_name(paper: Wallpaper) -> str:
    return paper.name


def test_there_is_a_choice():
    assert [len(table) >= least for table, least in ((FLOORS, 6), (CEILINGS, 4), (WALLS, 8), (PICTURES, 4))] == [
        True
    ] * 4


def test_no_two_textures_share_a_name_or_look_alike():
    assert len({paper.name for paper in ALL}) == len({paper.png for paper in ALL}) == len(ALL)


@pytest.mark.parametrize("paper", ALL, ids=by_name)
def test_a_texture_is_a_small_picture_without_metadata(paper):
    image = Image.open(io.BytesIO(paper.png))
    assert max(image.size) == 256
    assert image.info == {}
    assert len(paper.png) <= 60_000


@pytest.mark.parametrize("paper", TILES, ids=by_name)
def test_a_tile_is_256_texels_square(paper):
    assert pixels(paper).shape == (256, 256, 3)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("paper", TILES, ids=by_name)
def test_a_tile_runs_on_across_its_edges(paper, axis):
    """From the last row to the first it changes no more than anywhere else; wainscot ends at floor and ceiling."""
    if axis == 0 and math.isinf(paper.tile_m[1]):
        return
    image = pixels(paper)
    steps = np.abs(np.roll(image, -1, axis) - image).mean(axis=(1 - axis, 2))
    assert steps[-1] <= 1.25 * steps[:-1].max() + 1


@pytest.mark.parametrize("paper", ALL, ids=by_name)
def test_a_blurred_eye_still_sees_something(paper):
    """Even at 64 texels a tile, which is what a newborn makes out from very near, light and dark differ."""
    grey = np.asarray(Image.open(io.BytesIO(paper.png)).convert("L").reduce(4), float)
    assert np.percentile(grey, 98) - np.percentile(grey, 2) > 8


@pytest.mark.parametrize("paper", PICTURES.values(), ids=by_name)
def test_a_picture_has_a_frame_and_the_shape_it_hangs_in(paper):
    image = pixels(paper)
    edge = np.concatenate([image[0], image[-1], image[:, 0], image[:, -1]])
    assert np.ptp(edge, axis=0).max() < 12
    assert edge.mean() < image.mean() - 30
    assert paper.tile_m[0] / paper.tile_m[1] == pytest.approx(image.shape[1] / image.shape[0])


def chequers(side: int, cell: int) -> np.ndarray:
    rows, columns = np.indices((side, side)) // cell
    return (255 * ((rows + columns) % 2)).astype(np.uint8)


def save(path: Path, array: np.ndarray, mode: str | None = None, **options) -> Path:
    image = Image.fromarray(array)
    (image.convert(mode) if mode else image).save(path, "PNG", **options)
    return path


def pixels_of(png: bytes) -> np.ndarray:
    image = Image.open(io.BytesIO(png))
    assert image.mode == "RGB"
    return np.asarray(image)


def png_of_size(width: int, height: int) -> bytes:
    """Return a PNG that claims a size, and has nothing to show for it."""
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


def chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def test_one_file_is_one_texture(tmp_path):
    (texture,) = read_textures(save(tmp_path / "My Floor!.PNG", chequers(64, 8)))
    assert texture.name == "own_my_floor"
    assert texture.tile_m == (1.0, 1.0)
    assert np.array_equal(pixels_of(texture.png)[..., 0], chequers(64, 8))


def test_a_folder_is_read_by_name_and_the_rest_of_it_left_alone(tmp_path):
    for name in ("b.png", "a.PNG", "c.png", "._c.png", "readme.txt"):
        save(tmp_path / name, chequers(8, 2))
    assert [texture.name for texture in read_textures(tmp_path)] == ["own_a", "own_b", "own_c"]


def test_names_that_become_one_are_numbered(tmp_path):
    for name in ("a b.png", "a-b.png", "ä.png"):
        save(tmp_path / name, chequers(8, 2))
    assert [texture.name for texture in read_textures(tmp_path)] == ["own_a_b", "own_a_b_2", "own_texture"]


def test_a_large_picture_is_made_small_and_stays_seamless(tmp_path):
    (texture,) = read_textures(save(tmp_path / "a.png", chequers(1000, 125)))
    image = pixels_of(texture.png).astype(int)
    assert image.shape == (256, 256, 3)
    assert np.abs(image[:, 0] - 255 + image[:, -1]).max() <= 1, "eight chequers: what is black left is white right"


def test_a_long_picture_keeps_its_shape(tmp_path):
    (texture,) = read_textures(save(tmp_path / "a.png", np.zeros((100, 5000), np.uint8)))
    assert pixels_of(texture.png).shape == (5, 256, 3)
    assert texture.tile_m == pytest.approx((1.0, 5 / 256))


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGB", "RGBA"])
def test_every_kind_of_png_becomes_rgb(tmp_path, mode):
    (texture,) = read_textures(save(tmp_path / "a.png", chequers(32, 4), mode))
    assert np.array_equal(pixels_of(texture.png)[..., 1], chequers(32, 4))


def test_sixteen_bits_are_scaled_and_not_cut_off(tmp_path):
    grey = np.full((8, 8), 0x8000, np.uint16)
    assert pixels_of(read_textures(save(tmp_path / "a.png", grey))[0].png)[0, 0, 0] == 0x80


def test_what_is_transparent_becomes_white(tmp_path):
    (texture,) = read_textures(save(tmp_path / "a.png", np.zeros((8, 8, 4), np.uint8)))
    assert (pixels_of(texture.png) == 255).all()


def test_nothing_but_the_picture_is_kept(tmp_path):
    info = PngImagePlugin.PngInfo()
    info.add_text("Author", "me, 1 January")
    told = save(tmp_path / "a.png", chequers(32, 4), pnginfo=info, dpi=(72, 72))
    plain = save(tmp_path / "b.png", chequers(32, 4))
    assert read_textures(told)[0].png == read_textures(plain)[0].png
    assert Image.open(io.BytesIO(read_textures(told)[0].png)).info == {}


def broken(folder: Path) -> dict[str, Path]:
    """Return paths that are no textures, by what is wrong."""
    whole = save(folder / "whole.png", np.random.default_rng(0).integers(0, 255, (64, 64, 3)).astype(np.uint8))
    content = whole.read_bytes()
    files = {
        "text": b"hello, I am not a picture\n" * 9,
        "empty": b"",
        "cut short": content[: len(content) // 2],
        "scrambled": content[:60] + bytes(200) + content[260:],
        "head only": content[:20],
        "huge": png_of_size(6000, 4000),
        "a bomb": png_of_size(100_000, 100_000),
        "no area": png_of_size(0, 5),
        "no texels": png_of_size(50, 50),
    }
    made = {}
    for number, (fault, content) in enumerate(files.items()):
        made[fault] = folder / f"{number}.png"
        made[fault].write_bytes(content)
    made["a jpeg"] = folder / "jpeg.png"
    Image.fromarray(chequers(16, 4)).save(made["a jpeg"], "JPEG")
    made["missing"] = folder / "missing.png"
    made["an empty folder"] = folder / "nothing"
    made["an empty folder"].mkdir()
    made["a loop"] = folder / "loop.png"
    made["a loop"].symlink_to(made["a loop"])
    made["a pipe"] = folder / "pipe.png"
    os.mkfifo(made["a pipe"])
    made["a null"] = folder / "a\0b.png"
    made["nobody"] = Path("~nobody-of-that-name/a.png")
    made["a name too long"] = folder / ("x" * 5000)
    return made


def test_what_is_no_texture_is_named_with_what_to_do(tmp_path):
    for fault, path in broken(tmp_path).items():
        with pytest.raises(TextureError) as raised:
            read_textures(path)
        message = str(raised.value)
        assert issubclass(TextureError, MimocError)
        assert path.name.split("\0")[0][:40] in message, fault
        assert "; " in message, fault
        assert "\n" not in message, fault


def test_a_huge_picture_is_told_how_large_it_may_be(tmp_path):
    (tmp_path / "a.png").write_bytes(png_of_size(6000, 4000))
    with pytest.raises(TextureError, match="more than 20 megapixels; reduce it: 256 px"):
        read_textures(tmp_path / "a.png")


def test_all_that_is_wrong_in_a_folder_is_told_at_once(tmp_path):
    save(tmp_path / "good.png", chequers(8, 2))
    (tmp_path / "bad.png").write_text("hello")
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(TextureError) as raised:
        read_textures(tmp_path)
    first, second = str(raised.value).splitlines()
    assert "bad.png: is not a PNG" in first
    assert "folder.png: is not a file" in second
