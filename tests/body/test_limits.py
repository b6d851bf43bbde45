"""Limits of joints: MIMo's by the published law, and by the law `maturing` such that they stop a joint in time."""

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.body.limits import LARGEST_SHARE, TAU_S
from mimoc.bundle.model import load_model
from mimoc.compiler.explain import entries_of

HINGE = mujoco.mjtJoint.mjJNT_HINGE


def infant(step_ms=5, law="maturing", hands="five_finger", age_months=6):
    control = {"timestep_ms": step_ms, "step_ms": 20}
    keys = {"control": control, "development": law, "body": {"hands": hands}, "scene": {"kind": "flat"}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": age_months, **keys}))
    return load_model(bundle)


def margins_deg(model, *joints):
    return [pytest.approx(np.degrees(model.joint(f"robot:{name}").margin[0]), abs=0.1) for name in joints]


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
    assert (model.jnt_margin[hinges] <= LARGEST_SHARE * np.ptp(model.jnt_range[hinges], axis=1) + 1e-8).all()


def test_limits_of_faster_joints_act_earlier_whatever_the_physics_step():
    names = "left_knee", "right_elbow", "left_toes", "right_ff_knuckle", "left_lf_meta", "left_eye_horizontal"
    for step_ms in (1, 5, 10):
        assert margins_deg(infant(step_ms), *names) == [2.0, 2.0, 7.8, 7.8, 7.8, 0]


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
    """A contact with the ground that moves on, seen from the eye."""
    model = infant(law=law)
    data, eye = mujoco.MjData(model), model.geom("left_eye1").id
    mujoco.mj_kinematics(model, data)
    data.qpos[2] -= data.geom_xpos[eye, 2] - model.geom_size[eye, 0] + 0.001
    mujoco.mj_forward(model, data)
    dimensions = [contact.dim for contact in data.contact if eye in contact.geom]
    assert dimensions
    assert all((dimension > 1) == turns for dimension in dimensions)


def test_a_margin_says_where_it_comes_from():
    """That of a toe has a speed of its own, eyes have none, and neither do joints by the published law."""
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
