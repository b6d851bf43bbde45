"""Servos as the runtime commands and feels them."""

import numpy as np
import pytest


@pytest.fixture
def env(open_env):
    env = open_env(actuation={"model": "position"}, scene={"kind": "flat", "pose": "supine"})
    env.reset(seed=0)
    return env


def driven_angles(env):
    return np.array([env.data.joint(actuator.joint).qpos[0] for actuator in env.manifest.actuation.actuators])


def test_a_command_is_a_place_in_the_joints_range(env):
    """A lying infant turns its head and lifts its hands to where it is told."""
    ranges = np.array([env.model.joint(actuator.joint).range for actuator in env.manifest.actuation.actuators])
    command = env.data.ctrl.copy()
    names = [actuator.name for actuator in env.manifest.actuation.actuators]
    for name, share in (("act:left_wrist_flexion", 0.5), ("act:right_elbow", -0.2), ("act:left_eye_horizontal", -0.8)):
        command[names.index(name)] = share
    for _ in range(40):
        env.step(command)
    wanted = ranges.mean(axis=1) + command * np.ptp(ranges, axis=1) / 2
    assert np.degrees(driven_angles(env)) == pytest.approx(np.degrees(wanted), abs=1)


@pytest.mark.parametrize("pose", ["supine", "prone", "sitting", "standing"])
def test_a_reset_holds_the_pose_it_starts_from(env, pose):
    env.reset(options={"pose": pose})
    start = driven_angles(env)
    for _ in range(30):
        env.step(env.data.ctrl.copy())
    assert np.degrees(driven_angles(env)) == pytest.approx(np.degrees(start), abs=1)


def test_commands_and_torques_are_felt(env):
    command = env.np_random.uniform(-1, 1, 44).astype(np.float32)
    observation, *_ = env.step(command)
    felt = dict(zip(env.layout("proprioception"), observation["proprioception"], strict=True))
    for index, actuator in enumerate(env.manifest.actuation.actuators):
        assert felt[f"{actuator.name} command [1]"] == command[index]
        assert felt[f"{actuator.name} torque [N m]"] == pytest.approx(env.data.actuator_force[index], rel=1e-6)


def test_servos_cost_nothing(env):
    env.step(env.action_space.high)
    assert env.effort() == 0
