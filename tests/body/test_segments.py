"""How the parts of a body fit together, seen on the compiled model, and which bodies cannot be."""

import math
from dataclasses import replace
from itertools import product

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.anatomy.anatomy import assemble
from mimoc.anatomy.sections import CHEST, HIP, WAIST, stadium
from mimoc.anatomy.segments import REFERENCE_M, Proportions, proportions
from mimoc.base.errors import GeometryError
from mimoc.base.geometry.primitives import depths
from mimoc.body.grow import grow_tree
from mimoc.fits import Measurements, load_tables, measure

ON_SURFACE_M = 1e-8  # Nine digits are written.

GAP_M = 5e-4  # Half a millimetre shows on no child.

MIRROR = np.array([1, -1, 1])


MITTEN, FIVE_FINGER = (assemble(hands, False) for hands in ("mitten", "five_finger"))


def changed(child: Measurements, **values_m: float) -> Measurements:
    table = {name: replace(child.table[name], value_m=value) for name, value in values_m.items()}
    return replace(child, table={**child.table, **table})


def pairs(count: int, accessor) -> list[tuple[str, str]]:
    names = (accessor(index).name for index in range(count))
    return [(name, name.replace("left", "right")) for name in names if "left" in name]


def depth_m(infant, geom: str, point: np.ndarray) -> float:
    """Return how far a point is outside of a geom; negative inside."""
    size, kind = infant.model.geom(geom).size, infant.model.geom(geom).type[0]
    local = infant.data.geom(geom).xmat.reshape(3, 3).T @ (point - infant.data.geom(geom).xpos)
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        beyond = np.abs(local) - size
    elif kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        beyond = np.array([np.hypot(*local[:2]) - size[0], abs(local[2]) - size[1]])
    elif kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
        return -float(depths("ellipsoid", size, local[None])[0])
    else:
        axis_m = np.clip(local[2], -size[1], size[1])
        beyond = np.array([np.linalg.norm(local - (0, 0, axis_m)) - size[0]])
    return float(np.linalg.norm(np.maximum(beyond, 0)) + min(beyond.max(), 0))


def outside_m(infant, body: str, point: np.ndarray) -> float:
    """Return how far a point is outside of a body part."""
    return max(0.0, min(depth_m(infant, geom, point) for geom in infant.geoms(body)))


def segments(infant):
    """Yield each hinge with its point in the world and its two segments."""
    for index in range(1, infant.model.njnt):
        body = infant.model.body(infant.model.jnt_bodyid[index])
        parent = infant.model.body(body.parentid[0]).name
        yield infant.model.joint(index).name, infant.data.xanchor[index], body.name, parent


def farthest_allowed_m(infant, joint: str, of_parent: bool) -> float:
    """Return how far a joint may lie outside of one of its segments.

    The shoulder is beside the middle of the arm's round end, which touches the chest; the ankle is in the
    shank's end, half a foot's height above the foot; the neck moves with the head that rests on it; the little
    finger's metacarpal turns about a line within the palm, less than half its breadth away.
    """
    if "shoulder" in joint and of_parent:
        inwards_m = abs(infant.model.geom("left_uarm1").pos[1])
        return infant.model.geom("left_uarm1").size[0] + inwards_m + GAP_M
    if "lf_meta" in joint and not of_parent:
        return infant.model.geom("left_lfmetacarpal1").size[0]
    if "_foot" in joint and not of_parent:
        return 0.5 * infant.model.geom("left_foot2").size[2] + ON_SURFACE_M
    if "head" in joint:
        above_m = infant.model.joint(joint).pos[2]
        return above_m + infant.model.geom("neck").size[:2].sum() if of_parent else 0.001
    return ON_SURFACE_M


def test_joints_sit_where_their_segments_meet(infants):
    """Inside or on one of the two, and inside, on or right beside the other."""
    for infant in infants:
        for joint, anchor, child, parent in segments(infant):
            outside = outside_m(infant, child, anchor), outside_m(infant, parent, anchor)
            assert min(outside) <= ON_SURFACE_M, (joint, infant)
            assert outside[0] <= farthest_allowed_m(infant, joint, of_parent=False), (joint, infant)
            assert outside[1] <= farthest_allowed_m(infant, joint, of_parent=True), (joint, infant)


ON_THE_WAY = {"head": "chest"}
"""What is between a part and its parent: the shoulders are a body of their own, and the neck turns with the head."""


def test_segments_that_share_a_joint_touch(infants):
    for infant in infants:
        model, data = infant.model, infant.data
        for _, _, child, parent in segments(infant):
            both = [
                [model.geom(name).id for name in infant.geoms(body)] for body in (child, ON_THE_WAY.get(child, parent))
            ]
            gap_m = min(mujoco.mj_geomDistance(model, data, a, b, 1, np.zeros(6)) for a, b in product(*both))
            assert gap_m <= GAP_M, (child, infant)


def test_nothing_penetrates_at_rest(infants):
    """Standing straight, soles on the floor; MuJoCo itself passes over parent and child."""
    for infant in infants:
        contacts = infant.data.contact
        touching = {infant.model.geom(first).name for first, _ in contacts.geom}
        assert touching <= {"floor"}, infant
        assert np.all(contacts.dist >= -ON_SURFACE_M), infant


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_a_chest_that_moves_changes_nothing_else(infant_at, hands):
    """At rest everything is where it is without it; more parts may touch each other then, and none does."""
    for age_months in (0, 1, 6, 12, 18, 24):
        rigid, moving = infant_at(age_months, hands, False), infant_at(age_months, hands, True)
        assert moving.model.nv == rigid.model.nv + 2
        assert np.array_equal(moving.model.geom_size, rigid.model.geom_size)
        assert moving.data.geom_xpos == pytest.approx(rigid.data.geom_xpos, abs=1e-12)
        assert {moving.model.geom(first).name for first, _ in moving.data.contact.geom} <= {"floor"}


def test_left_is_the_mirror_image_of_right(infants):
    """To the last bit in what is written, and to rounding where MuJoCo turns angles into matrices."""
    for infant in infants:
        model, data = infant.model, infant.data
        for left, right in pairs(model.ngeom, model.geom):
            assert np.array_equal(model.geom(left).size, model.geom(right).size)
            assert data.geom(left).xpos == pytest.approx(data.geom(right).xpos * MIRROR, abs=1e-12), left
        for left, right in pairs(model.nbody, model.body):
            assert model.body(left).mass == model.body(right).mass
            assert data.body(left).xipos == pytest.approx(data.body(right).xipos * MIRROR, abs=1e-12), left
        for left, right in pairs(model.njnt, model.joint):
            assert np.array_equal(model.joint(left).range, model.joint(right).range)
            assert data.joint(left).xanchor == pytest.approx(data.joint(right).xanchor * MIRROR, abs=1e-12), left
            assert data.joint(left).xaxis == pytest.approx(-data.joint(right).xaxis * MIRROR, abs=1e-12), left


IMPOSSIBLE = {
    "crown_rump_length": (0.15, "no room for a trunk"),
    "crown_sole_length": (0.4, "no room for legs"),
    "mid_thigh_circumference": (1.2, "thigh: a limb 0.1.. m long cannot be 0.382 m thick"),
    "calf_circumference": (0.5, "a limb 0.1.. m long cannot be 0.159 m thick"),
    "middle_finger_diameter": (0.03, "a hand 0.0.. m long cannot have fingers 0.0300 m thick"),
    "hip_breadth": (0.06, "a hip 0.4.. m around cannot be 0.060 m broad, but 0.1.. to 0.2.. m"),
    "ankle_circumference": (0.9, "cannot have an ankle 0.286 m thick"),
    "hand_length": (0.015, "a hand 0.015 m long cannot be"),
    "foot_length": (0.02, "a foot 0.020 m long cannot be"),
}


@pytest.mark.parametrize("measurement", IMPOSSIBLE)
def test_impossible_bodies_are_refused_with_their_sizes(measurement):
    value_m, message = IMPOSSIBLE[measurement]
    with pytest.raises(GeometryError, match=message):
        grow_tree(changed(measure(9), **{measurement: value_m}), FIVE_FINGER if "finger" in measurement else MITTEN)


@given(
    age_months=st.floats(0, 24),
    factor=st.floats(0.93, 1.05),
    name=st.sampled_from(sorted(measure(0))),
    anatomy=st.sampled_from([MITTEN, FIVE_FINGER]),
)
def test_bodies_near_the_average_can_be_built(age_months, factor, name, anatomy):
    child = measure(age_months)
    tree = grow_tree(changed(child, **{name: child[name] * factor}), anatomy)
    assert 2 < tree.mass_kg < 16
    assert all(size > 0 for geom in tree.geoms.values() for size in geom.size_m)


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
