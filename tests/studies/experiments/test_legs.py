"""Weights, ribbons and hands that hold infants."""

import mujoco
import numpy as np
import pytest

from mimoc.policies.general_movements.generator import Moving
from mimoc.policies.general_movements.law import ARM, LIMBS as POLICY_LIMBS
from mimoc.policies.policy import batch_of_one
from mimoc.studies.experiments.legs import (
    LIMBS,
    MOBILE_N_M,
    Mover,
    Setup,
    leg_kg,
    limb_of_actuators,
    mobile_speed_m_s,
    open_infant,
    ribbon_m,
    tie_ribbon,
)


def still(env):
    """Return a policy without commands."""
    return lambda generator, observation: np.zeros(env.action_space.shape, np.float32)


def test_a_weight_adds_its_mass_to_one_leg():
    plain, heavy = (open_infant(Setup(1.0, left_kg=kg)).model for kg in (0.0, 0.1))
    added = heavy.body_mass - plain.body_mass
    assert added.sum() == pytest.approx(0.1)
    assert heavy.body(int(np.argmax(added))).name == "left_lower_leg"


def test_a_weight_hangs_at_the_ankle():
    """So that it turns the shank as a point mass there does."""
    plain, heavy = (open_infant(Setup(1.0, left_kg=kg)).model for kg in (0.0, 0.1))
    shank, foot = plain.body("left_lower_leg").id, plain.body("left_foot").id
    mass_kg, centre_m, ankle_m = plain.body_mass[shank], plain.body_ipos[shank], plain.body_pos[foot]
    assert heavy.body_ipos[shank] == pytest.approx((mass_kg * centre_m + 0.1 * ankle_m) / (mass_kg + 0.1))


def test_legs_gain_mass_with_age():
    assert leg_kg(0.0) < leg_kg(1.0) < leg_kg(6.0)


def test_who_is_held_does_not_sink():
    env = open_infant(Setup(1.0, held=True))
    mover = Mover(env, 0, still)
    height_m = env.data.body("hip").xpos[2]
    mover.move(2.0)
    assert env.data.body("hip").xpos[2] == pytest.approx(height_m, abs=1e-5)


@pytest.fixture
def tied():
    env = open_infant(Setup(3.0, tied="left"))
    mover = Mover(env, 0, still)
    mover.move(1.0)
    return env, mover


def test_a_slack_ribbon_pulls_nothing(tied):
    env, mover = tied
    tie_ribbon(env, ribbon_m(env) + 0.05)
    start = env.data.qpos[env.model.joint("mobile").qposadr[0]]
    mover.move(0.5)
    assert env.data.qpos[env.model.joint("mobile").qposadr[0]] == pytest.approx(start, abs=1e-6)
    assert mobile_speed_m_s(env) == pytest.approx(0, abs=1e-6)


def test_a_straight_ribbon_pulls_the_mobile_up_and_keeps_its_length(tied):
    env, mover = tied
    length_m = ribbon_m(env) - 0.03
    tie_ribbon(env, length_m)
    mover.move(3.0)
    assert ribbon_m(env) == pytest.approx(length_m, abs=0.005)
    assert 0.005 < env.data.qpos[env.model.joint("mobile").qposadr[0]] < 0.04


def test_a_straight_ribbon_pulls_the_ankle_as_much_as_the_mobile(tied):
    """The force is that of the arm on which the mobile hangs: stiffness times way."""
    env, mover = tied
    tie_ribbon(env, ribbon_m(env) - 0.03)
    mover.move(6.0)
    way_m = env.data.qpos[env.model.joint("mobile").qposadr[0]]
    limits = env.data.efc_force[env.data.efc_type == mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON]
    assert limits[-1] == pytest.approx(MOBILE_N_M * way_m, rel=0.05)


def test_each_limb_has_its_actuators():
    env = open_infant(Setup(3.0))
    names = [env.model.actuator(int(index)).name for index in env.actuation.actuators]
    limbs = dict(zip(names, limb_of_actuators(env), strict=True))
    assert LIMBS[limbs["act:left_hip_flex_negative"]] == "left_hip"
    assert LIMBS[limbs["act:right_foot_flexion_positive"]] == "right_knee"
    assert LIMBS[limbs["act:left_wrist_ulnar_negative"]] == "left_arm"
    assert (
        limbs["act:head_tilt_positive"]
        == limbs["act:hip_bend_negative"]
        == limbs["act:left_eye_vertical_negative"]
        == -1
    )


def test_gains_change_the_commands_of_their_part_alone():
    env = open_infant(Setup(3.0))
    asked = []
    step = env.step
    env.step = lambda action: asked.append(action.copy()) or step(action)
    mover = Mover(env, 0, lambda env: lambda generator, observation: np.full(env.action_space.shape, 0.2, np.float32))
    mover.set_gains(np.array([1.0, 1.0, 3.0, 1.0, 1.0, 1.0]))
    mover.move(0.01)
    assert np.unique(asked[0][limb_of_actuators(env) == LIMBS.index("left_hip")]) == pytest.approx([0.6])
    assert np.unique(asked[0][limb_of_actuators(env) != LIMBS.index("left_hip")]) == pytest.approx([0.2])


def test_a_leg_whose_bursts_begin_more_often_is_driven_more():
    env = open_infant(Setup(3.0))
    drives = []
    for gain in (1.0, 3.0):
        env.reset(seed=0)
        moving, generator = Moving(batch_of_one(env)), np.random.default_rng(0)
        moving.movement.rate_gains = np.where(np.array(POLICY_LIMBS) == "left_leg", gain, 1.0)[None]
        actions = np.array([moving([generator], {})[0] for _ in range(3000)])
        hips = [limb_of_actuators(env) == LIMBS.index(f"{side}_hip") for side in ("left", "right")]
        drives.append([np.abs(np.diff(actions[:, hip], axis=0)).mean() for hip in hips])
    (left, right), (more, same) = drives
    assert more > 1.1 * left
    assert same == pytest.approx(right)


def test_movement_is_the_joint_speed_of_each_limb():
    env = open_infant(Setup(3.0))
    mover = Mover(env, 0, still)
    speeds = np.abs([data.qvel.copy() for data in mover.steps(0.1)]).mean(axis=0)
    arm = [env.model.joint(f"robot:left_{name}").dofadr[0] for name in ARM]
    assert mover.take_movement()[LIMBS.index("left_arm")] == pytest.approx(speeds[arm].mean())
    assert mover.take_movement() == pytest.approx(np.zeros(len(LIMBS)))
