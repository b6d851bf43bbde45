"""Strength by group, and of another age: pure functions of the spec."""

import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_body, grow_tree
from mimoc.body.strength import STRENGTH, STRENGTH_AGE_KEY, STRENGTH_KEY
from mimoc.fits import measure
from mimoc.schema import InfantSpec
from mimoc.schema.names import PAIRED_GROUPS, STRENGTH_GROUPS

GROUPS = [group for group in STRENGTH_GROUPS if group not in PAIRED_GROUPS]


def child(actuation, age_months=9, **body):
    spec = InfantSpec.model_validate(
        {"mimoc": 1, "name": "x", "age_months": age_months, "body": body, "actuation": actuation}
    )
    return grow_body(spec).tree


def gears_nm(tree):
    return {motor.name: motor.gear_nm for motor in tree.motors}


def factors(actuation, **body):
    plain = gears_nm(child({}, **body))
    return {name: gear_nm / plain[name] for name, gear_nm in gears_nm(child(actuation, **body)).items()}


@pytest.fixture(params=["mitten", "five_finger"])
def body(request):
    return {"hands": request.param, "chest_joint": True}


def test_the_groups_are_those_of_the_language_and_share_out_all_muscles(body):
    tree = child({}, **body)
    groups = tree.muscle_groups
    assert {groups[motor.joint] for motor in tree.motors} == set(GROUPS)


@pytest.mark.parametrize(
    ("motor", "group"),
    [
        ("act:head_tilt", "neck"),
        ("act:hip_bend", "trunk"),
        ("act:chest_lean", "trunk"),
        ("act:left_eye_vertical", "eyes"),
        ("act:right_eye_torsional", "eyes"),
        ("act:left_shoulder_internal", "left_arm"),
        ("act:right_elbow", "right_arm"),
        ("act:left_wrist_ulnar", "left_hand"),
        ("act:right_hip_flex", "right_leg"),
        ("act:left_foot_rotation", "left_leg"),
        ("act:left_toes", "left_leg"),
    ],
)
def test_a_muscle_belongs_to(motor, group, body):
    stronger = factors({"strength": {group: 3}}, **body)
    assert stronger[motor] == pytest.approx(3)


def test_fingers_belong_to_the_hand():
    assert factors({"strength": {"left_hand": 2}})["act:left_fingers"] == pytest.approx(2)
    assert factors({"strength": {"hands": 2}}, hands="five_finger")["act:right_lf_meta"] == pytest.approx(2)


@pytest.mark.parametrize("group", GROUPS)
def test_a_factor_strengthens_its_group_and_nothing_else(group, body):
    tree = child({}, **body)
    groups = {motor.name: tree.muscle_groups[motor.joint] for motor in tree.motors}
    for name, factor in factors({"strength": {group: 0.5}}, **body).items():
        assert factor == pytest.approx(0.5 if groups[name] == group else 1), name


@pytest.mark.parametrize(("pair", "sides"), PAIRED_GROUPS.items())
def test_a_pair_means_both_sides_but_a_named_side_wins(pair, sides):
    left, right = sides
    both = {left: 1.5, right: 1.5}
    assert gears_nm(child({"strength": {pair: 1.5}})) == gears_nm(child({"strength": both}))
    for strength in ({pair: 1.5, left: 4}, {left: 4, pair: 1.5}):
        assert gears_nm(child({"strength": strength})) == gears_nm(child({"strength": {left: 4, right: 1.5}}))


def test_sides_mirror_each_other(body):
    left, right = factors({"strength": {"left_arm": 2}}, **body), factors({"strength": {"right_arm": 2}}, **body)
    swapped = {"left": "right", "right": "left"}
    for name, factor in left.items():
        side = next((side for side in swapped if side in name), "")
        assert right[name.replace(side, swapped.get(side, ""))] == pytest.approx(factor), name


def test_no_strength_at_all_is_none():
    motors = child({"strength": {"neck": 0}}).motors
    assert {motor.gear_nm for motor in motors if "head" in motor.name} == {0}


@pytest.mark.parametrize("age_months", [0, 6.5, 24])
def test_strength_and_force_ranges_of_another_age_are_those_of_the_average_child(age_months, body):
    there = grow_tree(measure(age_months), assemble(body["hands"], True))
    found = child({"strength_age_months": age_months}, **body)
    assert gears_nm(found) == pytest.approx(gears_nm(there))
    assert [motor.force_range for motor in found.motors] == [motor.force_range for motor in there.motors]


def test_the_strength_of_the_bodys_own_age_changes_nothing(body):
    assert set(factors({"strength_age_months": 9}, **body).values()) == {1}


def test_weakness_changes_nothing_but_gears(body):
    plain, weak = child({}, **body), child({"strength": {"legs": 0.5, "neck": 0.2}}, **body)
    assert (weak.bodies, weak.tendons) == (plain.bodies, plain.tendons)
    assert [motor.force_range for motor in weak.motors] == [motor.force_range for motor in plain.motors]


def test_age_groups_and_thicker_limbs_multiply():
    parts = {"left_lower_arm": {"girth": 1.1}}
    age, group = {"strength_age_months": 18}, {"strength": {"left_arm": 2}}
    elbow = "act:left_elbow"
    expected = factors(age)[elbow] * 2 * gears_nm(child({}, parts=parts))[elbow]
    assert gears_nm(child({**age, **group}, parts=parts))[elbow] == pytest.approx(expected)


def test_a_motor_says_which_keys_made_it_stronger():
    tree = child({"strength_age_months": 18, "strength": {"arms": 2, "left_arm": 3}})
    keys = {motor.name: [key for key, _ in motor.factors] for motor in tree.motors}
    assert keys["act:left_elbow"] == [f"{STRENGTH_KEY}.left_arm", STRENGTH_AGE_KEY]
    assert keys["act:right_elbow"] == [f"{STRENGTH_KEY}.arms", STRENGTH_AGE_KEY]
    assert keys["act:head_tilt"] == [STRENGTH_AGE_KEY]


def test_a_body_without_limbs_can_be_strong():
    tree = child({"strength_age_months": 18, "strength": {"arms": 2}}, remove=["left_upper_arm", "right_hand"])
    assert (
        gears_nm(tree)["act:right_elbow"]
        == gears_nm(child({"strength_age_months": 18, "strength": {"arms": 2}}))["act:right_elbow"]
    )


AGES_MONTHS = (0, 1, 2, 3, 4, 6, 9, 12, 15, 18, 24)
AXIAL = (0.24, 0.26, 0.31, 0.39, 0.49, 0.69, 0.90, 0.98, 1, 1, 1)
LEGS = (0.24, 0.24, 0.25, 0.27, 0.29, 0.34, 0.47, 0.62, 0.81, 1, 1)
TABLE = {  # Read off when the four numbers were fitted, to two digits.
    "neck": AXIAL,
    "trunk": AXIAL,
    "arm": (0.12, 0.12, 0.13, 0.15, 0.17, 0.24, 0.38, 0.56, 0.77, 1, 1),
    "hand": (0.40, 0.42, 0.46, 0.50, 0.55, 0.64, 0.78, 0.88, 0.95, 1, 1),
    "hip": LEGS,
    "knee": LEGS,
    "ankle": LEGS,
    "eyes": (1,) * 11,
}


@pytest.mark.parametrize("group", sorted({*TABLE, *STRENGTH}))
def test_each_group_follows_its_curve(group):
    assert [STRENGTH[group](age) for age in AGES_MONTHS] == pytest.approx(TABLE[group], abs=0.0101)


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


@pytest.fixture(scope="module")
def anatomy(hands_and_chest):
    return assemble(*hands_and_chest)


def test_each_motor_moves_a_hinge_of_its_own_and_grows_with_a_geom_that_exists(anatomy):
    hinges = {joint.name for _, part in anatomy.parts for joint in part.joints}
    for _, figures in anatomy.motors:
        assert figures.joint in hinges, figures.name
        assert figures.driven_geom in anatomy.geoms, figures.name
    joints = {figures.joint.format(side=side) for side, figures in anatomy.motors}
    assert len(joints) == len(anatomy.motors)


def test_a_gear_grows_with_its_mover_and_with_nothing_else(anatomy):
    """One part after another made thicker: between the square and the cube of it, less for parts that lie across."""
    before = grow_tree(measure(18), anatomy)
    for body in before.bodies:
        after = grow_tree(measure(18), anatomy, {body.name: (1.0, 1.1)})
        for motor, thicker in zip(before.motors, after.motors, strict=True):
            growth = thicker.gear_nm / motor.gear_nm
            if motor.driven_geom in {geom.name for geom in body.geoms}:
                assert 1.1**1.5 < growth < 1.1**3, (body.name, motor.name)
            else:
                assert growth == 1, (body.name, motor.name)


def test_force_ranges_do_not_grow(anatomy):
    young, old = grow_tree(measure(0), anatomy), grow_tree(measure(24), anatomy)
    assert [motor.force_range for motor in young.motors] == [motor.force_range for motor in old.motors]
