"""Joints whose motors are extraordinarily strong are harder to swing, all others are MIMo's."""

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_average, grow_body
from mimoc.body.joints import MAX_MARGIN_SHARE, TAU_S
from mimoc.bundle.model import load_model
from mimoc.compiler.explain import entries_of
from mimoc.schema import InfantSpec

AGES_MONTHS = (0, 4.5, 9, 18, 24)
LARGE_HAND = {"left_hand": {"length": 1.87, "girth": 1.99}}
STRONG = (  # Keys of specs that make some motor stronger than usual.
    {"parts": LARGE_HAND},
    {"parts": {"head": {"girth": 1.5}, "right_foot": {"length": 2.0, "girth": 2.0}}},
    {"individual": {"sex": "male", "length_percentile": 99, "weight_percentile": 99}},
    {"actuation": {"strength": {"arms": 10, "legs": 0.1}}},
    {"actuation": {"strength_age_months": 24}},
)


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
    motors = assemble(hands, False, "published").motors
    return {figures.joint.format(side=side): figures.gear_nm for side, figures in motors}


def passive(tree):
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


HINGE = mujoco.mjtJoint.mjJNT_HINGE


def infant(step_ms=5, law="maturing", hands="five_finger", age_months=6):
    control = {"timestep_ms": step_ms, "step_ms": 20}
    keys = {"control": control, "development": law, "body": {"hands": hands}, "scene": {"kind": "flat"}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": age_months, **keys}))
    return load_model(bundle)


def test_by_the_published_law_limits_are_mimos():
    model = infant(law="published")
    hinges = model.jnt_type == HINGE
    assert (model.jnt_solref[hinges] == (0.02, 1)).all()
    assert not model.jnt_margin.any()


@pytest.mark.parametrize("step_ms", full_but([5, 10], [1, 2, 20]))
def test_limits_of_maturing_joints_act_at_most_a_quarter_of_the_range_before_its_end(step_ms):
    model = infant(step_ms)
    hinges = model.jnt_type == HINGE
    assert (model.jnt_solref[hinges] == (TAU_S, 1)).all()
    assert (model.jnt_margin[hinges] <= MAX_MARGIN_SHARE * np.ptp(model.jnt_range[hinges], axis=1) + 1e-8).all()


def test_limits_of_faster_joints_act_earlier_whatever_the_physics_step():
    names = "left_knee", "right_elbow", "left_toes", "right_ff_knuckle", "left_lf_meta", "left_eye_horizontal"
    for step_ms in (1, 5, 10):
        model = infant(step_ms)
        margins_deg = [np.degrees(model.joint(f"robot:{name}").margin[0]) for name in names]
        assert margins_deg == pytest.approx([2.0, 2.0, 7.8, 7.8, 7.8, 0], abs=0.1)


def test_a_fast_knee_is_stopped_within_ten_degrees():
    for step_ms, beyond_deg in ((5, 10), (10, 20)):
        model = infant(step_ms, hands="mitten")
        knee, data = model.joint("robot:left_knee"), mujoco.MjData(model)
        for start_deg in np.linspace(-70, -50, 9):
            mujoco.mj_resetData(model, data)
            data.qpos[2], data.qpos[knee.qposadr] = 2.0, np.radians(start_deg)
            data.qvel[knee.dofadr] = 35.0
            last_rad = []
            for _ in range(round(0.1 / model.opt.timestep)):
                mujoco.mj_step(model, data)
                last_rad.append(data.qpos[knee.qposadr[0]])
            assert np.degrees(max(last_rad) - knee.range[1]) < beyond_deg


@pytest.mark.parametrize(("law", "turns"), [("maturing", False), ("published", True)])
def test_what_slides_over_an_eye_turns_it_only_by_the_published_law(law, turns):
    model = infant(law=law)
    data, eye = mujoco.MjData(model), model.geom("left_eye1").id
    mujoco.mj_kinematics(model, data)
    data.qpos[2] -= data.geom_xpos[eye, 2] - model.geom_size[eye, 0] + 0.001
    mujoco.mj_forward(model, data)
    dimensions = [contact.dim for contact in data.contact if eye in contact.geom]
    assert dimensions
    assert all((dimension > 1) == turns for dimension in dimensions)


def test_a_margin_says_where_it_comes_from():
    for law, speeds in (
        ("maturing", {"knee": "35 rad/s", "toes": "55 rad/s", "eye_horizontal": None}),
        ("published", {}),
    ):
        spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 6, "development": law})
        entries = entries_of(mimoc.build(spec))
        assert any(key.endswith(".margin") for key in entries) == bool(speeds)
        for joint, speed in speeds.items():
            entry = entries.get(f"joint.robot:left_{joint}.margin")
            assert bool(entry) == bool(speed)
            if entry:
                assert speed in entry["rule"]
                assert entry["from"] == [f"joint.robot:left_{joint}.range", "spec.development"]
                assert entry["xml"].endswith("/@margin")
