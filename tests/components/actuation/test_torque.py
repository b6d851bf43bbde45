"""Torque motors as the runtime commands and feels them: with an activation, and at once as published."""

import numpy as np
import pytest

TIME_CONSTANT_S, EYES_S, TIMESTEP_S = 0.06, 0.01, 0.005


@pytest.fixture
def published(open_env):
    env = open_env(development="published", scene={"kind": "flat", "pose": "sitting"})
    env.reset(seed=0)
    return env


def with_tone(env, shares):
    """Return the shares of their gears that motors are driven by, with tone and at the speed of the last step."""
    turned = np.array([np.ones(env.model.nu), env.data.actuator_length, env.data.actuator_velocity])
    return shares + (env.model.actuator_biasprm[:, :3] * turned.T).sum(axis=1)


def gears_nm(env, shares):
    """Return the torques of the motors that are driven by some shares of their gears."""
    motors = [env.model.actuator(actuator.name) for actuator in env.manifest.actuation.actuators]
    return [motor.gear[0] * np.clip(share, *motor.forcerange) for motor, share in zip(motors, shares, strict=True)]


def torques_nm(env):
    """Return the torque about each motor's joint, after making sure that there are no others."""
    hinges = [env.model.joint(actuator.joint).dofadr[0] for actuator in env.manifest.actuation.actuators]
    assert not np.delete(env.data.qfrc_actuator, hinges).any()
    return env.data.qfrc_actuator[hinges]


def test_a_published_command_is_a_share_of_each_motors_gear(published):
    """Up to the motor's greatest force."""
    command = np.random.default_rng(0).uniform(-1, 1, 44)
    published.step(command)
    assert torques_nm(published) == pytest.approx(gears_nm(published, command))


def test_an_activation_is_a_share_of_each_motors_gear(env):
    """It follows the command; MuJoCo's forces are those of the activation one physics step before."""
    command = np.random.default_rng(0).uniform(-1, 1, 44)
    eyes = np.array(["eye" in actuator.name for actuator in env.manifest.actuation.actuators])
    for steps in range(1, 11):
        env.step(command)
        before_s = 2 * steps * TIMESTEP_S - TIMESTEP_S
        activation = command * (1 - np.exp(-before_s / np.where(eyes, EYES_S, TIME_CONSTANT_S)))
        assert torques_nm(env) == pytest.approx(gears_nm(env, with_tone(env, activation)))


def test_motors_that_take_no_commands_stay_without_activation(open_env):
    env = open_env(actuation={"regions": ["arms"], "locked": ["legs"]}, scene={"kind": "flat", "pose": "sitting"})
    env.reset(seed=0)
    for _ in range(5):
        env.step(env.action_space.high)
    commanded = np.array([actuator.commanded for actuator in env.manifest.actuation.actuators])
    assert env.data.act[commanded].all()
    assert not env.data.act[~commanded].any()


def test_the_action_names_its_actuators_in_order(env):
    for index, actuator in enumerate(env.manifest.actuation.actuators):
        command = np.zeros(44)
        command[index] = 1.0
        env.reset(seed=0)
        env.step(command)
        assert env.data.actuator(actuator.name).ctrl[0] == 1
        assert np.count_nonzero(env.data.ctrl) == 1


def test_effort_is_the_mean_square_share_of_torque_weighted_by_strength(env):
    """Sum of u² T over n sum of T; u as far as the force range lets it through."""
    assert env.effort() < 1e-6
    motors = [env.model.actuator(actuator.name) for actuator in env.manifest.actuation.actuators]
    strengths_nm = np.array([motor.gear[0] * np.abs(motor.forcerange).max() for motor in motors])
    for command in (np.full(44, 0.25), np.random.default_rng(0).uniform(-1, 1, 44)):
        for _ in range(100):
            env.step(command)
        shares = np.array(gears_nm(env, with_tone(env, command))) / strengths_nm
        assert env.effort() == pytest.approx(shares**2 @ strengths_nm / (44 * strengths_nm.sum()), rel=1e-6)
