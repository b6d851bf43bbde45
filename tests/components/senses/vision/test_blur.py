import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.special import sici

from mimoc.components.senses.vision.foveation import CONTRAST_LAWS, blur, contrast_gain, pixels_per_degree

SIZES_PX = [(64, 64), (96, 48), (50, 81)]
FULL_SCALE = 255.0


def seen(picture: np.ndarray, fovy_deg: float, acuity_cpd: float) -> np.ndarray:
    """Return a grey picture, shape (height, width), as an eye of that acuity sees it."""
    height, width = picture.shape
    gain = contrast_gain(width, height, fovy_deg, acuity_cpd)
    return blur(picture.astype(np.float32)[..., None], gain)[..., 0]


def filtered(picture: np.ndarray, pad_px: int, mode: str, pixels_per_degree: float, acuity_cpd: float) -> np.ndarray:
    """Return the same by Fourier transform of a padded picture, slowly, as `reference/senses.md` has it."""
    padded = np.pad(picture.astype(float), pad_px, mode=mode) if pad_px else picture.astype(float)
    rows, columns = (np.fft.fftfreq(size) * pixels_per_degree for size in padded.shape)
    gain = np.maximum(0, 1 - np.hypot(rows[:, None], columns) / acuity_cpd)
    whole = np.fft.ifft2(np.fft.fft2(padded) * gain).real
    return whole[pad_px : pad_px + picture.shape[0], pad_px : pad_px + picture.shape[1]]


def grating(size_px: tuple[int, int], cycles_per_px: float, angle_deg: float, phase: float = 0.0) -> np.ndarray:
    width, height = size_px
    y, x = np.mgrid[:height, :width] + 0.5
    along = (x - width / 2) * np.cos(np.radians(angle_deg)) + (y - height / 2) * np.sin(np.radians(angle_deg))
    return np.cos(2 * np.pi * cycles_per_px * along + phase)


def contrast(picture: np.ndarray, cycles_per_px: float, angle_deg: float) -> float:
    """Return the amplitude of a grating in the middle third of a picture, by least squares."""
    height, width = picture.shape
    middle = np.s_[height // 3 : -(height // 3), width // 3 : -(width // 3)]
    waves = [grating((width, height), cycles_per_px, angle_deg, phase)[middle].ravel() for phase in (0, np.pi / 2)]
    basis = np.stack([*waves, np.ones_like(waves[0])], axis=1)
    cosine, sine, _ = np.linalg.lstsq(basis, picture[middle].ravel(), rcond=None)[0]
    return float(np.hypot(cosine, sine))


def test_pixels_per_degree_are_those_of_a_pinhole():
    """At the centre, where a small angle is as many pixels as its tangent times the focal length."""
    assert pixels_per_degree(64, 60) == pytest.approx(0.967, abs=5e-4)
    assert pixels_per_degree(256, 60) == pytest.approx(3.87, abs=5e-3)
    focal_px = 32 / np.tan(np.radians(30))
    assert pixels_per_degree(64, 60) == pytest.approx(focal_px * np.tan(np.radians(0.5)) * 2, rel=1e-4)


@pytest.mark.parametrize("size_px", SIZES_PX)
@pytest.mark.parametrize("fovy_deg", [20, 60])
@pytest.mark.parametrize("angle_deg", [0, 30, 45, 90, 127])
@pytest.mark.parametrize("share", [0.3, 0.5, 0.8, 1.0, 1.3])
def test_a_grating_keeps_the_contrast_that_its_frequency_leaves(size_px, fovy_deg, angle_deg, share):
    """1 - f / a, within .02, for an eye whose limit is at a fifth of the sampling frequency."""
    scale = pixels_per_degree(size_px[1], fovy_deg)
    acuity_cpd = 0.2 * scale
    wave = grating(size_px, share * 0.2, angle_deg)
    left = contrast(seen(wave, fovy_deg, acuity_cpd), share * acuity_cpd / scale, angle_deg)
    assert left == pytest.approx(max(0, 1 - share), abs=0.02)


def test_it_is_the_filter_of_a_picture_that_goes_on_as_its_mirror_image():
    """To rounding; the slow way is to unfold half of the picture on each side, which then repeats without a seam."""
    picture = np.random.default_rng(0).uniform(0, FULL_SCALE, (40, 40))
    slow = filtered(picture, 20, "symmetric", pixels_per_degree(40, 60), 0.1)
    assert np.abs(seen(picture, 60, 0.1) - slow).max() < 1e-3


@pytest.mark.parametrize("acuity_cpd", [0.15, 0.3])
def test_it_agrees_with_padding_by_reflection(acuity_cpd):
    """Which mirrors about the last pixel rather than beyond it: half a pixel's difference, and only near the border."""
    smooth = filtered(np.random.default_rng(1).uniform(0, FULL_SCALE, (64, 64)), 0, "wrap", 1.0, 0.1)
    scale = pixels_per_degree(64, 60)
    difference = np.abs(
        seen(smooth, 60, acuity_cpd)
        - filtered(smooth, int(np.ceil(4 * scale / acuity_cpd)), "reflect", scale, acuity_cpd)
    )
    assert difference[16:-16, 16:-16].max() < 0.004 * FULL_SCALE
    assert difference.max() < 0.06 * FULL_SCALE


def test_what_is_at_one_border_does_not_show_at_the_other():
    """As it would without padding: a picture that is black on the left and white on the right has grey borders then."""
    picture = np.tile(np.repeat([0.0, FULL_SCALE], 32), (64, 1))
    wrapped = filtered(picture, 0, "wrap", pixels_per_degree(64, 60), 0.1)
    assert np.abs(wrapped - picture)[:, [0, -1]].max() > 0.4 * FULL_SCALE
    assert np.abs(seen(picture, 60, 0.1) - picture)[:, [0, -1]].max() < 0.03 * FULL_SCALE


@pytest.mark.parametrize("size_px", SIZES_PX)
@pytest.mark.parametrize("cycles_per_px", [0.12, 0.2])
def test_an_edge_is_blurred_as_an_endless_one_would_be(size_px, cycles_per_px):
    """Against the closed form of its step response, in all of the picture, within .01 of full scale."""
    width, height = size_px
    x = np.arange(width) + 0.5 - width // 2
    limit = 2 * np.pi * cycles_per_px * x
    ideal = 0.5 + (sici(limit)[0] - (1 - np.cos(limit)) / limit) / np.pi
    acuity_cpd = cycles_per_px * pixels_per_degree(height, 60)
    blurred = seen(np.tile(x > 0, (height, 1)), 60, acuity_cpd)
    assert np.abs(blurred - ideal).max() < 0.01


def test_a_straight_edge_has_no_halo():
    """Across it, the kernel is Fejér's, which is nowhere negative."""
    blurred = seen(np.tile(np.repeat([0.0, FULL_SCALE], 64), (128, 1)), 60, 0.1)
    assert -0.001 < blurred.min() < blurred.max() < FULL_SCALE + 0.001


@given(st.integers(1, 40), st.integers(1, 40), st.floats(0.01, 60), st.integers(0, 2**32 - 1))
def test_the_mean_of_every_colour_is_kept_and_nothing_gains_contrast(width, height, acuity_cpd, seed):
    pictures = np.random.default_rng(seed).uniform(0, FULL_SCALE, (2, height, width, 3)).astype(np.float32)
    blurred = blur(pictures, contrast_gain(width, height, 60, acuity_cpd))
    assert blurred.dtype == np.float32
    assert blurred.mean(axis=(1, 2)) == pytest.approx(pictures.mean(axis=(1, 2)), abs=0.01)
    assert (blurred.std(axis=(1, 2)) <= pictures.std(axis=(1, 2)) + 0.01).all()


def test_every_eye_and_colour_is_blurred_by_itself():
    pictures = np.random.default_rng(3).uniform(0, FULL_SCALE, (2, 24, 32, 3)).astype(np.float32)
    gain = contrast_gain(32, 24, 60, 0.2)
    alone = [[blur(pictures[eye, :, :, colour, None], gain)[..., 0] for colour in range(3)] for eye in range(2)]
    assert np.allclose(blur(pictures, gain), np.moveaxis(alone, 1, -1), atol=1e-3)


def test_pictures_are_not_changed():
    picture = np.random.default_rng(4).uniform(0, FULL_SCALE, (8, 8, 3)).astype(np.float32)
    before = picture.copy()
    blur(picture, contrast_gain(8, 8, 60, 0.1))
    assert np.array_equal(picture, before)


def test_older_eyes_see_finer():
    picture = np.random.default_rng(5).uniform(0, FULL_SCALE, (32, 32))
    contrasts = [seen(picture, 60, acuity_cpd).std() for acuity_cpd in (0.05, 0.1, 0.3, 1, 10, 60)]
    assert contrasts == sorted(contrasts)
    assert contrasts[-1] == pytest.approx(picture.std(), rel=0.02)


def test_the_gain_is_worked_out_once():
    assert contrast_gain(64, 48, 60.0, 3.0) is contrast_gain(64, 48, 60.0, 3.0)
    assert not contrast_gain(64, 48, 60.0, 3.0).flags.writeable


def test_mimo3s_law_leaves_a_hundredth_at_the_limit_and_far_less_before_it_than_equation_2():
    """At 6 months and 1 cycle per degree it leaves .07, where the paper's equation leaves .82."""
    frequencies_cpd = np.array([0, 0.05, 0.1, 1, 5.64, 30])
    assert CONTRAST_LAWS["mimo3"](frequencies_cpd, 5.64) == pytest.approx([1, 1, 0.99, 0.072, 0.01, 0.01], abs=5e-4)
    assert CONTRAST_LAWS["linear"](frequencies_cpd, 5.64) == pytest.approx([1, 0.991, 0.982, 0.823, 0, 0], abs=5e-4)
    assert (contrast_gain(8, 8, 60, 0.02, "mimo3") <= 1).all()
