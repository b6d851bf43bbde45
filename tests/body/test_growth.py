"""The law of growth, measured on the compiled model at every quarter of a month from birth to two years."""

import math
from itertools import pairwise

import numpy as np
import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.base.units import m_to_cm
from mimoc.body.grow import grow_average, grow_tree
from mimoc.body.kinematics import stature
from mimoc.fits import load_tables, measure

UP, FORWARD, LEFT = np.eye(3)[[2, 0, 1]]
BOTH = ("left", "right")

GIRTHS = {
    "upper_arm_circumference": "{}_uarm1",
    "forearm_circumference": "{}_larm",
    "mid_thigh_circumference": "{}_upper_leg1",
    "calf_circumference": "{}_lower_leg1",
    "ankle_circumference": "{}_lower_leg2",
}


def level_perimeter(infant, geom: str) -> float:
    """Return the length of a tape around an ellipsoid, as a polygon's with so many corners that it is exact."""
    angles = np.linspace(0, 2 * np.pi, 100_001)
    corners = infant.model.geom(geom).size[:2] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum())


def length(span: tuple[float, float]) -> float:
    return span[1] - span[0]


def everything(infant) -> list[str]:
    return infant.geoms(*(infant.model.body(index).name for index in range(1, infant.model.nbody)))


def test_heights_are_crown_sole_and_crown_rump_length(infants):
    for infant in infants:
        child = measure(infant.age_months)
        height_m, sitting_m = (length(infant.span_m(UP, geoms)) for geoms in (everything(infant), ["head", "lb"]))
        assert height_m == pytest.approx(child["crown_sole_length"], abs=0.002), infant
        assert sitting_m == pytest.approx(child["crown_rump_length"], abs=0.005), infant


def test_the_crown_is_the_head_and_the_sole_the_foot(infants):
    for infant in infants:
        low_m, high_m = infant.span_m(UP, everything(infant))
        assert infant.span_m(UP, infant.geoms("head"))[1] == high_m
        for side in BOTH:
            assert infant.span_m(UP, infant.limb(f"{side}_foot"))[0] == pytest.approx(low_m, abs=1e-8)


def test_heads_are_as_round_long_and_broad_as_measured(infants):
    """Length and breadth but for the factor that gives them their circumference, measured for other children."""
    for infant in infants:
        child = measure(infant.age_months)
        assert level_perimeter(infant, "head") == pytest.approx(child["head_circumference"], rel=1e-8)
        assert length(infant.span_m(FORWARD, ["head"])) == pytest.approx(child["head_length"], rel=0.04), infant
        assert length(infant.span_m(LEFT, ["head"])) == pytest.approx(child["head_breadth"], rel=0.04), infant


@pytest.mark.parametrize("measurement", GIRTHS)
def test_limbs_are_as_thick_as_measured(infants, measurement):
    for infant in infants:
        for side in BOTH:
            found_m = 2 * math.pi * infant.model.geom(GIRTHS[measurement].format(side)).size[0]
            assert found_m == pytest.approx(measure(infant.age_months)[measurement], rel=0.02), infant


@pytest.mark.parametrize("side", BOTH)
def test_feet_are_as_long_and_broad_as_measured(infants, side):
    for infant in infants:
        child, foot = measure(infant.age_months), infant.limb(f"{side}_foot")
        assert length(infant.span_m(FORWARD, foot)) == pytest.approx(child["foot_length"], rel=0.02), infant
        assert length(infant.span_m(LEFT, foot)) == pytest.approx(child["foot_breadth"], rel=0.02), infant


@pytest.mark.parametrize("side", BOTH)
def test_hands_are_as_long_and_broad_as_measured(infants, side):
    for infant in infants:
        child, forearm = measure(infant.age_months), infant.data.body(f"{side}_lower_arm")
        across, _, along = forearm.xmat.reshape(3, 3).T
        wrist_m = infant.data.joint(f"robot:{side}_hand3").xanchor @ along
        _, tip_m = infant.span_m(along, infant.limb(f"{side}_hand"))
        assert tip_m - wrist_m == pytest.approx(child["hand_length"], rel=0.02), infant
        breadth_m = length(infant.span_m(across, knuckles(infant, side)))
        assert breadth_m == pytest.approx(child["hand_breadth"], rel=0.02), infant


def knuckles(infant, side: str) -> list[str]:
    """Return the geoms that make a hand as broad as it is, the thumb's not among them."""
    if infant.hands == "mitten":
        return infant.geoms(f"{side}_fingers")
    return infant.geoms(f"{side}_hand", f"{side}_lfmetacarpal")


FINGERS = {"middle_finger_diameter": "mfknuckle", "thumb_diameter": "thbase"}


@pytest.mark.parametrize("measurement", FINGERS)
def test_fingers_are_as_thick_as_measured(infants, measurement):
    for infant in infants:
        if infant.hands == "five_finger":
            diameter_m = 2 * infant.model.geom(f"left_{FINGERS[measurement]}1").size[0]
            assert diameter_m == pytest.approx(measure(infant.age_months)[measurement], rel=1e-7), infant


def test_shoulder_joints_are_as_far_apart_as_mimos(infants):
    """In proportion to the breadth over the deltoids: 18.8 of 21.7 cm at 18 months."""
    for infant in infants:
        left, right = (infant.data.joint(f"robot:{side}_shoulder_ad_ab").xanchor for side in BOTH)
        wanted_m = 0.866 * measure(infant.age_months)["shoulder_breadth"]
        assert np.linalg.norm(left - right) == pytest.approx(wanted_m, rel=1e-6), infant


GRASP = (  # What motors that close a hand have in their names.
    "_fingers",
    *(f"{finger}_{joint}" for finger in ("ff", "mf", "rf", "lf") for joint in ("knuckle", "middle", "distal")),
)


def test_the_older_the_longer_and_heavier(infants):
    for younger, older in pairwise(infants):
        segments = [np.linalg.norm(infant.model.body_pos[2:], axis=1) for infant in (younger, older)]
        assert np.all(segments[0] <= segments[1]), older
        assert np.all(younger.model.body_mass <= older.model.body_mass), older
        actuators = [older.model.actuator(index).name for index in range(older.model.nu)]
        grasp = np.array([any(part in name for part in GRASP) for name in actuators])
        weaker = younger.model.actuator_gear[:, 0] >= older.model.actuator_gear[:, 0]
        assert not np.any(weaker & ~grasp), older


def test_the_older_the_larger(infants):
    """Every geom, measured along its own axes, caps included; but newborns' feet are high for their length."""
    for younger, older in pairwise(infants):
        model = younger.model
        names = [model.geom(index).name for index in range(model.ngeom)]
        feet = np.array([any(part in name for part in ("foot", "toe")) for name in names])
        least = np.where(feet[:, None] & (older.age_months <= 1.5), 0.97, 1 - 1e-9)
        assert np.all(least * model.geom_aabb[:, 3:] <= older.model.geom_aabb[:, 3:]), older


def test_published_masses_and_gears_follow_the_volume_by_the_papers_growth_law():
    """A head's is the cube of its circumference."""
    mitten = assemble("mitten", False, "published")
    newborn, reference = (grow_average(age, mitten) for age in (0, 18))
    heads_m = [measure(age, "published")["head_circumference"] for age in (0, 18)]
    share = (heads_m[0] / heads_m[1]) ** 3
    assert newborn.geoms["head"].mass_kg == pytest.approx(reference.geoms["head"].mass_kg * share, rel=1e-12)
    gears = [
        next(motor.gear_nm for motor in tree.motors if motor.name == "act:head_tilt") for tree in (newborn, reference)
    ]
    assert gears[0] == pytest.approx(gears[1] * share, rel=1e-12)


def test_hinges_turn_about_the_same_axes_at_every_age(infants):
    for infant in infants:
        for name in ("jnt_axis", "tendon_range"):
            assert np.array_equal(getattr(infant.model, name), getattr(infants[0].model, name)), name


def test_a_body_measures_what_its_measurements_say(infants):
    """As WHO would measure the compiled model: crown to sole, mass, head, left arm."""
    for infant in infants:
        child = measure(infant.age_months)
        found = stature(grow_tree(child, assemble(infant.hands, False)))
        assert found.keys() == load_tables().who.keys()
        assert found["length_cm"] == pytest.approx(m_to_cm(child["crown_sole_length"]), abs=0.2)
        assert found["weight_kg"] == pytest.approx(infant.model.body("hip").subtreemass[0], rel=1e-8)
        assert found["head_circumference_cm"] == pytest.approx(m_to_cm(child["head_circumference"]))
        assert found["arm_circumference_cm"] == pytest.approx(m_to_cm(child["upper_arm_circumference"]))
