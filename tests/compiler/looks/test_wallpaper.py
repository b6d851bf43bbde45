import io
import math

import numpy as np
import pytest
from PIL import Image

from mimoc.compiler.looks.wallpaper import CEILINGS, FLOORS, PICTURES, WALLS, Wallpaper

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
