"""Shares of strength arrive at the joints in every actuation model, and quiet infants are left alone."""

import mujoco
import numpy as np
import pytest

from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.infant import Conditions, compile_at
from mimoc.studies.movement.drive import QUIET, Drive, all_but, angle_deg, floating, run, settled, slack

MODELS = ("torque", "position", "muscle")


def infant(model, age_months=6.0):
    spec = InfantSpec(mimoc=1, name="child", age_months=0, actuation={"model": model})
    return compile_at(spec, age_months, Conditions())


def torque_nm(body, data, joint):
    """Return what all actuators of a hinge give."""
    at = body.model.actuator_trnid[:, 0] == body.model.joint(f"robot:{joint}").id
    return float(np.sum(data.actuator_force[at] * body.model.actuator_gear[at, 0]))


@pytest.mark.parametrize("model", ["torque", "position"])
@pytest.mark.parametrize("share", [-0.6, 0.3])
def test_a_held_joint_gets_the_share_of_its_strength(model, share):
    body = floating(infant(model))
    body = body.fixed(range(body.model.nv))
    body.model.actuator_biasprm[:] = 0.0 if model == "torque" else body.toneless_bias  # Tone comes on top.
    data = body.placed(0.0, {"{side}_elbow": -60.0}, 1.0)
    full = {}
    for end in (-1.0, 1.0):
        data.act[:] = 0.0
        run(body, data, 0.6, {"left_elbow": end})
        full[end] = torque_nm(body, data, "left_elbow")
    data.act[:] = 0.0
    run(body, data, 0.6, {"left_elbow": share})
    wanted = np.clip(share * max(-full[-1.0], full[1.0]), full[-1.0], full[1.0])
    assert torque_nm(body, data, "left_elbow") == pytest.approx(wanted, rel=0.02)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("share", [-0.5, 0.5])
def test_a_joint_turns_the_way_it_is_asked_to(model, share):
    body = all_but(floating(infant(model)), "left_elbow")
    body.model.opt.gravity[:] = 0.0
    data = body.placed(0.0, {"left_elbow": -70.0}, 1.0)
    run(body, data, 0.2, {"left_elbow": share})
    assert np.sign(angle_deg(body, data, "left_elbow") + 70.0) == np.sign(share)


def test_a_quiet_servo_leaves_its_joint_to_muscle_tone_as_a_motor_does():
    rests = []
    for body in (infant("torque", 1.0), infant("position", 1.0)):
        data = settled(body, 4.0)
        rests.append([angle_deg(body, data, joint) for joint in ("left_hip1", "left_knee", "left_elbow")])
    assert np.allclose(*rests, atol=8.0)


@pytest.mark.parametrize("model", MODELS)
def test_slack_motors_and_servos_give_nothing_whatever_they_are_asked_for(model):
    body = slack(infant(model))
    data = body.placed(0.0, {"left_elbow": -60.0}, 1.0)
    data.ctrl[:] = 1.0 if model != "muscle" else 0.0
    mujoco.mj_step(body.model, data, 20)
    active = np.abs(data.actuator_force) > 1e-9
    assert model == "muscle" or not active.any()
    assert not np.any(data.act[active] > 1e-9)


def test_tone_that_is_a_bias_of_motors_goes_when_an_infant_is_slack():
    """So a later law can put tone there, and the slack trials do not see it."""
    body = infant("torque")
    body.model.actuator_biastype[:] = mujoco.mjtBias.mjBIAS_AFFINE
    body.model.actuator_biasprm[:, 0] = -0.3
    slackened = slack(body)
    data = slackened.placed(0.0, {}, 1.0)
    mujoco.mj_step(slackened.model, data)
    assert not data.actuator_force.any()
    assert body.model.actuator_biasprm.any()


def test_joints_that_an_infant_lacks_are_left_out():
    body = infant("torque")
    data = body.placed(0.0, {}, 1.0)
    assert np.array_equal(Drive(body)(data, {"tail": 1.0}), Drive(body)(data, QUIET))
