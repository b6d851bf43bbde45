"""Colour vision: what is pure enough is seen, paler; luminance stays, and what is grey stays grey."""

import numpy as np
import pytest

from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.colours import limit_colours, limits_of
from mimoc.components.senses.vision.run import filters, perceive
from mimoc.components.senses.vision.thresholds import NUMPY

SIZE_PX = 32
HUES = {"red": (1, 0, 0), "green": (0, 1, 0), "blue": (0, 0, 1), "yellow": (1, 1, 0), "violet": (0.5, 0, 1)}
WEIGHTS = np.array([0.2126, 0.7152, 0.0722])
THRESHOLDS = {0: 0.5, 3: 0.26, 6: 0.135, 12: 0.07}


def eye(**changes) -> VisionEntry:
    size = {"width_px": SIZE_PX, "height_px": SIZE_PX, "supersample": 1, "unseen": ()}
    usual = {"acuity_cpd": None, "foveation": 0, "foveation_radius": "border"}
    return VisionEntry(**{"cameras": ("eye_left",), **size, **usual, **changes})


def plain(purity: float, hue: str) -> np.ndarray:
    """Return a picture of one colour: some purity of a hue in white of the same mean."""
    colour = np.array(HUES[hue]) / np.mean(HUES[hue])
    return np.full((1, SIZE_PX, SIZE_PX, 3), 60 * (1 - purity + purity * colour), np.float32)


def limited(pictures: np.ndarray, entry: VisionEntry) -> np.ndarray:
    limits = limits_of(entry, (SIZE_PX, SIZE_PX), 60.0)
    assert limits is not None
    return limit_colours(pictures, limits, NUMPY)


@pytest.mark.parametrize("hue", HUES)
@pytest.mark.parametrize("threshold", THRESHOLDS.values())
def test_a_trial_gives_back_the_entered_threshold_of_purity(hue, threshold):
    """Within 1 %: the least purity of which any colour is left, by bisection."""
    entry, low, high = eye(purity_threshold=threshold, chroma_gain=0.3), 0.0, 1.0
    while high - low > 1e-3:
        middle = (low + high) / 2
        low, high = (low, middle) if np.ptp(limited(plain(middle, hue), entry)[0, 9, 9]) > 0.01 else (middle, high)
    assert high == pytest.approx(threshold, rel=0.01, abs=2e-3)


def test_far_above_the_threshold_the_gain_is_left():
    shown = plain(1.0, "red")
    seen = limited(shown, eye(purity_threshold=0.1, chroma_gain=0.6))
    assert np.ptp(seen[0, 9, 9]) / np.ptp(shown[0, 9, 9]) == pytest.approx(0.6, rel=0.01)


def test_luminance_stays_and_grey_stays_grey():
    shown = np.random.default_rng(0).uniform(0, 255, (2, SIZE_PX, SIZE_PX, 3)).astype(np.float32)
    seen = limited(shown, eye(purity_threshold=0.3, chroma_gain=0.5))
    assert seen @ WEIGHTS == pytest.approx(shown @ WEIGHTS, abs=0.01)
    grey = np.repeat(shown[..., :1], 3, axis=-1)
    assert limited(grey, eye(purity_threshold=0.3, chroma_gain=0.5)) == pytest.approx(grey, abs=0.01)


def test_chroma_is_seen_half_as_fine_as_luminance():
    """A grating from red to green that has one luminance is gone at half of the acuity, one in luminance is not."""
    wave = np.cos(np.pi * 24 * (np.arange(SIZE_PX) + 0.5) / SIZE_PX)[:, None, None]
    chroma, luminance = np.array([0.7152, -0.2126, 0]), np.ones(3)
    frequency_cpd = 24 / (2 * SIZE_PX) * SIZE_PX / 2 / np.tan(np.radians(30)) * np.pi / 180
    entry = eye(purity_threshold=0.0, acuity_cpd=1.9 * frequency_cpd)
    for colours, left in ((chroma, 0.0), (luminance, 1 - 1 / 1.9)):
        grating = np.broadcast_to(100 + 50 * wave * colours, (SIZE_PX, SIZE_PX, 3)).astype(np.float32)
        seen = limited(grating[None], entry)
        assert np.ptp(seen) / np.ptp(grating) == pytest.approx(left, abs=0.02)


def test_adults_see_all_colours_that_8_bits_hold():
    shown = np.random.default_rng(0).integers(0, 256, (1, SIZE_PX, SIZE_PX, 3), dtype=np.uint8)
    adult = eye(purity_threshold=0.005)
    assert np.abs(perceive(shown, filters(adult, 60.0)).astype(int) - shown).max() <= 1


def test_without_thresholds_the_chain_is_as_it_was():
    assert limits_of(eye(acuity_cpd=2.0), (SIZE_PX, SIZE_PX), 60.0) is None
    assert [step.func.__name__ for step in filters(eye(acuity_cpd=2.0), 60.0)] == ["blur"]
    assert filters(eye(), 60.0) == ()
