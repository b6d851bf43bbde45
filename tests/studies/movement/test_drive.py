"""Shares of strength arrive at the joints in every actuation model, and quiet infants are left alone."""

import math

import mujoco
import numpy as np
import pytest

from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.trial import Conditions, TrialInfant, compile_at
from mimoc.studies.movement.posture import MIN_DEG, damping_ratio, swing
from mimoc.studies.movement.trial import QUIET, Drive, Subject, all_but, angle_deg, floating, run, settled, slack

MODELS = ("torque", "position", "muscle")


def infant(model, age_months=6.0):
    spec = InfantSpec(mimoc=1, name="child", age_months=0, actuation={"model": model})
    return compile_at(spec, age_months, Conditions())


def torque_nm(body, data, joint):
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


LENGTH_M, MASS_KG, RADIUS_M, ARMATURE, GRAVITY = 0.15, 0.3, 0.02, 1e-4, 9.81
INERTIA = MASS_KG * LENGTH_M**2 + 0.4 * MASS_KG * RADIUS_M**2 + ARMATURE
MOMENT = MASS_KG * GRAVITY * LENGTH_M
START_DEG = 20.0


def limb(ratio, *, friction_nm=0.0):
    """Return an infant whose only limb is a ball on a weightless rod, with some damping ratio."""
    damping = 2 * ratio * math.sqrt(MOMENT * INERTIA)
    model = mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <option timestep="0.001" integrator="RK4"/>
      <worldbody>
        <geom name="floor" type="plane" size="1 1 1"/>
        <body name="hip">
          <freejoint/>
          <geom type="sphere" size="0.05" mass="1"/>
          <body name="left_lower_leg">
            <joint name="robot:left_knee" axis="0 1 0" range="-150 150" damping="{damping}" armature="{ARMATURE}"
                   frictionloss="{friction_nm}"/>
            <geom type="sphere" size="{RADIUS_M}" mass="{MASS_KG}" pos="0 0 {-LENGTH_M}"/>
          </body>
        </body>
      </worldbody>
      <actuator><motor joint="robot:left_knee" gear="1" ctrlrange="-1 1" forcerange="-1 1"/></actuator>
    </mujoco>""")
    return TrialInfant(model, np.array([1], np.intp))


@pytest.mark.parametrize("ratio", [0.09, 0.1, 0.2, 0.35])
def test_the_number_of_swings_is_that_of_the_damping(ratio):
    """Half swings shrink by exp(-pi zeta / sqrt(1 - zeta²)); those of more than a degree count."""
    decrement = math.pi * ratio / math.sqrt(1 - ratio**2)
    half_swings = math.floor(math.log(START_DEG / MIN_DEG) / decrement)
    moved = swing(limb(ratio), "left_knee", START_DEG, {})
    assert moved.swings == half_swings / 2
    assert moved.index == pytest.approx(1 + math.exp(-decrement), abs=0.01)
    assert moved.rest_deg == pytest.approx(0.0, abs=0.2)


def test_the_period_is_that_of_the_pendulum():
    moved = swing(limb(0.1), "left_knee", START_DEG, {})
    period_s = 2 * math.pi * math.sqrt(INERTIA / MOMENT / (1 - 0.1**2))
    assert moved.period_s == pytest.approx(period_s, rel=0.02)


def test_more_than_critical_damping_does_not_swing():
    moved = swing(limb(1.2), "left_knee", START_DEG, {})
    assert (moved.swings, moved.period_s) == (0.0, None)
    assert moved.index == pytest.approx(1.0)


@pytest.mark.parametrize("ratio", [0.06, 0.2, 1.2])
def test_the_damping_ratio_is_read_from_the_model(ratio):
    assert damping_ratio(limb(ratio), "left_knee") == pytest.approx(ratio, rel=1e-4)


def test_friction_takes_swings_away_that_the_damping_ratio_does_not_tell_of():
    free, rubbing = limb(0.06), limb(0.06, friction_nm=0.1 * MOMENT)
    assert damping_ratio(free, "left_knee") == damping_ratio(rubbing, "left_knee")
    assert swing(rubbing, "left_knee", START_DEG, {}).swings < swing(free, "left_knee", START_DEG, {}).swings


def test_a_compiled_shank_with_less_damping_swings_more():
    spec = InfantSpec(mimoc=1, name="child", age_months=6)
    swings = []
    for factor in (1.0, 0.05):
        body = Subject(compile_at(spec, 6.0, Conditions()), spec).slack
        body.model.dof_damping[:] *= factor
        body.model.dof_frictionloss[:] = 0.0
        swings.append(swing(body, "left_knee", 0.0, {"left_hip1": -90.0}).swings)
    assert swings[0] < swings[1]
