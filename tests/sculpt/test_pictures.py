"""The pictures that ship with mimoc, and what paints them."""

import hashlib
import io

import make_pictures
import numpy as np
import pytest
from head_mesh import unwrapped, wrapped
from pictures.cubes import CELLS, EYE_CELL_PX, EYE_Y, EYE_Z, FACE_CELL_PX, FACES, directions
from pictures.inks import Painted, coloured, ink, mixed, plain, with_palette
from PIL import Image

from mimoc.compiler.looks.appearance import GRID_LAYOUT
from mimoc.compiler.looks.pictures import FOLDER, INKS, inks_of, mixtures, read_picture
from mimoc.schema.body import EXPRESSIONS, LooksSpec

SKIN = inks_of(LooksSpec(), "shirt_and_trousers")["skin"]


@pytest.fixture(scope="module")
def painted() -> dict[str, bytes | Painted]:
    return dict(make_pictures.paint_pictures())


def face(expression: str) -> bytes:
    return read_picture(f"face_round_{expression}")


def pixels(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), float)


def cells(png: bytes) -> dict[str, np.ndarray]:
    image = pixels(png).reshape(2, FACE_CELL_PX, 3, FACE_CELL_PX, 3).swapaxes(1, 2)
    return dict(zip(GRID_LAYOUT, image.reshape(6, FACE_CELL_PX, FACE_CELL_PX, 3), strict=True))


def at(png: bytes, cell_px: int, *direction: float) -> np.ndarray:
    unit = np.asarray(direction) / np.linalg.norm(direction)
    return pixels(png).reshape(-1, 3)[np.argmax(directions(cell_px).reshape(-1, 3) @ unit)]


def on_head(y: float, z: float) -> tuple[float, float, float]:
    """Return the point of the unit sphere that the front view shows at *y*, *z*."""
    return (1 - y**2 - z**2) ** 0.5, y, z


def brightness(colour: np.ndarray) -> float:
    return float(colour.mean())


@pytest.mark.full
def test_painting_again_gives_the_same_bytes(painted):
    shipped = {path.stem: hashlib.sha256(path.read_bytes()).hexdigest() for path in FOLDER.glob("*.png")}
    pngs = {name: picture.png if isinstance(picture, Painted) else picture for name, picture in painted.items()}
    assert {name: hashlib.sha256(png).hexdigest() for name, png in pngs.items()} == shipped


@pytest.mark.full
def test_mixtures_that_are_shipped_are_those_of_the_palettes(painted):
    mixed_pictures = {name: picture.mixtures for name, picture in painted.items() if isinstance(picture, Painted)}
    assert mixtures().keys() == mixed_pictures.keys()
    assert all(np.array_equal(mixtures()[name], amounts) for name, amounts in mixed_pictures.items())


def test_colours_of_a_palette_are_mixtures_that_look_alike_on_all():
    """With room for all, they are as painted; with less, the larger differences are kept."""
    share = np.linspace(0, 1, 64)[None, :, None]
    canvas = plain((1, 64), ink("skin")) * (1 - share) + plain((1, 64), ink("hair")) * share
    whole, few = with_palette(canvas, 256), with_palette(canvas, 8)
    assert np.array_equal(pixels(whole.png), coloured(canvas))
    assert few.mixtures.shape == (8, len(INKS))
    assert np.abs(pixels(few.png) - coloured(canvas)).max() < 12


def test_the_shares_of_a_mixture_are_of_its_inks():
    assert np.array_equal(0.4 * ink("skin") + 0.6 * ink("shade"), mixed(skin=0.4, shade=0.6))


def test_every_expression_is_painted_in_the_order_of_the_language():
    assert tuple(FACES) == EXPRESSIONS


@pytest.mark.parametrize("expression", FACES)
def test_every_face_is_a_small_picture(expression):
    png = face(expression)
    assert max(Image.open(io.BytesIO(png)).size) <= 256
    assert len(png) < 40_000


def test_eye_ear_and_cloth_are_smaller_still():
    assert sum(len(read_picture(name)) for name in ("eye", "ear", "stripes")) < 15_000


def test_a_png_carries_nothing_but_its_pixels():
    assert Image.open(io.BytesIO(face("neutral"))).info == {}


def test_no_two_expressions_look_alike():
    assert len({face(expression) for expression in FACES}) == len(FACES)


def test_every_direction_has_a_texel_and_every_cell_its_own_axis():
    grid = directions(9)
    assert np.allclose(np.linalg.norm(grid, axis=2), 1)
    middles = [grid[9 * (i // 3) + 4, 9 * (i % 3) + 4] for i in range(6)]
    assert np.allclose(middles, [CELLS[letter][0] for letter in GRID_LAYOUT])


def test_the_face_is_left_right_symmetric():
    cell = cells(face("happy"))
    assert all(np.array_equal(cell[letter], cell[letter][::-1]) for letter in "RLFB")
    assert np.array_equal(cell["U"], cell["D"][::-1])


def test_the_mouth_is_on_the_front_only():
    height = FACES["neutral"].mouth_height
    lips = at(face("neutral"), FACE_CELL_PX, *on_head(0, height))
    behind = at(face("neutral"), FACE_CELL_PX, -on_head(0, height)[0], 0, height)
    assert brightness(lips) < brightness(np.asarray(SKIN)) - 40
    assert np.allclose(behind, SKIN, atol=2)


@pytest.mark.parametrize("side", [1, -1])
def test_each_eye_has_white_below_its_lashes(side):
    white = at(face("neutral"), FACE_CELL_PX, *on_head(side * EYE_Y, EYE_Z))
    lashes = at(face("neutral"), FACE_CELL_PX, *on_head(side * EYE_Y, EYE_Z + 0.135))
    assert white.min() > 235
    assert brightness(lashes) < brightness(np.asarray(SKIN)) - 30


def test_the_forehead_is_bare_and_the_back_has_hair():
    forehead = at(face("neutral"), FACE_CELL_PX, *on_head(0, 0.5))
    back = at(face("neutral"), FACE_CELL_PX, -0.7, 0, 0.7)
    assert np.allclose(forehead, SKIN, atol=2)
    assert brightness(back) < brightness(forehead) - 30


def test_colours_run_on_across_the_seams_of_the_cube():
    """Directions a texel apart but in different cells differ no more than neighbours in one cell."""
    cell = cells(face("neutral"))
    seam = np.abs(cell["F"][:, -1] - cell["R"][:, 0]).max()
    assert seam < 1.5 * np.abs(np.diff(cell["R"][:, :8], axis=1)).max() + 4


def test_the_pupil_is_at_plus_x():
    assert brightness(at(read_picture("eye"), EYE_CELL_PX, 1, 0, 0)) < 40
    assert all(at(read_picture("eye"), EYE_CELL_PX, *away).min() > 215 for away in [(-1, 0, 0), (0, 1, 0), (0, 0, -1)])


def test_happy_corners_of_the_mouth_stand_above_sad_ones():
    assert FACES["happy"].smile > FACES["neutral"].smile > 0 > FACES["sad"].smile


def test_places_in_the_picture_of_a_face_show_their_directions():
    directions = np.random.default_rng(0).normal(size=(200, 3))
    again = wrapped(unwrapped(directions))
    assert np.allclose(again, directions / np.linalg.norm(directions, axis=1, keepdims=True), atol=1e-9)
