import numpy as np
import pytest

from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.flicker import EDGE_DEG, fade, noticed_share
from mimoc.components.senses.vision.run import filters


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
