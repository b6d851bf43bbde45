"""Further measures: places, bursts, complexity of paths, the centroid of motion."""

import numpy as np
import pytest
from support.moving import moving, wave

from mimoc.base.quantities.movement_details import DETAILS, JOINTS
from mimoc.movement import measure_movement
from mimoc.movement.details import path_dimension

LIMBS = "left_hand", "right_hand", "left_foot", "right_foot"


def test_noise_is_more_complex_than_a_walk_and_a_walk_than_a_smooth_path():
    noise = np.random.default_rng(0).normal(size=(2000, 2))
    assert path_dimension(np.linspace((0, 1), (1, 3), 2000)) == pytest.approx(1)
    assert path_dimension(np.cumsum(noise, axis=0)) == pytest.approx(1.5, abs=0.05)
    assert path_dimension(noise) == pytest.approx(2, abs=0.05)


def test_limbs_that_start_and_stop_together_rest_together_more_than_by_chance():
    times_s = np.arange(990) / 30
    bursts = (np.sin(2 * np.pi * 0.2 * times_s) > 0)[:, None] * wave(2, 0.3)
    measures = measure_movement(moving(dict.fromkeys(LIMBS, bursts)))
    assert measures["limbs_still_share"] == pytest.approx(0.5, abs=0.15)
    assert measures["limbs_still_chance_share"] == pytest.approx(measures["limbs_still_share"] ** 4, rel=0.05)
    assert measures["limbs_moving_share"] > 3 * measures["limbs_moving_chance_share"]


def test_pauses_and_movements_last_as_long_as_they_do():
    """Both hands move up for a second at .8 trunk/s, rest for two, move down for a second, rest for two."""
    height = np.interp(np.arange(990) / 30 % 6, [0, 1, 3, 4, 6], [0, 0.8, 0.8, 0, 0])
    path = np.stack([np.zeros(990), -height], axis=-1)
    measures = measure_movement(moving({"left_hand": path, "right_hand": path}))
    assert measures["hand_moving_mean_s"] == pytest.approx(1, abs=0.1)
    assert measures["hand_still_mean_s"] == pytest.approx(2, abs=0.1)
    assert measures["hand_moving_share"] == pytest.approx(1 / 3, abs=0.03)


def test_the_centroid_of_one_moving_limb_is_that_limb():
    measures = measure_movement(moving({"left_hand": wave(1, 0.3)}))
    assert measures["centroid_spread_trunk"] == pytest.approx(measures["hand_spread_trunk"] * 2, rel=0.1)


def test_places_of_hands_and_feet():
    to_face = np.tile([-0.8, -0.8], (990, 1))
    measures = measure_movement(moving({"left_hand": to_face}))
    assert measures["hand_to_face_share"] == 1
    assert measures["hand_above_shoulder_share"] == 0.5
    assert measures["feet_apart_trunk"] == pytest.approx(0.6)
    assert measures["feet_touching_share"] == 0
    assert measures["leg_length_median_trunk"] == pytest.approx(np.hypot(0.1, 0.8))


def test_legs_that_kick_in_turn_are_not_together():
    both = measure_movement(moving({"left_foot": wave(0.5, 0.2), "right_foot": wave(0.5, 0.2)}))
    in_turn = measure_movement(moving({"left_foot": wave(0.5, 0.2), "right_foot": -wave(0.5, 0.2)}))
    assert (both["legs_together_r"], both["kicks_together_share"]) == (pytest.approx(1), 1)
    assert (in_turn["legs_together_r"], in_turn["kicks_together_share"]) == (pytest.approx(-1, abs=1e-4), 0)


def test_pictures_have_all_details_and_no_angles():
    measures = measure_movement(moving({limb: wave(1, 0.2) for limb in LIMBS}))
    missing = {quantity.name for quantity in DETAILS} - measures.keys()
    assert missing <= {"hand_still_mean_s", "hand_still_p90_s", "foot_still_mean_s", "foot_still_p90_s"}
    assert {quantity.name for quantity in JOINTS} & measures.keys() == set()
