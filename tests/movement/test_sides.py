"""What is measured of each side."""

import numpy as np
import pytest
from support.moving import placed, restless

from mimoc.base.quantities.movement import CORE
from mimoc.cli.tables import print_movement_measures
from mimoc.movement import measure_movement
from mimoc.movement.filming import Filmed
from mimoc.movement.measured import OF_NO_SIDE, measure_sides
from mimoc.movement.report import measure_all

RECORDING = restless(0, 12.0)
SWAP = {"left": "right", "right": "left"}


def still_right_arm():
    """Return the recording with a right hand and elbow that rest where they are on average."""
    positions = np.array(RECORDING.positions)
    for name in ("right_hand", "right_elbow"):
        column = RECORDING.names.index(name)
        hip = RECORDING.names.index("right_hip")
        positions[:, column] = positions[:, hip] + np.mean(positions[:, column] - positions[:, hip], axis=0)
    return placed(RECORDING, positions)


def test_means_over_sides_are_those_of_the_sides():
    both, sides = measure_movement(RECORDING), measure_sides(RECORDING)
    for name in ("hand_units_per_min", "foot_spread_trunk", "kicks_per_min", "hand_moving_share", "hand_burstiness"):
        assert both[name] == pytest.approx((sides["left"][name] + sides["right"][name]) / 2), name


def test_what_is_about_both_sides_has_none():
    named = measure_sides(RECORDING)["left"].keys()
    assert not [name for name in named if name.startswith(OF_NO_SIDE)]
    assert {item.name for item in CORE} - named == {"hands_together_r", "feet_together_r", "dimensions"}


def test_in_a_mirror_the_sides_are_exchanged():
    names = [name.partition("_") for name in RECORDING.names]
    mirrored = tuple(f"{SWAP[side]}_{part}" if side in SWAP else side for side, _, part in names)
    image = measure_sides(placed(RECORDING, RECORDING.positions * (-1, 1), mirrored))
    for side, values in measure_sides(RECORDING).items():
        assert image[SWAP[side]] == pytest.approx(values, rel=1e-6, abs=1e-6)


def test_a_still_arm_is_seen_on_its_side_and_its_columns_are_shown(capsys):
    alike, still = (measure_all([Filmed(recording)]) for recording in (RECORDING, still_right_arm()))
    left, right = (still.side_means[side]["hand_speed_median_trunk_s"] for side in ("left", "right"))
    assert left > 5 * right
    assert (alike.sides_differ, still.sides_differ) == (False, True)
    assert still.to_data()["measures"]["hand_units_per_min"]["right"]["mean"] == 0.0
    print_movement_measures(alike, full=False)
    assert "right" not in capsys.readouterr().out.splitlines()[2]
    print_movement_measures(still, full=False)
    assert [word for word in capsys.readouterr().out.splitlines()[2].split() if word in SWAP] == ["left", "right"]
