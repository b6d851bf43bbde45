"""What joints are commanded is what they get, with motors and with muscles."""

import mujoco
import numpy as np
import pytest

from mimoc.control.antagonists import Antagonists
from mimoc.control.inverse_dynamics import DRIVES
from mimoc.control.motors import Motors


@pytest.fixture
def elbow(open_env):
    """Return the environment of an infant, the index of its elbow, and a drive for it."""

    def find(model):
        env = open_env(actuation={"model": model}, scene={"kind": "flat", "pose": "sitting"})
        env.reset(seed=0)
        joint = env.model.joint("robot:left_elbow")
        return env, joint, DRIVES[model](env.actuation, np.array([joint.id]), env.model, 0.01)

    return find


def test_every_drive_has_its_actuation_model():
    assert {"torque": Motors, "muscle": Antagonists} == DRIVES


@pytest.mark.parametrize("torque_nm", [-0.5, -0.05, 0.2])
def test_a_motor_gives_the_torque(elbow, torque_nm):
    env, joint, drive = elbow("torque")
    drive.rest(env.model, env.data)
    env.step(drive.command(np.array([torque_nm])))
    assert env.data.qfrc_actuator[joint.dofadr[0]] == pytest.approx(torque_nm)


@pytest.mark.parametrize("torque_nm", [-0.5, -0.05, 0.2])
def test_muscles_give_the_torque_once_they_are_active(elbow, torque_nm):
    """At the end of the control step, but for what the joint's motion changes meanwhile."""
    env, joint, drive = elbow("muscle")
    data = env.data
    drive.rest(env.model, data)
    resting_nm = data.qfrc_actuator[joint.dofadr[0]]
    command = drive.command(np.array([torque_nm]))
    data.act[:] += (command - data.act) * (1 - np.exp(-1.0))
    mujoco.mj_fwdActuation(env.model, data)
    assert data.qfrc_actuator[joint.dofadr[0]] - resting_nm == pytest.approx(torque_nm, rel=1e-6)


def test_only_one_of_two_antagonists_pulls(elbow):
    env, _, drive = elbow("muscle")
    drive.rest(env.model, env.data)
    for torque_nm in (-0.1, 0.1):
        command = drive.command(np.array([torque_nm]))
        assert np.count_nonzero(command) == 1


def test_limits_are_those_of_the_actuators(elbow):
    env, _, drive = elbow("torque")
    negative_nm, positive_nm = drive.rest(env.model, env.data)[0]
    assert -negative_nm > positive_nm > 0  # An elbow flexes stronger than it extends.
    assert drive.strength_nm == pytest.approx([-negative_nm])


def test_muscles_at_their_limits_are_fully_active(elbow):
    env, _, drive = elbow("muscle")
    for side in (0, 1):
        limits_nm = drive.rest(env.model, env.data)
        assert drive.command(limits_nm[:, side]).max() == pytest.approx(1.0)
