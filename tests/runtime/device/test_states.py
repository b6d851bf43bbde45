"""States of all infants on a device: what follows one is what followed it before."""

import numpy as np
import pytest
from support.devices import WARP_DEVICE
from support.running import build

import mimoc

DEVICE = f"warp:{WARP_DEVICE}" if WARP_DEVICE == "cpu" else WARP_DEVICE


@pytest.fixture(scope="module")
def made():
    """Two infants with delays, noise, pushes that were drawn, and arousal that was set, in the middle of episodes."""
    infant = build(age_months=9, senses={"proprioception": {}, "vestibular": {}}, task={"kind": "sit", "steps": 9})
    env = mimoc.make_vec(infant, num_envs=2, device=DEVICE, starts=4)
    env.reset(seed=3, options={"arousal": [0.5, 1.5]})
    yield env, infant
    env.close()


def play(env, steps: int, seed: int):
    generator, told = np.random.default_rng(seed), []
    for _ in range(steps):
        actions = generator.uniform(-1, 1, env.action_space.shape).astype(np.float32)
        observed, reward, terminated, truncated, _ = env.step(actions)
        told.append({**observed, "reward": reward, "terminated": terminated, "truncated": truncated})
    return told


def assert_same(first, second):
    for one, other in zip(first, second, strict=True):
        for name, values in one.items():
            assert values == pytest.approx(other[name], abs=1e-6), name


@pytest.mark.slow
def test_what_follows_a_state_is_what_followed_it_here_and_elsewhere(made):
    """Also beyond the end of an episode, in the next one's start."""
    env, infant = made
    play(env, 4, 0)
    state = env.get_state()
    kept = {name: values.copy() for name, values in state.items()}
    seen = play(env, 8, 1)
    assert any(told["truncated"].any() for told in seen)
    observed = env.set_state(state)
    assert all(np.array_equal(values, kept[name]) for name, values in state.items())
    assert observed["vestibular"] == pytest.approx(kept["observation.vestibular"])
    assert_same(play(env, 8, 1), seen)
    other = mimoc.make_vec(infant, num_envs=2, device=DEVICE, starts=4)
    other.reset(seed=11)
    other.set_state(state)
    assert_same(play(other, 8, 1), seen)
    other.close()


def test_what_is_no_state_is_refused_and_changes_nothing(made):
    env, _ = made
    state = env.get_state()
    short = {**state, "data.qpos": state["data.qpos"][:1]}
    lacking = {name: values for name, values in state.items() if name != "commands.arrived"}
    broken = {**state, "data.qvel": np.full_like(state["data.qvel"], np.nan)}
    for wrong in (short, lacking, broken, [], None):
        with pytest.raises(ValueError, match="state") as refusal:
            env.set_state(wrong)
        assert "\n" not in str(refusal.value)
    now = env.get_state()
    assert all(np.array_equal(values, now[name]) for name, values in state.items())
