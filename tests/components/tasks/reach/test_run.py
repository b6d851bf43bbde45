"""Reaching earns the more the nearer, and a touch ends it."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import mimoc

LOOKS_RAD = np.deg2rad(3)
"""How well eyes look at the ball, where their range allows."""


@pytest.fixture(
    scope="module", params=[("mitten", "torque"), ("five_finger", "muscle"), ("mitten", "position")], ids=str
)
def env(request, built):
    hands, model = request.param
    with mimoc.InfantEnv(
        built(age_months=12, body={"hands": hands}, actuation={"model": model}, task={"kind": "reach"})
    ) as opened:
        yield opened


def gaze_error(env, looker: str) -> float:
    forward = env.data.body(looker).xmat.reshape(3, 3)[:, 0]
    towards = env.data.body("target").xpos - env.data.body(looker).xpos
    return float(np.arctan2(np.linalg.norm(np.cross(forward, towards)), forward @ towards))


def test_the_reward_is_the_distance_that_is_left(env):
    env.reset(seed=1)
    _, reward, terminated, _, info = env.step(env.action_space.sample())
    distance_m = np.linalg.norm(env.data.body("target").xpos - env.data.body(env.manifest.task.effector).xpos)
    assert reward == pytest.approx(-distance_m)
    assert info["reward_terms"] == {"distance": pytest.approx(-distance_m), "touch": 0.0}
    assert not terminated
    assert not info["is_success"]


def test_a_ball_that_moves_ends_it_with_a_reward(env):
    env.reset(seed=1)
    start = env.model.joint("target_joint").dofadr[0]
    env.data.qvel[start] = 4.0
    _, reward, terminated, _, info = env.step(np.zeros(env.action_space.shape, np.float32))
    assert terminated
    assert info["is_success"]
    assert info["reward_terms"]["touch"] == 100
    assert reward == pytest.approx(sum(info["reward_terms"].values()))


def test_an_untouched_ball_stays_where_it_hangs(env):
    env.reset(seed=2)
    before = env.data.body("target").xpos.copy()
    at_rest = np.array([env.data.ctrl[i] for i in env.actuation.actuators], np.float32)
    for _ in range(50):
        env.step(at_rest)
    assert env.data.body("target").xpos == pytest.approx(before, abs=1e-9)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_eyes_look_at_the_ball(env, seed):
    env.reset(seed=seed)
    assert gaze_error(env, "head") < np.pi / 4
    for eye in ("left_eye", "right_eye"):
        assert gaze_error(env, eye) < LOOKS_RAD or is_turned_fully(env, eye)


def is_turned_fully(env, eye: str) -> bool:
    """Return whether an eye is at an end of its range, as for a ball close to the face."""
    joints = (env.model.joint(f"robot:{eye}_{direction}") for direction in ("horizontal", "vertical"))
    ends = [np.abs(env.data.qpos[joint.qposadr[0]] - joint.range).min() for joint in joints]
    return min(ends) < np.deg2rad(0.5)


def test_eyes_follow_the_ball(env):
    env.reset(seed=3)
    joint = env.model.joint("target_joint")
    env.data.qpos[joint.qposadr[0] + 1] += 0.009
    at_rest = np.array([env.data.ctrl[i] for i in env.actuation.actuators], np.float32)
    for _ in range(40):
        env.step(at_rest)
    assert max(gaze_error(env, eye) for eye in ("left_eye", "right_eye")) < LOOKS_RAD


def test_where_the_ball_is_can_be_felt(env):
    """Head and eyes tell: other places, other joint angles."""
    seen = [env.reset(seed=seed)[0]["proprioception"] for seed in range(6)]
    names = env.layout("proprioception")
    neck = [index for index, name in enumerate(names) if ("eye" in name or "head" in name) and "angle" in name]
    assert len({tuple(reading[neck].tolist()) for reading in seen}) == 6


def test_the_places_follow_from_the_seed(env):
    places = [env.reset(seed=seed)[0] is not None and env.data.body("target").xpos.tolist() for seed in (1, 2, 1)]
    assert places[0] == places[2] != places[1]


def test_what_is_held_stays(env):
    env.reset(seed=0)
    bodies = [env.model.body(name).id for name in ("hip", "chest", "left_hand", "left_foot", "right_foot")]
    before = env.data.xpos[bodies].copy()
    generator = np.random.default_rng(0)
    for _ in range(100):
        if env.step(generator.uniform(env.action_space.low, env.action_space.high).astype(np.float32))[2]:
            break
    assert np.abs(env.data.xpos[bodies] - before).max() < 0.01
