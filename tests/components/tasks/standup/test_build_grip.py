"""A hand closes around a bar without touching it, wherever an arm gets to."""

import numpy as np
import pytest

from mimoc.base.errors import UnsupportedTaskError
from mimoc.body.grow import grow_body
from mimoc.body.kinematics import frames
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.furniture import RAIL_RADIUS_M
from mimoc.components.tasks.standup.build_grip import CLEAR_M, arm_to_bar, curled, grip_point
from mimoc.schema import InfantSpec

SIDES = ("right", "left")
BODIES = [(age_months, hands) for age_months in (0, 9, 24) for hands in ("mitten", "five_finger")]


def grown(age_months: float, hands: str) -> BodyTree:
    keys = {"mimoc": 1, "name": "x", "age_months": age_months, "body": {"hands": hands}}
    return grow_body(InfantSpec.model_validate(keys)).tree


def before(tree: BodyTree, side: str, share: float) -> np.ndarray:
    """Return a place before a shoulder, so many lengths of the arm away, in the frame of the hip."""
    placed = frames(tree, {})
    shoulder, hand = placed[f"{side}_upper_arm"][0], placed[f"{side}_hand"][0]
    return shoulder + share * np.linalg.norm(hand - shoulder) * np.array([1.0, 0.0, 0.0])


def thumb_side(side: str) -> np.ndarray:
    return np.array([0.0, 1.0 if side == "right" else -1.0, 0.0])


@pytest.mark.parametrize("infant", BODIES, ids=str)
@pytest.mark.parametrize("share", [0.6, 0.8])
def test_an_arm_brings_the_hand_to_the_bar(infant, share):
    tree = grown(*infant)
    for side in SIDES:
        point_m, place_m = grip_point(tree, side, RAIL_RADIUS_M), before(tree, side, share)
        angles = arm_to_bar(tree, {}, side, point_m, place_m, thumb_side(side))
        origin, turn = frames(tree, angles)[f"{side}_hand"]
        assert origin + turn @ point_m == pytest.approx(place_m, abs=1e-4)
        assert turn[:, 0] == pytest.approx(thumb_side(side), abs=1e-3)
        for name, angle_rad in angles.items():
            low, high = np.deg2rad(tree.joints[name].range_deg)
            assert low - 1e-6 <= angle_rad <= high + 1e-6


@pytest.mark.parametrize("infant", BODIES, ids=str)
def test_both_arms_do_the_same(infant):
    tree = grown(*infant)
    right, left = (
        list(
            arm_to_bar(
                tree, {}, side, grip_point(tree, side, RAIL_RADIUS_M), before(tree, side, 0.7), thumb_side(side)
            ).values()
        )
        for side in SIDES
    )
    assert right == pytest.approx(left, abs=1e-5)


@pytest.mark.parametrize("infant", BODIES, ids=str)
def test_the_bar_is_clear_of_the_palm(infant):
    tree = grown(*infant)
    for side in SIDES:
        palm = tree.geoms[f"{side}_hand1"]
        away_m = abs(grip_point(tree, side, RAIL_RADIUS_M)[1] - palm.pos_m[1])
        assert away_m == pytest.approx(RAIL_RADIUS_M + palm.size_m[1] + CLEAR_M)
        assert curled(tree, side).keys() <= tree.joints.keys()


def test_a_bar_that_is_too_far_away_is_refused():
    tree = grown(9, "mitten")
    point_m, place_m = grip_point(tree, "right", RAIL_RADIUS_M), before(tree, "right", 1.5)
    with pytest.raises(UnsupportedTaskError, match="right hand does not reach"):
        arm_to_bar(tree, {}, "right", point_m, place_m, thumb_side("right"))
