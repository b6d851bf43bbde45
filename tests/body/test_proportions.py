import math
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from mimoc.anatomy.sections import CHEST, HIP, WAIST, stadium
from mimoc.anatomy.segments import REFERENCE_M, Proportions, proportions
from mimoc.base.errors import GeometryError
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
    """MIMo v2 made the trunk as high as the hips are broad; here it is only less deep if it is broader."""
    child = measure(age_months)
    broad = replace(child, table={**child.table, "hip_breadth": child.table["chest_breadth"]})
    assert proportions(broad, broad).trunk.axial == pytest.approx(proportions(child, child).trunk.axial, rel=0.02)


@given(girth_m=st.floats(0.2, 0.7), ratio=st.floats(2.2, 3.087))
def test_a_section_has_the_girth_and_the_breadth_asked_for(girth_m, ratio):
    radius_m, half_width_m = stadium("chest", girth_m, girth_m / ratio)
    straight_m = half_width_m - radius_m
    assert straight_m > 0
    assert 2 * math.pi * radius_m + 4 * straight_m == pytest.approx(girth_m)
    assert 2 * half_width_m == pytest.approx(girth_m / ratio)


@pytest.mark.parametrize("ratio", [1.9, 3.5])
def test_a_section_that_no_capsule_has_is_refused(ratio):
    with pytest.raises(GeometryError, match=r"a chest 0\.400 m around cannot be .* m broad, but 0\.1"):
        stadium("chest", 0.4, 0.4 / ratio)


@given(age_months=ages_months)
def test_sections_keep_their_shape_as_they_grow_and_have_both_measures_nearly(age_months):
    """Breadths and girths come from different children, so their ratio scatters; the waist is below the chest."""
    child, trunk = measure(age_months), average(age_months).trunk
    for (radius_m, half_width_m), ratio, girth, breadth_m in (
        (trunk.ribs, CHEST, "chest_circumference", child["chest_breadth"]),
        (trunk.waist, WAIST, "waist_circumference", 0.93 * child["hip_breadth"]),
        (trunk.pelvis, HIP, "hip_circumference", child["hip_breadth"]),
    ):
        girth_m = 2 * math.pi * radius_m + 4 * (half_width_m - radius_m)
        assert girth_m / (2 * half_width_m) == pytest.approx(ratio)
        assert girth_m == pytest.approx(child[girth], rel=0.03)
        assert 2 * half_width_m == pytest.approx(breadth_m, rel=0.03)
    assert trunk.waist[0] < trunk.ribs[0]


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
