import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from mimoc.components.senses.vision.foveation import RADII, foveate, source_weights, to_source

SIZES_PX = [(12, 12), (13, 8), (7, 10)]
STRENGTHS = [0.5, 5.0, 30.0]
FINE = 80
"""Steps across a pixel in the slow reference."""

sizes_px = st.tuples(st.integers(1, 64), st.integers(1, 64))
strengths = st.one_of(st.just(0.0), st.floats(1e-6, 1000))
numbers = st.floats(-1, 1, allow_subnormal=False)
shares = st.tuples(numbers, numbers)


def slow_weights(size_px: tuple[int, int], strength: float, radius: str) -> np.ndarray:
    """Return the weights by brute force: points sown over each pixel, each worth the area that it stands for."""
    (width, height), n = size_px, FINE
    weights = np.zeros((width * height, width * height))
    for cell in range(width * height):
        corner = np.array([cell % width - width / 2, cell // width - height / 2])
        if radius == "edge" and np.hypot(*(corner + 0.5)) > min(size_px) / 2:
            continue
        y, x = np.mgrid[: n + 1, : n + 1] / n
        mapped = slow_source(corner + np.stack([x, y], axis=-1), size_px, strength, radius)
        ahead, below = np.diff(mapped, axis=1)[:-1], np.diff(mapped, axis=0)[:, :-1]
        areas = np.abs(ahead[..., 0] * below[..., 1] - ahead[..., 1] * below[..., 0])
        middles = (mapped[:-1, :-1] + mapped[1:, 1:]) / 2
        column, row = np.moveaxis(np.floor(middles + np.divide(size_px, 2)).astype(int), -1, 0)
        seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        np.add.at(weights[cell], (row * width + column)[seen], areas[seen])
    sums = weights.sum(axis=1, keepdims=True)
    return np.divide(weights, sums, out=np.zeros_like(weights), where=sums > 0)


def slow_source(points: np.ndarray, size_px: tuple[int, int], strength: float, radius: str) -> np.ndarray:
    """Return where points come from, straight from the formula: radius and direction of each."""
    half = np.divide(size_px, 2)
    r, angle = np.hypot(points[..., 0], points[..., 1]), np.arctan2(points[..., 1], points[..., 0])
    with np.errstate(divide="ignore", over="ignore"):  # Along an axis, the other border is infinitely far.
        border = np.minimum(half[0] / np.abs(np.cos(angle)), half[1] / np.abs(np.sin(angle)))
    reach = {"border": border, "corner": np.hypot(*half), "edge": half.min()}[radius]
    source = reach * np.expm1(r / reach * np.log1p(strength)) / strength
    return source[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def from_source(points_px, size_px: tuple[int, int], strength: float, radius: str) -> np.ndarray:
    """Return where a warped picture shows points of the picture as it was drawn: the inverse of `to_source`."""
    magnification = strength / np.log1p(strength) if strength else 1.0
    stretched = strength * RADII[radius](points_px, size_px)[..., None]
    shares = np.divide(np.log1p(stretched), stretched, out=np.ones_like(stretched), where=stretched > 0)
    return points_px * magnification * shares


def warped(picture: np.ndarray, strength: float, radius: str) -> np.ndarray:
    height, width = picture.shape
    return foveate(picture.astype(np.float32)[..., None], source_weights(width, height, strength, radius))[..., 0]


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("strength", STRENGTHS)
@pytest.mark.parametrize("size_px", SIZES_PX, ids=str)
def test_weights_are_the_areas_of_a_pixels_source(size_px, strength, radius):
    """Against integration by brute force, as fine as that is."""
    weights = source_weights(*size_px, strength, radius).toarray()
    slow = slow_weights(size_px, strength, radius)
    assert np.abs(weights - slow).max() < 2 / FINE
    assert np.abs(weights - slow).mean() < 2e-4


@pytest.mark.parametrize("radius", RADII)
@settings(max_examples=30)
@given(size_px=sizes_px, strength=st.floats(0.01, 1000))
def test_pixels_average_their_source_and_without_one_are_black(size_px, strength, radius):
    sums = source_weights(*size_px, strength, radius).sum(axis=1)
    width, height = size_px
    y, x = np.mgrid[:height, :width] + 0.5
    has_source = RADII[radius](np.stack([x - width / 2, y - height / 2], axis=-1).reshape(-1, 2), size_px) <= 1
    assert sums == pytest.approx(has_source.astype(float), abs=1e-5)
    assert has_source.all() or radius == "edge"


@given(size_px=sizes_px, strength=st.floats(0.01, 1000))
def test_up_to_the_border_nothing_is_lost(size_px, strength):
    """Every pixel drawn is part of some pixel seen."""
    assert (source_weights(*size_px, strength, "border").sum(axis=0) > 0).all()


def test_up_to_the_corners_the_middles_of_the_edges_are_cut_off():
    assert to_source(np.array([32.0, 0.0]), (64, 64), 5.0, "corner")[0] == pytest.approx(0.72 * 32, abs=0.1)
    assert to_source(np.array([32.0, 32.0]), (64, 64), 5.0, "corner") == pytest.approx([32, 32])
    assert warped(np.ones((64, 64)), 5.0, "corner").min() == pytest.approx(1)


def test_up_to_the_nearest_edge_the_rest_is_black():
    seen = warped(np.ones((64, 96)), 5.0, "edge")
    assert seen[0, 48] == seen[32, 17] == pytest.approx(1)
    assert seen[0, 0] == seen[32, 8] == 0


@pytest.mark.parametrize("radius", RADII)
@given(size_px=sizes_px, strength=strengths, share=shares)
def test_the_two_ways_of_the_mapping_undo_each_other(size_px, strength, share, radius):
    point_px = np.array(share) * size_px / 2
    there = to_source(point_px, size_px, strength, radius)
    assert from_source(there, size_px, strength, radius) == pytest.approx(point_px, rel=1e-9, abs=1e-9)
    back = from_source(point_px, size_px, strength, radius)
    assert to_source(back, size_px, strength, radius) == pytest.approx(point_px, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("radius", RADII)
@given(size_px=sizes_px, strength=st.floats(1e-3, 1000), share=shares.filter(lambda share: np.hypot(*share) > 1e-3))
def test_the_mapping_is_that_of_the_formula(size_px, strength, share, radius):
    point_px = np.array(share) * size_px / 2
    formula = slow_source(point_px, size_px, strength, radius)
    tolerance_px = 1e-9 * (1 + np.abs(formula).max())
    assert to_source(point_px, size_px, strength, radius) == pytest.approx(formula, rel=1e-6, abs=tolerance_px)


@pytest.mark.parametrize("radius", RADII)
def test_strength_zero_is_no_warp(radius):
    points_px = np.random.default_rng(0).uniform(-32, 32, (100, 2))
    assert np.array_equal(to_source(points_px, (64, 64), 0.0, radius), points_px)
    assert np.array_equal(from_source(points_px, (64, 64), 0.0, radius), points_px)


@pytest.mark.parametrize("strength", STRENGTHS)
def test_the_centre_is_magnified_and_the_rim_compressed(strength):
    """By s / ln(1 + s), and by (1 + s) ln(1 + s) / s."""
    near, rim = np.array([[1e-4, 0.0], [32 - 1e-4, 0.0]]), np.array([32.0, 0.0])
    (centre, before_rim), at_rim = (to_source(points, (64, 64), strength, "border") for points in (near, rim))
    assert near[0, 0] / centre[0] == pytest.approx(strength / np.log1p(strength), rel=1e-4)
    slope = (at_rim[0] - before_rim[0]) / 1e-4
    assert slope == pytest.approx((1 + strength) * np.log1p(strength) / strength, rel=1e-3)


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("at", [(20, 30), (40, 25), (33, 44)])
def test_a_spot_moves_to_where_the_mapping_says(at, radius):
    """The middle of its light, in a wide picture."""
    x, y = at
    picture = np.zeros((64, 80))
    picture[y, x] = 1000.0
    seen = warped(picture, 3.0, radius)
    rows, columns = np.mgrid[:64, :80] + 0.5
    middle = np.array([(seen * columns).sum(), (seen * rows).sum()]) / seen.sum()
    centre = np.array([40, 32])
    wanted = centre + from_source(np.array([x, y]) + 0.5 - centre, (80, 64), 3.0, radius)
    assert middle == pytest.approx(wanted, abs=0.15)


@pytest.mark.parametrize("radius", RADII)
def test_left_and_right_and_top_and_bottom_are_warped_alike(radius):
    picture = np.random.default_rng(1).uniform(0, 255, (20, 31))
    for flip in (np.fliplr, np.flipud):
        assert warped(flip(picture), 5.0, radius) == pytest.approx(flip(warped(picture, 5.0, radius)), abs=1e-3)


def test_every_eye_and_colour_is_warped_by_itself():
    pictures = np.random.default_rng(2).uniform(0, 255, (2, 20, 30, 3)).astype(np.float32)
    seen = foveate(pictures, source_weights(30, 20, 5.0, "border"))
    assert seen.dtype == np.float32
    for eye in range(2):
        for colour in range(3):
            alone = warped(pictures[eye, :, :, colour], 5.0, "border")
            assert seen[eye, :, :, colour] == pytest.approx(alone, abs=1e-3)


def test_the_weights_are_worked_out_once():
    assert source_weights(16, 12, 5.0, "border") is source_weights(16, 12, 5.0, "border")


def test_large_pictures_are_worked_out_in_parts_that_fit_together():
    """Of more pixels than are looked up in one go: the quarters mirror each other."""
    weights = source_weights(90, 70, 5.0, "corner")
    picture = np.random.default_rng(3).uniform(0, 255, (70, 90))
    once = (weights @ picture.astype(np.float32).ravel()).reshape(70, 90)
    assert once == pytest.approx((weights @ picture[::-1, ::-1].ravel()).reshape(70, 90)[::-1, ::-1], abs=1e-3)
