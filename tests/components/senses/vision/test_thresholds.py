"""Contrast thresholds: gratings of an entered contrast are lost below the entered threshold, and nothing else is."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import fft
from support.full import full_but

from mimoc.components.senses.vision import VisionEntry, VisionSpec, thresholds
from mimoc.components.senses.vision.build import maturity_of
from mimoc.components.senses.vision.foveation import pixels_per_degree
from mimoc.components.senses.vision.run import filters, perceive
from mimoc.components.senses.vision.thresholds import COSINES, above_threshold, sensitivity_at, threshold_bands

MEAN = 127.5
SIZE_PX, FOVY_DEG = 64, 60.0
FINEST_CPD = pixels_per_degree(SIZE_PX, FOVY_DEG) / 2
AGES = (0, 1, 3, 6, 12, 24)


def entry_of(contrast: float | str, age_months: float = 9, **changes) -> VisionEntry:
    spec = VisionSpec.model_validate({"contrast": contrast})
    fields = {"acuity_cpd": 5.0} | maturity_of(spec, age_months) | changes
    eye = {"cameras": ("eye_left",), "width_px": SIZE_PX, "height_px": SIZE_PX, "supersample": 1, "unseen": ()}
    return VisionEntry(**{"foveation": 0, "foveation_radius": "border", **eye, **fields})


def grating(half_cycles: tuple[int, int], size_px: int = SIZE_PX) -> np.ndarray:
    """Return a cosine with whole half cycles down and across, shape (height, width)."""
    along = (np.arange(size_px) + 0.5) / size_px * np.pi
    return np.cos(half_cycles[0] * along)[:, None] * np.cos(half_cycles[1] * along)


def share_left(wave: np.ndarray, contrast: float, bands: thresholds.Bands) -> float:
    shown = (MEAN * (1 + contrast * wave)).astype(np.float32)
    seen = above_threshold(shown[None], bands, COSINES)[0] - MEAN
    return float((seen * wave).sum() / (wave**2).sum() / (MEAN * contrast))


def threshold_of(wave: np.ndarray, bands: thresholds.Bands) -> float:
    """Return the least contrast of which anything is left, by bisection."""
    low, high = 1e-4, 1.0
    while high / low > 1.002:
        middle = np.sqrt(low * high)
        low, high = (low, middle) if share_left(wave, middle, bands) > 0.01 else (middle, high)
    return float(np.sqrt(low * high))


@pytest.mark.parametrize("age_months", full_but([0, 6], AGES))
@pytest.mark.parametrize("across", full_but([13, 35, 61], [18, 22, 26, 30, 41, 47, 53]))
def test_a_trial_gives_back_the_threshold_of_each_age_and_frequency(age_months, across):
    """Within 4 %, from .1 cycles per degree to what the picture holds, also between the middles of bands.

    At four pixels a cycle it depends on their phase what pixels show of a grating.
    """
    frequency_cpd = across / SIZE_PX * FINEST_CPD
    entry = entry_of("age", age_months, acuity_cpd=30.0)
    bands = threshold_bands(
        (SIZE_PX, SIZE_PX), FOVY_DEG, entry.sensitivity, entry.sensitivity_peak_cpd, entry.acuity_cpd
    )
    entered = 1 / sensitivity_at(np.array(frequency_cpd), entry.sensitivity, entry.sensitivity_peak_cpd)
    assert threshold_of(grating((0, across)), bands) == pytest.approx(entered, rel=0.04)


@pytest.mark.parametrize("fovy_deg", [12, 25])
@pytest.mark.parametrize("across", [20, 37, 63])
def test_so_it_does_in_larger_pictures_of_narrower_fields(fovy_deg, across):
    size_px = 96
    frequency_cpd = across / (2 * size_px) * pixels_per_degree(size_px, fovy_deg)
    bands = threshold_bands((size_px, size_px), fovy_deg, 28.0, 0.7, 5.0)
    entered = 1 / sensitivity_at(np.array(frequency_cpd), 28.0, 0.7)
    assert threshold_of(grating((across, 0), size_px), bands) == pytest.approx(entered, rel=0.04)


@pytest.mark.parametrize("contrast", [0.4, 0.9])
def test_well_above_the_threshold_is_left_what_acuity_leaves(contrast):
    """1 - f / a of it, but for the square of threshold over contrast."""
    bands = threshold_bands((SIZE_PX, SIZE_PX), FOVY_DEG, 28.0, 0.7, 1.5)
    for across in (15, 30, 50):
        frequency_cpd = across / SIZE_PX * FINEST_CPD
        left = share_left(grating((0, across)), contrast, bands)
        assert left == pytest.approx(1 - frequency_cpd / 1.5, abs=0.02 + 0.02 / contrast)


def test_nothing_finer_than_the_acuity_is_seen_at_any_contrast():
    bands = threshold_bands((SIZE_PX, SIZE_PX), FOVY_DEG, 28.0, 0.05, 0.3)
    assert abs(share_left(grating((0, 45)), 1.0, bands)) < 1e-3


def test_a_small_thing_is_seen_where_a_fine_texture_is_lost():
    """A dark square keeps its contrast, a texture of a tenth of it is smoothed."""
    bands = threshold_bands((SIZE_PX, SIZE_PX), FOVY_DEG, 5.0, 0.15, None)
    texture = 1 + 0.05 * grating((40, 40))
    shown = (MEAN * texture).astype(np.float32)
    shown[24:36, 24:36] = 10
    seen = above_threshold(shown[None], bands, COSINES)[0]
    assert seen[28:32, 28:32].mean() < 0.5 * MEAN
    assert seen[:16, :16].std() < 0.3 * shown[:16, :16].std()


@given(st.integers(1, 40), st.integers(1, 40), st.floats(2, 300), st.floats(0.05, 5), st.integers(0, 2**32 - 1))
def test_the_mean_stays_and_nothing_gains_much_contrast(width, height, peak, peak_cpd, seed):
    """Whatever the size; masks of bands may move contrast, but make none."""
    pictures = np.random.default_rng(seed).uniform(0, 255, (2, height, width)).astype(np.float32)
    seen = above_threshold(pictures, threshold_bands((width, height), 60.0, peak, peak_cpd, 10 * peak_cpd), COSINES)
    assert seen.dtype == np.float32
    assert seen.mean(axis=(1, 2)) == pytest.approx(pictures.mean(axis=(1, 2)), abs=0.02)
    assert (seen.std(axis=(1, 2)) <= 1.1 * pictures.std(axis=(1, 2)) + 0.05).all()


def test_older_infants_see_more_of_what_has_little_contrast():
    picture = np.random.default_rng(3).normal(MEAN, 12, (1, SIZE_PX, SIZE_PX, 1)).clip(0, 255)
    shown = np.repeat(picture, 3, axis=-1).round().astype(np.uint8)
    seen = [perceive(shown, filters(entry_of("age", age, acuity_cpd=5.0), FOVY_DEG)).std() for age in AGES]
    assert seen == sorted(seen)
    assert seen[0] < 0.1 * seen[-1]


def test_adults_see_pictures_of_64_pixels_nearly_as_they_are_drawn():
    """Coarse pictures of full contrast: within 1 level of 255 on average, and 8 for all but 1 % of the pixels."""
    rng = np.random.default_rng(0)
    coarse = rng.integers(0, 256, (2, 16, 16, 3)).repeat(4, axis=1).repeat(4, axis=2).astype(np.uint8)
    seen = perceive(coarse, filters(entry_of("adult", acuity_cpd=None), FOVY_DEG)).astype(int)
    difference = np.abs(seen - coarse)
    assert difference.mean() < 1
    assert np.percentile(difference, 99) <= 8


def test_each_eye_has_the_threshold_of_its_own_acuity():
    entry = entry_of("age", 3, acuity_cpd=2.0, cameras=("eye_left", "eye_right"), acuity_shares=(0.2, 1.0))
    shown = np.broadcast_to((MEAN * (1 + 0.3 * grating((0, 40))))[None, :, :, None], (2, SIZE_PX, SIZE_PX, 3))
    seen = perceive(shown.round().astype(np.uint8), filters(entry, FOVY_DEG))
    alone = perceive(shown[1:].round().astype(np.uint8), filters(entry.model_copy(update={"acuity_shares": ()}), 60.0))
    assert 4 * np.ptp(seen[0]) < np.ptp(seen[1])
    assert np.abs(seen[1].astype(int) - alone[0]).max() <= 1


@pytest.mark.parametrize("shape", [(2, 12, 64), (3, 2, 48, 7), (1, 70, 16)])
def test_products_are_the_cosine_transform(shape):
    planes = np.random.default_rng(1).uniform(0, 255, shape).astype(np.float32)
    spectrum = thresholds.forward(planes)
    assert spectrum == pytest.approx(fft.dctn(planes, axes=(-2, -1), norm="ortho"), abs=0.01)
    assert thresholds.inverse(spectrum) == pytest.approx(planes, abs=0.01)
