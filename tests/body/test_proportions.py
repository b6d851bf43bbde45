import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimoc.body.proportions import REFERENCE_M, Proportions, proportions
from mimoc.errors import GeometryError
from mimoc.fits import load_tables, measure

ages_months = st.floats(0, 24)


def average(age_months: float) -> Proportions:
    return proportions(measure(age_months), measure(age_months))


def test_the_reference_child_is_the_16_to_19_months_group():
    """Rounded to millimetres; crown and breadths come straight from measurements and need no reference."""
    for name, value_m in REFERENCE_M.items():
        (group,) = [group for group in load_tables().anthrokids[name] if group.first_month == 16]
        assert value_m * 100 == pytest.approx(group.mean_cm, abs=0.051), name


@given(age_months=ages_months)
def test_girths_are_circumferences(age_months):
    child, p = measure(age_months), average(age_months)
    assert 2 * math.pi * p.head_radius_m == pytest.approx(child["head_circumference"])
    assert 2 * math.pi * p.upper_arm.radius_m == pytest.approx(child["upper_arm_circumference"])
    assert 2 * math.pi * p.ankle_radius_m == pytest.approx(child["ankle_circumference"])


@given(age_months=ages_months)
def test_trunk_height_follows_crown_rump_length_and_not_hip_breadth(age_months):
    """MIMo v2 made the trunk as high as the hips are broad."""
    child = measure(age_months)
    broad = replace(child, table={**child.table, "hip_breadth": child.table["chest_breadth"]})
    assert proportions(broad, broad).trunk.axial == proportions(child, child).trunk.axial


@given(age_months=ages_months)
def test_legs_share_what_is_left_of_the_height(age_months):
    child, p = measure(age_months), average(age_months)
    thigh_share = p.thigh.length_m / (p.thigh.length_m + p.shank.length_m)
    assert 0.35 < thigh_share < 0.5
    assert p.thigh.length_m + p.shank.length_m < child["crown_sole_length"] / 2


def test_a_trunk_without_room_is_refused():
    child = measure(9)
    squat = replace(child, table={**child.table, "crown_rump_length": child.table["hand_length"]})
    with pytest.raises(GeometryError, match="leaves no room for a trunk"):
        proportions(squat, squat)
