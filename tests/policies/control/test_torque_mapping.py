"""What joints are commanded is what they get, with motors and with muscles."""

import mujoco
import numpy as np
import pytest

from mimoc.policies.control.torque_mapping import TORQUE_MAPPINGS, Antagonists, Motors

STEP_S = 0.01


@pytest.fixture
def elbow(open_env):
    """Return the environment of an infant, the index of its elbow, and a mapping for it."""

    def find(model, development="maturing"):
        scene = {"kind": "flat", "pose": "sitting"}
        env = open_env(actuation={"model": model}, development=development, scene=scene)
        env.reset(seed=0)
        joint = env.model.joint("robot:left_elbow")
        return env, joint, TORQUE_MAPPINGS[model](env.actuation, np.array([joint.id]), env.model, STEP_S)

    return find


def test_motors_and_muscles_take_torques():
    assert {"torque": Motors, "muscle": Antagonists} == TORQUE_MAPPINGS


@pytest.mark.parametrize("torque_nm", [-0.5, -0.05, 0.2])
def test_a_published_motor_gives_the_torque_at_once(elbow, torque_nm):
    env, joint, mapping = elbow("torque", "published")
    mapping.rest(env.model, env.data)
    env.step(mapping.command(np.array([torque_nm])))
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
    env, joint, mapping = elbow(model, development)
    data, dof = env.data, joint.dofadr[0]
    data.act[:] = start
    mapping.rest(env.model, data)
    resting_nm = data.qfrc_actuator[dof]
    torque_nm = (start + share) * mapping.strength_nm
    command, time_constant_s = mapping.command(torque_nm), env.model.actuator_dynprm[0, 0]
    data.act[:] = start + (command - start) * (1 - np.exp(-STEP_S / time_constant_s))
    mujoco.mj_fwdActuation(env.model, data)
    assert data.qfrc_actuator[dof] - resting_nm == pytest.approx(torque_nm[0], rel=1e-6)


@pytest.mark.parametrize("side", [0, 1])
def test_an_activation_that_cannot_be_reached_in_time_is_approached_at_full_command(elbow, side):
    env, joint, mapping = elbow("torque")
    limits_nm = mapping.rest(env.model, env.data)
    command = mapping.command(limits_nm[:, side])
    slot = [actuator.joint for actuator in env.manifest.actuation.actuators].index(joint.name)
    assert command[slot] == (-1.0, 1.0)[side]
    assert not np.delete(command, slot).any()


def test_only_one_of_two_antagonists_pulls(elbow):
    env, _, mapping = elbow("muscle")
    mapping.rest(env.model, env.data)
    for torque_nm in (-0.1, 0.1):
        command = mapping.command(np.array([torque_nm]))
        assert np.count_nonzero(command) == 1


def test_limits_are_those_of_the_actuators(elbow):
    env, _, mapping = elbow("torque")
    negative_nm, positive_nm = mapping.rest(env.model, env.data)[0]
    assert -negative_nm > positive_nm > 0  # An elbow flexes stronger than it extends.
    assert mapping.strength_nm == pytest.approx([-negative_nm])


def test_muscles_at_their_limits_are_fully_active(elbow):
    env, _, mapping = elbow("muscle")
    for side in (0, 1):
        limits_nm = mapping.rest(env.model, env.data)
        assert mapping.command(limits_nm[:, side]).max() == pytest.approx(1.0)
