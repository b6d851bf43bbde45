import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.special import sici
from support.full import full_but

import mimoc
from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.eyes import Eyes
from mimoc.components.senses.vision.filters import (
    EDGE_DEG,
    Lens,
    Persistence,
    defocus,
    disc_gain,
    fade,
    limit_colours,
    limits_of,
    noticed_share,
)
from mimoc.components.senses.vision.foveation import CONTRAST_LAWS, blur, contrast_gain, pixels_per_degree
from mimoc.components.senses.vision.run import filters, perceive
from mimoc.components.senses.vision.thresholds import COSINES
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import NUMPY

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


@pytest.mark.parametrize("size_px", full_but([(96, 48)], SIZES_PX))
@pytest.mark.parametrize("fovy_deg", [20, 60])
@pytest.mark.parametrize("angle_deg", full_but([30], [0, 45, 90, 127]))
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


def test_the_gain_is_worked_out_once():
    assert contrast_gain(64, 48, 60.0, 3.0) is contrast_gain(64, 48, 60.0, 3.0)
    assert not contrast_gain(64, 48, 60.0, 3.0).flags.writeable


def test_mimo3s_law_leaves_a_hundredth_at_the_limit_and_far_less_before_it_than_equation_2():
    """At 6 months and 1 cycle per degree it leaves .07, where the paper's equation leaves .82."""
    frequencies_cpd = np.array([0, 0.05, 0.1, 1, 5.64, 30])
    assert CONTRAST_LAWS["mimo3"](frequencies_cpd, 5.64) == pytest.approx([1, 1, 0.99, 0.072, 0.01, 0.01], abs=5e-4)
    assert CONTRAST_LAWS["linear"](frequencies_cpd, 5.64) == pytest.approx([1, 0.991, 0.982, 0.823, 0, 0], abs=5e-4)
    assert (contrast_gain(8, 8, 60, 0.02, "mimo3") <= 1).all()


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
    return limit_colours(pictures, limits, COSINES)


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


@pytest.mark.parametrize("noticed_deg", [20.0, 28.0, 40.0])
def test_a_trial_gives_back_the_field(noticed_deg):
    """A light is seen up to the angle, half as bright 5° beyond it, and not at all from 10° on, to the pixel."""
    size_px, fovy_deg = 256, 120.0
    share = noticed_share(size_px, size_px, fovy_deg, noticed_deg)
    for beyond_deg, seen in ((-1, 1.0), (EDGE_DEG / 2, 0.5), (EDGE_DEG + 1, 0.0)):
        tangent = np.tan(np.radians(noticed_deg + beyond_deg))
        column = int(size_px / 2 + tangent * size_px / 2 / np.tan(np.radians(fovy_deg / 2)))
        assert share[size_px // 2, column] == pytest.approx(seen, abs=0.1)
        assert share[column, size_px // 2] == share[size_px // 2, column]


def test_beyond_the_field_pictures_are_the_mean_of_what_is_noticed():
    rng = np.random.default_rng(0)
    pictures = rng.uniform(0, 255, (2, 40, 60, 3)).astype(np.float32)
    share = noticed_share(60, 40, 100.0, 20.0)[..., None]
    seen = fade(pictures, share)
    weighted = (pictures * share).sum(axis=(1, 2)) / share.sum()
    assert seen[:, 0, 0] == pytest.approx(weighted, abs=0.1)
    assert seen[:, 20, 30] == pytest.approx(pictures[:, 20, 30])


def test_of_pixels_larger_than_the_field_those_at_the_line_of_sight_are_noticed():
    share = noticed_share(4, 4, 170.0, 1.0)
    assert share.tolist() == np.pad(np.ones((2, 2)), 1).tolist()
    assert np.isfinite(fade(np.ones((4, 4, 3), np.float32), share[..., None])).all()


def test_a_field_that_ends_beyond_the_picture_costs_nothing():
    entry = VisionEntry(
        cameras=("eye_left",), width_px=8, height_px=8, supersample=1, acuity_cpd=None, noticed_deg=60.0,
        foveation=0, foveation_radius="border", unseen=(),
    )  # fmt: skip
    assert filters(entry, 60.0) == ()
    assert len(filters(entry.model_copy(update={"noticed_deg": 25.0}), 60.0)) == 1


BLINKING = {"vision": {"width_px": 16, "height_px": 16, "flicker": "age", "contrast": "age", "focus": 1}}


def filter_at(flicker_hz: float):
    return stack_terms([Persistence(np.array([flicker_hz]))])


@pytest.mark.parametrize("steps", [[0.1], [0.01] * 10, [0.03, 0.005, 0.065]])
def test_a_step_is_seen_by_the_exponential_law_whatever_the_times_between_pictures(steps):
    persist, before = filter_at(2.0), np.full((1, 2, 4, 4, 3), 20, np.uint8)
    _, state = persist(NUMPY, np.inf, before, None)
    for elapsed_s in steps:
        seen, state = persist(NUMPY, elapsed_s, before + 200, state)
    assert state == pytest.approx(20 + 200 * (1 - np.exp(-2 * np.pi * 2.0 * 0.1)), abs=1e-3)
    assert seen.dtype == np.uint8
    assert (seen == np.rint(state)).all()


@pytest.mark.parametrize(("light_hz", "flicker_hz"), [(1, 2), (2, 2), (8, 2), (8, 15)])
def test_a_flickering_light_keeps_the_share_of_a_filter_of_first_order(light_hz, flicker_hz):
    """1 / sqrt(1 + (f / f0)²), within .02, at a thousand pictures a second."""
    persist, state, seen = filter_at(float(flicker_hz)), None, []
    times_s = np.arange(0, 4, 1e-3)
    for time_s in times_s:
        light = np.full((1, 1), 128 + 100 * np.sin(2 * np.pi * light_hz * time_s))
        _, state = persist(NUMPY, 1e-3 if state is not None else np.inf, light, state)
        seen.append(state.item())
    late = np.array(seen)[2000:]
    assert np.ptp(late) / 200 == pytest.approx((1 + (light_hz / flicker_hz) ** 2) ** -0.5, abs=0.02)


def made(age_months: float = 1.0):
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "senses": BLINKING, "delays": {"vision_ms": 20}}
    return mimoc.InfantSpec.model_validate({**spec, "scene": {"kind": "room", "pose": "sitting"}})


def commands(env, count: int):
    rng = np.random.default_rng(0)
    return [rng.uniform(-1, 1, env.action_space.shape).astype(np.float32) for _ in range(count)]


def test_it_is_part_of_the_state_and_begins_again_with_an_episode():
    env = mimoc.make(made())
    first, _ = env.reset(seed=0)
    before, after = commands(env, 8)[:4], commands(env, 8)[4:]
    for command in before:
        env.step(command)
    state = env.unwrapped.get_state()
    expected = [env.step(command)[0]["eye_left"] for command in after]
    env.unwrapped.set_state(state)
    assert all((env.step(command)[0]["eye_left"] == seen).all() for command, seen in zip(after, expected, strict=True))
    assert (env.reset(seed=0)[0]["eye_left"] == first["eye_left"]).all()
    env.close()


def test_it_goes_on_while_the_infant_grows_until_it_is_mature():
    env = mimoc.make(made())
    env.reset(seed=0)
    env.step(commands(env, 1)[0])
    kept = env.unwrapped.get_state()["signals"]["noise"]["vision"][1]
    env.unwrapped.grow(to=2.5)
    assert np.array_equal(env.unwrapped.get_state()["signals"]["noise"]["vision"][1], kept)
    assert env.unwrapped.senses["vision"].filter.flicker_hz == pytest.approx([3.5])
    env.close()


WIDE_PX = 96
WORLD = """
<mujoco>
  <visual><map znear="0.01"/></visual>
  <worldbody>
    <camera name="eye" pos="0 0 0" xyaxes="0 -1 0 0 0 1" fovy="60"/>
    <geom type="box" size=".005 .05 .05" pos=".255 0 0"/>
    <geom type="box" size=".1 3 3" pos="2.1 0 0"/>
    <light pos="0 0 1"/>
  </worldbody>
</mujoco>
"""
NEWBORN = Lens(1.0, 1.0)


def test_distances_are_those_along_the_line_of_sight():
    model = mujoco.MjModel.from_xml_string(WORLD)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    eyes = Eyes(model, ("eye",), WIDE_PX, WIDE_PX)
    view = eyes.view(data)
    assert view.distances_m[0, WIDE_PX // 2, WIDE_PX // 2] == pytest.approx(0.25, rel=1e-3)
    assert view.distances_m[0, 5] == pytest.approx(np.full(WIDE_PX, 2.0), rel=1e-3)
    assert np.array_equal(view.drawn, eyes(data))
    eyes.close()


@pytest.mark.parametrize(("distance_m", "disc_deg"), [(0.25, 0), (0.5, 0.258), (1e3, 0.773), (0.125, 0.773), (0.2, 0)])
def test_the_disc_is_that_of_a_lens_focused_at_25_cm(distance_m, disc_deg):
    """.057 x (|1 / d - 4| - 1) x 4.5 degrees, and none within the depth of focus."""
    assert NEWBORN.disc_deg(distance_m) == pytest.approx(disc_deg, abs=0.003)


def test_what_is_in_focus_stays_and_what_is_not_is_blurred_by_its_own_disc():
    """A grating keeps 2 J1(x) / x of its contrast, interpolated between a few discs: within .1."""
    fovy_deg, cycles = 25.0, 8
    wave = np.cos(2 * np.pi * cycles * (np.arange(WIDE_PX) + 0.5) / WIDE_PX)
    frequency_cpd = cycles / WIDE_PX * pixels_per_degree(WIDE_PX, fovy_deg)
    shown = np.broadcast_to((128 + 100 * wave)[None, :, None, None], (1, WIDE_PX, WIDE_PX, 3)).astype(np.float32)
    for distance_m in (0.25, 0.4, 0.6, 3.0, 0.14):
        seen = defocus(shown, np.full(shown.shape[:3], distance_m, np.float32), NEWBORN, fovy_deg)
        left = float((seen[0, :, 0, 0] - 128) @ wave / (100 * (wave @ wave)))
        x = np.pi * float(NEWBORN.disc_deg(distance_m)) * frequency_cpd
        exact = 1 - x**2 / 8 + x**4 / 192 - x**6 / 9216
        assert left == pytest.approx(exact, abs=0.1)
        if distance_m == 0.25:
            assert seen == pytest.approx(shown, abs=1e-3)


def test_a_border_in_depth_leaves_the_sharp_side_sharp():
    shown = np.random.default_rng(0).uniform(0, 255, (1, WIDE_PX, WIDE_PX, 3)).astype(np.float32)
    distances_m = np.full((1, WIDE_PX, WIDE_PX), 0.25, np.float32)
    distances_m[:, :, WIDE_PX // 2 :] = 5.0
    seen = defocus(shown, distances_m, NEWBORN, 15.0)
    assert seen[:, :, : WIDE_PX // 2] == pytest.approx(shown[:, :, : WIDE_PX // 2], abs=1e-3)
    assert seen[:, :, WIDE_PX // 2 :].std() < 0.5 * shown.std()


def test_a_lens_that_follows_distance_blurs_nothing():
    shown = np.ones((1, 8, 8, 3), np.float32)
    assert defocus(shown, np.full((1, 8, 8), 3.0, np.float32), Lens(0.0, 0.5), 60.0) is shown
    assert not disc_gain(8, 8, 60.0, 1.0).flags.writeable
