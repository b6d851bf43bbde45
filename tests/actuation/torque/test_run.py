import numpy as np
import pytest


def test_a_command_is_a_share_of_each_motors_gear(env):
    """Up to the motor's greatest force."""
    command = np.random.default_rng(0).uniform(-1, 1, 44)
    env.step(command)
    motors = [env.model.actuator(actuator.name) for actuator in env.manifest.actuation.actuators]
    torques = [motor.gear[0] * np.clip(share, *motor.forcerange) for motor, share in zip(motors, command, strict=True)]
    hinges = [env.model.joint(actuator.joint).dofadr[0] for actuator in env.manifest.actuation.actuators]
    assert env.data.qfrc_actuator[hinges] == pytest.approx(torques)
    assert not np.delete(env.data.qfrc_actuator, hinges).any()


def test_actions_have_the_range_of_the_controls(env):
    space, model = env.action_space, env.model
    assert (space.shape, space.dtype) == ((model.nu,), np.float32)
    assert np.array_equal(np.stack([space.low, space.high], axis=1), model.actuator_ctrlrange)


def test_the_action_names_its_actuators_in_order(env):
    for index, actuator in enumerate(env.manifest.actuation.actuators):
        command = np.zeros(44)
        command[index] = 1.0
        env.reset(seed=0)
        env.step(command)
        assert env.data.actuator(actuator.name).ctrl[0] == 1
        assert np.count_nonzero(env.data.ctrl) == 1


def test_effort_is_the_mean_square_command_weighted_by_strength(env):
    """Sum of u² T over n sum of T; u as far as the force range lets it through."""
    assert env.effort() == 0
    motors = [env.model.actuator(actuator.name) for actuator in env.manifest.actuation.actuators]
    gears = np.array([motor.gear[0] for motor in motors])
    env.step(np.full(44, 0.25))
    assert env.effort() == pytest.approx(0.0625 / 44)
    command = np.random.default_rng(0).uniform(-1, 1, 44)
    env.step(command)
    shares = np.array([np.clip(share, *motor.forcerange) for motor, share in zip(motors, command, strict=True)])
    assert env.effort() == pytest.approx(shares**2 @ gears / (44 * gears.sum()))
