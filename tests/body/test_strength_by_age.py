"""Strength beyond what size explains, by group and age."""

import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.strength import STRENGTH

AGES_MONTHS = (0, 1, 2, 3, 4, 6, 9, 12, 15, 18, 24)
AXIAL = (0.24, 0.26, 0.31, 0.39, 0.49, 0.69, 0.90, 0.98, 1, 1, 1)
LEGS = (0.24, 0.24, 0.25, 0.27, 0.29, 0.34, 0.47, 0.62, 0.81, 1, 1)
TABLE = {
    "neck": AXIAL,
    "trunk": AXIAL,
    "arm": (0.12, 0.12, 0.13, 0.15, 0.17, 0.24, 0.38, 0.56, 0.77, 1, 1),
    "hand": (0.40, 0.42, 0.46, 0.50, 0.55, 0.64, 0.78, 0.88, 0.95, 1, 1),
    "hip": LEGS,
    "knee": LEGS,
    "ankle": LEGS,
    "eyes": (1,) * 11,
}
"""Read off when the four numbers were fitted, to two digits."""


@pytest.mark.parametrize("group", TABLE)
def test_each_group_follows_its_curve(group):
    assert [STRENGTH[group](age) for age in AGES_MONTHS] == pytest.approx(TABLE[group], abs=0.0101)


def test_the_table_names_every_group():
    assert set(TABLE) == set(STRENGTH)


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_every_joint_matures_with_a_group_that_has_a_curve(hands):
    anatomy = assemble(hands, True)
    groups = anatomy.groups
    assert set(groups) == {joint.name.format(side=side) for side, part in anatomy.parts for joint in part.joints}
    assert set(groups.values()) == set(STRENGTH)
    assert {groups[f"robot:left_{joint}"] for joint in ("foot1", "foot2", "foot3")} == {"ankle"}
    assert (groups["robot:left_hip1"], groups["robot:right_knee"], groups["robot:left_elbow"]) == ("hip", "knee", "arm")
    assert groups["robot:head_tilt"] == "neck"
    assert groups["robot:hip_bend2"] == groups["robot:chest_rot"] == "trunk"
