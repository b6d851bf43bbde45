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
    """A lying infant turns its head and lifts its hands to where it is told, as well as its muscles can hold them."""
    ranges = np.array([env.model.joint(actuator.joint).range for actuator in env.manifest.actuation.actuators])
    command = env.data.ctrl.copy()
    names = [actuator.name for actuator in env.manifest.actuation.actuators]
    for name, share in (("act:left_wrist_flexion", 0.5), ("act:right_elbow", -0.2), ("act:left_eye_horizontal", -0.8)):
        command[names.index(name)] = share
    for _ in range(150):
        env.step(command)
    wanted = ranges.mean(axis=1) + command * np.ptp(ranges, axis=1) / 2
    assert np.degrees(driven_angles(env)) == pytest.approx(np.degrees(wanted), abs=3.5)


@pytest.mark.parametrize("pose", ["supine", "prone", "sitting", "standing"])
def test_a_reset_holds_the_pose_it_starts_from(env, pose):
    env.reset(options={"pose": pose})
    start = driven_angles(env)
    for _ in range(30):
        env.step(env.data.ctrl.copy())
    assert np.degrees(driven_angles(env)) == pytest.approx(np.degrees(start), abs=3.5)


def test_commands_and_torques_are_felt(env):
    command = env.np_random.uniform(-1, 1, 44).astype(np.float32)
    observation, *_ = env.step(command)
    felt = dict(zip(env.layout("proprioception"), observation["proprioception"], strict=True))
    for index, actuator in enumerate(env.manifest.actuation.actuators):
        assert felt[f"{actuator.name} command [1]"] == command[index]
        assert felt[f"{actuator.name} torque [N m]"] == pytest.approx(env.data.actuator_force[index], rel=1e-6)


def test_servos_cost_what_they_use_of_their_strength(env):
    """At rest next to nothing; all pushed as far as they can, most of the largest share, which is 1 / n."""
    env.step(env.data.ctrl.copy())
    resting = env.effort()
    env.step(-np.sign(env.data.ctrl))
    assert 0 <= resting < 0.1 / env.model.nu < env.effort() <= 1 / env.model.nu


def test_no_servo_is_stronger_than_its_motor(env, open_env):
    """Whatever is commanded, at an age and strength that the spec gives."""
    actuation = {"strength": {"arms": 0.5}, "strength_age_months": 3}
    scene = {"kind": "flat", "pose": "supine"}
    servos = open_env(actuation={**actuation, "model": "position"}, scene=scene)
    motors = open_env(actuation=actuation, scene=scene)
    assert servos.actuation.limits_nm == pytest.approx(motors.actuation.limits_nm, rel=1e-8)
    low, high = servos.actuation.limits_nm.T
    servos.reset(seed=0)
    largest = np.zeros(len(high))
    for _ in range(50):
        servos.step(servos.np_random.choice((-1.0, 1.0), len(high)))
        torques_nm = servos.data.actuator_force
        assert ((low - 1e-9 <= torques_nm) & (torques_nm <= high + 1e-9)).all()
        largest = np.maximum(largest, np.abs(torques_nm))
    assert (largest > 0.5 * high).all()
