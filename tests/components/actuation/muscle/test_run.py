"""Muscles as the runtime commands and feels them."""

import numpy as np
import pytest

import mimoc

MUSCLE = {"model": "muscle"}


@pytest.fixture(params=["mitten", "five_finger"])
def env(request, open_env):
    env = open_env(actuation=MUSCLE, body={"hands": request.param}, scene={"kind": "flat", "pose": "sitting"})
    env.reset(seed=0)
    return env


def test_actions_have_the_range_of_activations(env):
    space = env.action_space
    assert space.shape == (env.model.nu,)
    assert (space.low == 0).all()
    assert (space.high == 1).all()


def test_the_manifest_says_which_two_muscles_stand_for_each_of_mimos_actuators(env, open_env):
    plain = open_env(body={"hands": "mitten" if env.model.nu == 88 else "five_finger"})
    muscles = env.manifest.actuation.actuators
    mimos = [(actuator.name, actuator.joint) for actuator in plain.manifest.actuation.actuators]
    assert [(muscle.mimo_actuator, muscle.joint) for muscle in muscles] == [pair for pair in mimos for _ in range(2)]
    assert [muscle.name for muscle in muscles] == [
        f"{name}_{way}" for name, _ in mimos for way in ("negative", "positive")
    ]


def test_activations_and_forces_are_felt(env):
    for _ in range(10):
        observation, *_ = env.step(env.np_random.uniform(0, 1, env.model.nu))
    felt = dict(zip(env.layout("proprioception"), observation["proprioception"], strict=True))
    for index, muscle in enumerate(env.manifest.actuation.actuators):
        assert felt[f"{muscle.name} activation [1]"] == pytest.approx(env.data.act[index])
        torque_nm = env.data.actuator_force[index] * env.model.actuator_gear[index, 0]
        assert felt[f"{muscle.name} torque [N m]"] == pytest.approx(torque_nm, rel=1e-6)
        assert torque_nm * (-1 if muscle.name.endswith("negative") else 1) >= 0


def test_readings_stay_within_their_bounds_without_being_clipped(env):
    bounds = env.observation_space["proprioception"].high[-2 * env.model.nu :]
    for _ in range(100):
        observation, *_ = env.step(env.np_random.choice([0.0, 1.0], env.model.nu))
        felt = np.abs(observation["proprioception"][-2 * env.model.nu :])
        assert (felt[env.model.nu :] < 0.9 * bounds[env.model.nu :]).all()
        assert (felt <= bounds).all()


def test_effort_is_the_mean_square_activation_weighted_by_strength(env):
    assert env.effort() == 0
    for _ in range(100):
        env.step(np.full(env.model.nu, 0.5))
    assert env.effort() == pytest.approx(0.25 / env.model.nu, rel=1e-6)
    limits = np.abs(list(mimoc.torque_limits(env.bundle).values())).ravel()
    activation = env.np_random.uniform(0, 1, env.model.nu)
    for _ in range(100):
        env.step(activation)
    assert env.effort() == pytest.approx(activation**2 @ limits / (env.model.nu * limits.sum()), rel=1e-4)


def test_a_limp_infant_stays_limp(env):
    """No muscle pulls by itself, so nothing moves an infant that lies on its back but its weight."""
    env.reset(options={"pose": "supine"})
    for _ in range(50):
        _, _, terminated, _, _ = env.step(np.zeros(env.model.nu))
    assert not terminated
    assert not env.data.act.any()
    assert np.abs(env.data.actuator_force).max() < 0.02 * env.model.actuator_gainprm[:, 2].max()


def test_a_co_contracted_elbow_resists_a_push(open_env):
    """Muscles that pull alike hold it where it is, and a push moves it less than half as far as a limp one."""
    env = open_env(actuation=MUSCLE, scene={"kind": "empty"})
    elbow = env.model.joint("robot:left_elbow")
    pair = [env.model.actuator(f"act:left_elbow_{way}").id for way in ("negative", "positive")]
    strength = env.model.actuator_gainprm[pair, 2]

    def moved_rad(activation, push_nm):
        env.reset()
        env.data.qpos[elbow.qposadr[0]] = elbow.range.mean()
        env.data.qfrc_applied[elbow.dofadr[0]] = push_nm
        command = np.zeros(env.model.nu)
        command[pair] = env.data.act[pair] = activation * strength.min() / strength
        for _ in range(10):
            env.step(command)
        return abs(float(env.data.qpos[elbow.qposadr[0]] - elbow.range.mean()))

    assert moved_rad(0.8, 0.0) < 0.02
    assert moved_rad(0.8, 0.3) < 0.5 * moved_rad(0.0, 0.3)
