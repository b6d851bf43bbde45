"""Where the camera of a picture stands, several infants in their poses, transparent backgrounds and scale bars."""

import math
from typing import Any

import numpy as np
import pytest
from scipy import ndimage

from mimoc.render.portrait import Framing, lineup, portrait
from mimoc.render.scale_bar import COLOUR

SIZE = {"width": 160, "height": 120}
POSES = ("supine", "prone", "sitting", "standing")
ALONE = Framing(transparent=True)


def widths(picture):
    """Return the width and height of what is opaque in a picture."""
    rows, columns = (np.flatnonzero(np.any(picture[..., 3] > 128, axis=axis)) for axis in (1, 0))
    return np.ptp(columns) + 1, np.ptp(rows) + 1


@pytest.fixture(scope="module")
def posed(built):
    return {pose: built(scene={"pose": pose}) for pose in ("supine", "sitting")}


def test_infants_in_a_row_are_in_the_poses_of_their_specs(posed):
    """Four poses were byte-identical pictures."""
    supine, sitting = (posed[pose] for pose in ("supine", "sitting"))
    pictures = [lineup(pair, **SIZE) for pair in ((supine, supine), (supine, sitting), (sitting, sitting))]
    assert not np.array_equal(pictures[0], pictures[1])
    assert not np.array_equal(pictures[1], pictures[2])
    assert np.array_equal(lineup([supine] * 2, "sitting", **SIZE), pictures[2])


def test_each_pose_that_is_asked_for_is_another_picture(posed):
    pictures = {pose: lineup([posed["sitting"]] * 2, pose, **SIZE, framing=ALONE) for pose in POSES}
    assert len({picture.tobytes() for picture in pictures.values()}) == len(POSES)
    ratios = {pose: math.prod([height / width for width, height in [widths(pictures[pose])]]) for pose in POSES}
    assert ratios["standing"] == max(ratios.values())
    assert ratios["prone"] == min(ratios.values())


@pytest.mark.parametrize("draw", [portrait, lambda bundle, **how: lineup([bundle] * 2, **how)], ids=["one", "two"])
def test_azimuth_and_elevation_turn_the_camera(draw, posed):
    """From its left and its right, an infant is its own mirror image, about; from the front it is another."""
    front, left, right, above = (
        draw(posed["sitting"], **SIZE, framing=Framing(azimuth, elevation, 3.0, transparent=True))[..., 3] / 255
        for azimuth, elevation in ((0, 0), (90, 0), (-90, 0), (0, 80))
    )
    assert np.abs(left - right[:, ::-1]).mean() < 0.25 * np.abs(left - front).mean()
    assert np.abs(above - front).mean() > 0.01


def test_what_is_twice_as_far_is_half_as_large(posed):
    near, far = (
        portrait(posed["sitting"], **SIZE, framing=Framing(0, 0, distance_m, transparent=True))
        for distance_m in (3.0, 6.0)
    )
    assert np.divide(widths(near), widths(far)) == pytest.approx(2, rel=0.15)


def test_a_transparent_picture_shows_the_infant_alone(posed):
    """Its edges are smooth, and of its own colours."""
    usual, alone = (portrait(posed["sitting"], **SIZE, framing=framing) for framing in (Framing(), ALONE))
    assert alone.shape == (120, 160, 4)
    opacity = alone[..., 3]
    assert opacity[0, 0] == opacity[-1, -1] == 0
    assert 0.05 < (opacity == 255).mean() < 0.6
    assert ((opacity > 0) & (opacity < 255)).any()
    _, parts = ndimage.label(opacity > 0)
    assert parts == 1
    inside: Any = ndimage.binary_erosion(opacity == 255, iterations=2)
    assert np.abs(usual[inside].astype(int) - alone[inside, :3]).mean() < 8


@pytest.mark.parametrize("transparent", [False, True])
@pytest.mark.parametrize("draw", [portrait, lambda bundle, **how: lineup([bundle] * 2, **how)], ids=["one", "two"])
def test_a_scale_bar_is_as_long_as_it_says(draw, transparent, posed):
    """From 2 m, a camera with a field of view of 24 (10) degrees sees 2 * 2 tan(12) (tan 5) metres."""
    framing = Framing(0, 0, 2.0, transparent, scale_bar=True)
    picture = draw(posed["sitting"], width=640, height=480, framing=framing)
    dark = np.all(picture[..., :3] == COLOUR[:3], axis=2)
    longest = max(np.diff(np.flatnonzero(np.diff([0, *row, 0])))[::2].max(initial=0) for row in dark[400:].astype(int))
    fovy_deg, length_m = (24, 0.2) if draw is portrait else (10, 0.1)
    assert longest == pytest.approx(length_m * 480 / (4 * math.tan(math.radians(fovy_deg / 2))), abs=1)


def test_what_fills_a_picture_is_as_large_as_its_bar_says(posed):
    """An infant that stands is as high as its spec says, within what perspective takes."""
    bundle = posed["sitting"]
    framing = Framing(0, 0, transparent=True, scale_bar=False)
    plain, barred = (
        portrait(bundle, "standing", 320, 480, framing=each)
        for each in (framing, Framing(0, 0, transparent=True, scale_bar=True))
    )
    row = np.all(barred[..., :3] == COLOUR[:3], axis=2)[400:]
    bar_px = max(np.diff(np.flatnonzero(np.diff([0, *line.astype(int), 0])))[::2].max(initial=0) for line in row)
    height_cm = [widths(plain)[1] / bar_px * length for length in (1, 2, 5, 10, 20, 50)]
    assert min(abs(each / bundle.manifest.child.length_cm - 1) for each in height_cm) < 0.08
