"""Head and gaze are measured in the frame of the shoulders, touches of the own body by hand and part."""

import numpy as np
import pytest

from mimoc.base.kinds import function_of
from mimoc.base.quantities import QUANTITIES
from mimoc.movement.head_and_gaze import gaze_midline_share, gaze_turning_deg_s, head_measures

TURN = np.array([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])  # How the whole infant lies in the world.


def placed(aside_deg):
    """Return the points of a face that is turned to the left by some angles, shape (t,), on shoulders that rest."""
    aside = np.radians(np.asarray(aside_deg, float))
    face = 0.05 * np.stack([np.cos(aside), np.sin(aside), 0 * aside], axis=-1) @ TURN.T
    fixed = {"left_ear": (0, 0.06, 0), "right_ear": (0, -0.06, 0), "left_shoulder": (0, 0.1, -0.1)}
    fixed["right_shoulder"] = (0, -0.1, -0.1)
    places = {name: np.tile(TURN @ np.array(place), (len(aside), 1)) for name, place in fixed.items()}
    return {**places, "nose": face}


def test_a_head_that_turns_is_measured_wherever_the_infant_lies():
    measures = head_measures(placed(np.linspace(-29.5, 29.5, 60)), rate_hz=10.0)
    assert measures["head_midline_share"] == pytest.approx(40 / 60)
    assert measures["head_aside_deg"] == pytest.approx(15.0)
    assert measures["head_turning_deg_s"] == pytest.approx(10.0)


def test_without_a_face_nothing_is_said():
    places = placed([0.0, 1.0])
    del places["nose"]
    assert head_measures(places, 10.0) == {}


def columns(aside_deg, rate_hz=10.0):
    places = placed(aside_deg)
    towards = places["nose"] / 0.05
    data = {f"gaze_direction_{axis}": towards[:, index] for index, axis in enumerate("xyz")}
    for side in ("left", "right"):
        data |= {f"{side}_shoulder_{axis}_m": places[f"{side}_shoulder"][:, at] for at, axis in enumerate("xyz")}
    return {**data, "time_s": np.arange(len(aside_deg)) / rate_hz}


def test_gaze_is_measured_by_the_line_of_sight():
    turning = columns(np.linspace(-29.5, 29.5, 60))
    assert gaze_midline_share(turning) == pytest.approx(40 / 60)
    assert gaze_turning_deg_s(turning) == pytest.approx(10.0)
    assert gaze_turning_deg_s(columns([5.0])) is None


def test_touches_of_the_own_body_are_counted_by_part():
    """A short gap does not end a contact, and parts of others are not the own body."""
    right = ["head", "", "head; upper_body", "", "", "", "ben_head", "floor", "head"]
    table = {"right_hand_touches": right, "left_hand_touches": [""] * 8 + ["chest"], "time_s": np.arange(9) / 10}
    expected = {"hands_to_head_per_min": 2, "hands_to_trunk_per_min": 2}
    for name, count in expected.items():
        assert function_of(QUANTITIES[name].compute, name)(table) == pytest.approx(count * 60 / 0.8)
    share = function_of(QUANTITIES["hands_self_touch_share"].compute, "hands_self_touch_share")(table)
    assert share == pytest.approx(3 / 9)
