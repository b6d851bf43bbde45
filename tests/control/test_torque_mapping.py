"""What joints are commanded is what they get, with motors and with muscles."""

import mujoco
import numpy as np
import pytest

from mimoc.control.antagonists import Antagonists
from mimoc.control.motors import Motors
from mimoc.control.torque_mapping import TORQUE_MAPPINGS


@pytest.fixture
def elbow(open_env):
    """Return the environment of an infant, the index of its elbow, and a mapping for it."""

    def find(model):
        env = open_env(actuation={"model": model}, scene={"kind": "flat", "pose": "sitting"})
        env.reset(seed=0)
        joint = env.model.joint("robot:left_elbow")
        return env, joint, TORQUE_MAPPINGS[model](env.actuation, np.array([joint.id]), env.model, 0.01)

    return find


def test_motors_and_muscles_take_torques():
    assert {"torque": Motors, "muscle": Antagonists} == TORQUE_MAPPINGS


@pytest.mark.parametrize("torque_nm", [-0.5, -0.05, 0.2])
def test_a_motor_gives_the_torque(elbow, torque_nm):
    env, joint, mapping = elbow("torque")
    mapping.rest(env.model, env.data)
    env.step(mapping.command(np.array([torque_nm])))
    assert env.data.qfrc_actuator[joint.dofadr[0]] == pytest.approx(torque_nm)


@pytest.mark.parametrize("torque_nm", [-0.5, -0.05, 0.2])
def test_muscles_give_the_torque_once_they_are_active(elbow, torque_nm):
    """At the end of the control step, but for what the joint's motion changes meanwhile."""
    env, joint, mapping = elbow("muscle")
    data = env.data
    mapping.rest(env.model, data)
    resting_nm = data.qfrc_actuator[joint.dofadr[0]]
    command = mapping.command(np.array([torque_nm]))
    data.act[:] += (command - data.act) * (1 - np.exp(-1.0))
    mujoco.mj_fwdActuation(env.model, data)
    assert data.qfrc_actuator[joint.dofadr[0]] - resting_nm == pytest.approx(torque_nm, rel=1e-6)


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
