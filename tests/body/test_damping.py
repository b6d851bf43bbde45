"""Joints whose motors are extraordinarily strong are harder to swing, all others are MIMo's."""

import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_average, grow_body
from mimoc.schema import InfantSpec

AGES_MONTHS = (0, 4.5, 9, 18, 24)
LARGE_HAND = {"left_hand": {"length": 1.87, "girth": 1.99}}
STRONG = (
    {"parts": LARGE_HAND},
    {"parts": {"head": {"girth": 1.5}, "right_foot": {"length": 2.0, "girth": 2.0}}},
    {"individual": {"sex": "male", "length_percentile": 99, "weight_percentile": 99}},
    {"actuation": {"strength": {"arms": 10, "legs": 0.1}}},
    {"actuation": {"strength_age_months": 24}},
)
"""Keys of specs that make some motor stronger than usual."""


@pytest.fixture(params=["mitten", "five_finger"])
def hands(request):
    return request.param


def child(age_months, hands, actuation=None, development="published", **body):
    keys = {"actuation": actuation or {}, "body": {"hands": hands, **body}, "development": development}
    spec = InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": age_months, **keys})
    return grow_body(spec).tree


def published(age_months, hands):
    return grow_average(age_months, assemble(hands, False, "published"))


def mimos_gears_nm(hands):
    """Return the torques of MIMo's motors by joint."""
    motors = assemble(hands, False, "published").motors
    return {figures.joint.format(side=side): figures.gear_nm for side, figures in motors}


def passive(tree):
    """Return damping and armature by joint."""
    return {name: (joint.damping_nms_per_rad, joint.armature_kgm2) for name, joint in tree.joints.items()}


@pytest.mark.parametrize("age_months", AGES_MONTHS)
def test_the_average_child_has_mimos_joints(age_months, hands):
    assert passive(child(age_months, hands)) == passive(published(18, hands))


@pytest.mark.parametrize("age_months", AGES_MONTHS)
@pytest.mark.parametrize("keys", STRONG, ids=str)
def test_no_torque_is_larger_for_damping_and_armature_than_an_average_childs(age_months, hands, keys):
    """Than of its age, or than MIMo's; and no joint is easier to swing than MIMo's."""
    tree, average, mimos_nm = child(age_months, hands, **keys), published(age_months, hands), mimos_gears_nm(hands)
    usual = passive(average)
    ordinary_nm = {motor.joint: max(motor.gear_nm, mimos_nm[motor.joint]) for motor in average.motors}
    gears_nm = {motor.joint: motor.gear_nm for motor in tree.motors}
    for joint, values in passive(tree).items():
        factor = max(1.0, gears_nm.get(joint, 0.0) / ordinary_nm.get(joint, 1.0))
        assert values == pytest.approx([factor * value for value in usual[joint]], rel=1e-12), joint


def test_fingers_of_a_large_palm_are_harder_to_swing(hands):
    """The palm's volume moves a mitten's fingers, and a wrist."""
    usual, large = child(18, hands), passive(child(18, hands, parts=LARGE_HAND))
    mimos, mimos_nm = passive(usual), mimos_gears_nm(hands)
    joint = "robot:left_fingers" if hands == "mitten" else "robot:left_hand1"
    usual_nm = next(motor.gear_nm for motor in usual.motors if motor.joint == joint)
    ratio = 1.87 * 1.99**2 * usual_nm / max(usual_nm, mimos_nm[joint])
    assert large[joint] == pytest.approx([ratio * value for value in mimos[joint]])
    assert large["robot:right_hand1"] == mimos["robot:right_hand1"]


@pytest.mark.parametrize("age_months", AGES_MONTHS)
@pytest.mark.parametrize("keys", STRONG, ids=str)
def test_joints_that_mature_are_not_outrun_by_strong_motors_either(age_months, hands, keys):
    """Torque by damping and by armature is at most MIMo's, or the average child's of that age if that is more."""
    tree, average = (child(age_months, hands, development="maturing", **more) for more in (keys, {}))
    mimos, mimos_nm = published(18, hands), mimos_gears_nm(hands)
    for motor, usual in zip(tree.motors, average.motors, strict=True):
        for mine, here, there in zip(*(passive(each)[motor.joint] for each in (tree, average, mimos)), strict=True):
            allowed = max(usual.gear_nm / here, mimos_nm[motor.joint] / there)
            assert motor.gear_nm / mine <= allowed * (1 + 1e-9), motor.name
            assert mine >= here * (1 - 1e-9), motor.name
