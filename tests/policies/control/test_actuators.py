"""What joints are commanded is what they get, with motors and with muscles."""

import mujoco
import numpy as np
import pytest

from mimoc.policies.control.actuators import ActuatorInverse, Plant
from mimoc.policies.control.infant import DrivenInfant

STEP_S = 0.01


@pytest.fixture
def elbow(open_env):
    """Return the environment of an infant, its elbow, and a plant whose only joint that is."""

    def find(model, development="maturing"):
        scene = {"kind": "flat", "pose": "sitting"}
        env = open_env(actuation={"model": model}, development=development, scene=scene)
        env.reset(seed=0)
        return env, env.model.joint("robot:left_elbow"), Plant(env.model, env.manifest, ["robot:left_elbow"])

    return find


def rest(plant, data):
    plant.look(data)
    return plant.rest()


@pytest.mark.parametrize("torque_nm", [-0.5, -0.05, 0.2])
def test_a_published_motor_gives_the_torque_at_once(elbow, torque_nm):
    env, joint, plant = elbow("torque", "published")
    rest(plant, env.data)
    env.step(plant.action(np.array([torque_nm])))
    assert env.data.qfrc_actuator[joint.dofadr[0]] == pytest.approx(torque_nm)


@pytest.mark.parametrize("share", [-0.1, -0.01, 0.05, 0.1])
@pytest.mark.parametrize(
    ("model", "development", "start"),
    [
        ("torque", "maturing", 0.0),
        ("torque", "maturing", 0.3),
        ("muscle", "maturing", 0.0),
        ("muscle", "published", 0.0),
    ],
)
def test_an_activation_gives_the_torque_at_the_end_of_the_control_step(elbow, model, development, start, share):
    """But for what the joint's motion changes meanwhile; a share of the elbow's strength more or less than at first."""
    env, joint, plant = elbow(model, development)
    data, dof = env.data, joint.dofadr[0]
    data.act[:] = start
    rest(plant, data)
    resting_nm = plant.data.qfrc_actuator[dof]
    torque_nm = (start + share) * plant.strength_nm
    command, time_constant_s = plant.action(torque_nm), env.model.actuator_dynprm[0, 0]
    data.act[:] = start + (command - start) * (1 - np.exp(-STEP_S / time_constant_s))
    mujoco.mj_fwdActuation(env.model, data)
    assert data.qfrc_actuator[dof] - resting_nm == pytest.approx(torque_nm[0], rel=1e-6)


@pytest.mark.parametrize("side", [0, 1])
def test_an_activation_that_cannot_be_reached_in_time_is_approached_at_full_command(elbow, side):
    env, joint, plant = elbow("torque")
    limits_nm = rest(plant, env.data)
    command = plant.action(limits_nm[:, side])
    slot = [actuator.joint for actuator in env.manifest.actuation.actuators].index(joint.name)
    assert command[slot] == (-1.0, 1.0)[side]
    assert not np.delete(command, slot).any()


def test_limits_are_those_of_the_actuators(elbow):
    env, _, plant = elbow("torque")
    negative_nm, positive_nm = rest(plant, env.data)[0]
    assert -negative_nm > positive_nm > 0  # An elbow flexes stronger than it extends.
    assert plant.strength_nm == pytest.approx([-negative_nm])


def test_one_of_two_antagonists_pulls_and_at_its_limit_with_all_it_has(elbow):
    env, _, plant = elbow("muscle")
    for side in (0, 1):
        limit_nm = rest(plant, env.data)[:, side]
        whole, part = plant.action(limit_nm), plant.action(0.02 * limit_nm)
        assert np.count_nonzero(whole) == np.count_nonzero(part) == 1
        assert part.max() < whole.max() == pytest.approx(1.0)


@pytest.mark.parametrize("model", ["torque", "muscle"])
def test_torques_beside_those_at_rest_and_whole_torques_have_the_same_controls(open_env, model):
    env = open_env(actuation={"model": model}, scene={"kind": "flat", "pose": "sitting"})
    env.reset(seed=0)
    infant, scratch = DrivenInfant.of(env.model, env.manifest), mujoco.MjData(env.model)
    inverse = ActuatorInverse(infant, infant.actuators, STEP_S)
    scratch.qpos[:] = env.data.qpos
    mujoco.mj_forward(env.model, scratch)
    limits_nm = inverse.rest(scratch)
    resting_nm, added_nm = scratch.qfrc_actuator[infant.dofs].copy(), 0.1 * limits_nm[:, 1]
    beside = inverse.controls_from_rest(env.data.act, added_nm)
    whole = inverse.controls(scratch, env.data.act, resting_nm + added_nm, np.zeros(len(added_nm)))
    assert beside == pytest.approx(whole, abs=1e-9)
    assert beside.any()
