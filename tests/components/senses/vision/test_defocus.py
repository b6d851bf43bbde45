"""Defocus: blur by distance, as geometry has it."""

import mujoco
import numpy as np
import pytest

from mimoc.components.senses.vision.defocus import Lens, defocus, disc_gain
from mimoc.components.senses.vision.eyes import Eyes
from mimoc.components.senses.vision.foveation import pixels_per_degree

SIZE_PX = 96
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
    eyes = Eyes(model, ("eye",), SIZE_PX, SIZE_PX)
    view = eyes.view(data)
    assert view.distances_m[0, SIZE_PX // 2, SIZE_PX // 2] == pytest.approx(0.25, rel=1e-3)
    assert view.distances_m[0, 5] == pytest.approx(np.full(SIZE_PX, 2.0), rel=1e-3)
    assert np.array_equal(view.drawn, eyes(data))
    eyes.close()


@pytest.mark.parametrize(("distance_m", "disc_deg"), [(0.25, 0), (0.5, 0.258), (1e3, 0.773), (0.125, 0.773), (0.2, 0)])
def test_the_disc_is_that_of_a_lens_focused_at_25_cm(distance_m, disc_deg):
    """.057 x (|1 / d - 4| - 1) x 4.5 degrees, and none within the depth of focus."""
    assert NEWBORN.disc_deg(distance_m) == pytest.approx(disc_deg, abs=0.003)


def test_what_is_in_focus_stays_and_what_is_not_is_blurred_by_its_own_disc():
    """A grating keeps 2 J1(x) / x of its contrast, interpolated between a few discs: within .1."""
    fovy_deg, cycles = 25.0, 8
    wave = np.cos(2 * np.pi * cycles * (np.arange(SIZE_PX) + 0.5) / SIZE_PX)
    frequency_cpd = cycles / SIZE_PX * pixels_per_degree(SIZE_PX, fovy_deg)
    shown = np.broadcast_to((128 + 100 * wave)[None, :, None, None], (1, SIZE_PX, SIZE_PX, 3)).astype(np.float32)
    for distance_m in (0.25, 0.4, 0.6, 3.0, 0.14):
        seen = defocus(shown, np.full(shown.shape[:3], distance_m, np.float32), NEWBORN, fovy_deg)
        left = float((seen[0, :, 0, 0] - 128) @ wave / (100 * (wave @ wave)))
        x = np.pi * float(NEWBORN.disc_deg(distance_m)) * frequency_cpd
        exact = 1 - x**2 / 8 + x**4 / 192 - x**6 / 9216
        assert left == pytest.approx(exact, abs=0.1)
        if distance_m == 0.25:
            assert seen == pytest.approx(shown, abs=1e-3)


def test_a_border_in_depth_leaves_the_sharp_side_sharp():
    shown = np.random.default_rng(0).uniform(0, 255, (1, SIZE_PX, SIZE_PX, 3)).astype(np.float32)
    distances_m = np.full((1, SIZE_PX, SIZE_PX), 0.25, np.float32)
    distances_m[:, :, SIZE_PX // 2 :] = 5.0
    seen = defocus(shown, distances_m, NEWBORN, 15.0)
    assert seen[:, :, : SIZE_PX // 2] == pytest.approx(shown[:, :, : SIZE_PX // 2], abs=1e-3)
    assert seen[:, :, SIZE_PX // 2 :].std() < 0.5 * shown.std()


def test_a_lens_that_follows_distance_blurs_nothing():
    shown = np.ones((1, 8, 8, 3), np.float32)
    assert defocus(shown, np.full((1, 8, 8), 3.0, np.float32), Lens(0.0, 0.5), 60.0) is shown
    assert not disc_gain(8, 8, 60.0, 1.0).flags.writeable
