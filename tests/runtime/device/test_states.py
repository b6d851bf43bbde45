"""Going on from a state of infants on MuJoCo Warp is the same as not having left it."""

import copy
import pickle

import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError
from support import store
from support.devices import DEVICE, WARP_DEVICE, random_actions

import mimoc
from mimoc.runtime.device.arrays import put
from mimoc.runtime.device.episodes import InitialStates

EXACT = WARP_DEVICE == "cpu"
"""Whether sums do not depend on the order of threads."""
SPEC = {
    "mimoc": 1,
    "name": "infant",
    "senses": {
        "proprioception": {"include": ["velocity", "torque"]},
        "vestibular": {"canals": "age"},
        "touch": {"density": 0.5},
    },
    "delays": {"preset": "physiological"},
    "task": {"kind": "reach"},
}
NOISE = {"motor": 0.2, "proprioception_deg": 2.0, "touch_n": 0.5}


def infant(age_months: float, **keys: object) -> mimoc.Bundle:
    return store.built({**SPEC, "age_months": age_months, **keys})


@pytest.fixture(scope="module")
def envs():
    """Infants whose episodes end in the midst of what is done with them."""
    bundles = [infant(1, noise=NOISE), infant(12, noise={**NOISE, "delay_jitter_ms": 10})]
    made = mimoc.make_vec(bundles, 3, device=DEVICE, starts=3, max_episode_steps=4)
    yield made
    made.close()


def commands(envs, count: int, seed: int = 0) -> list[np.ndarray]:
    generator = np.random.default_rng(seed)
    return [random_actions(envs, generator) for _ in range(count)]


def lived(envs, actions) -> list:
    """Return what is observed, earned and ended while acting."""
    steps = [envs.step(action) for action in actions]
    return [{**seen, "reward": reward, "ended": term | cut} for seen, reward, term, cut, _ in steps]


def assert_same_life(ours, theirs):
    for step, (mine, others) in enumerate(zip(ours, theirs, strict=True)):
        for name in others:
            errors = np.abs(mine[name].astype(float) - others[name])
            assert (errors == 0).all() if EXACT else np.quantile(errors, 0.95) < 1e-3, (step, name)


def test_going_on_from_a_state_is_the_same_as_not_having_left(envs):
    """With noise, jitter, delays, arousal, ends of episodes, and after other things have been done."""
    envs.reset(seed=3, options={"arousal": [0.2, None, 1.5]})
    actions = commands(envs, 9)
    lived(envs, actions[:3])
    states = pickle.loads(pickle.dumps(envs.get_state()))
    expected = lived(envs, actions[3:])
    assert any(step["ended"].any() for step in expected)
    envs.set_state(states)
    assert_same_life(lived(envs, actions[3:]), expected)
    envs.reset(seed=8)
    envs.set_arousal(0.7)
    lived(envs, actions[:2])
    seen = envs.set_state(states)
    again = envs.get_state()
    assert envs.observation_space.contains(seen)
    assert_same_life(lived(envs, actions[3:]), expected)
    assert [state["physics"]["qpos"].tolist() for state in again] == [s["physics"]["qpos"].tolist() for s in states]


def test_a_state_brings_its_age_and_starts_without_seeds_go_on_as_well(envs):
    envs.reset(seed=3)
    actions = commands(envs, 4, seed=1)
    lived(envs, actions[:2])
    states = envs.get_state()
    starts = envs.reset()[0]["proprioception"]
    envs.set_state(states)
    expected = lived(envs, actions[2:])
    envs.grow([5, None, 9])
    lived(envs, actions[:1])
    envs.set_state(states)
    assert [state["age_months"] for state in envs.get_state()] == [1, 12, 1]
    assert_same_life(lived(envs, actions[2:]), expected)
    envs.set_state(states)
    assert (envs.reset()[0]["proprioception"] == starts).all()


def test_the_state_of_one_infant_can_be_given_to_others(make):
    envs = make(infant(9), 3, starts=3)
    envs.reset(seed=0)
    lived(envs, commands(envs, 3))
    envs.set_state([envs.get_state()[1]] * 3)
    action = np.repeat(commands(envs, 1)[0][:1], 3, axis=0)
    for name, values in lived(envs, [action])[0].items():
        assert values == pytest.approx(np.stack([values[1]] * 3), abs=0 if EXACT else 1e-3), name
    envs.close()
    assert len(envs.get_state()) == 3
    with pytest.raises(ClosedEnvironmentError):
        envs.set_state([])


def changed(states, *path, to):
    """Return states in which something of the second one is another; None leaves it out."""
    states = copy.deepcopy(states)
    inner = states[1]
    for name in path[:-1]:
        inner = inner[name]
    if to is None:
        del inner[path[-1]]
    else:
        inner[path[-1]] = to
    return states


def test_what_is_no_state_is_refused_and_changes_nothing(envs):
    envs.reset(seed=3)
    lived(envs, commands(envs, 2))
    states = envs.get_state()
    qpos, sent = states[1]["physics"]["qpos"], states[1]["signals"]["sent"]["touch"]
    for bad, text in (
        (3, "expected a list of 3 states"),
        (states[:2], "expected a list of 3 states"),
        ([{}, {}, {}], r"states\[0\]\.physics is nothing"),
        (changed(states, "physics", "qpos", to=None), r"states\[1\]\.physics\.qpos is nothing"),
        (changed(states, "physics", "qpos", to=qpos[:-1]), r"qpos is an array of float32, shape \(\d+,\)"),
        (changed(states, "physics", "qvel", to=np.full_like(states[1]["physics"]["qvel"], np.nan)), "a NaN"),
        (changed(states, "signals", "sent", "touch", to=sent[:0]), r"states\[1\]\.signals\.sent\.touch is"),
        (changed(states, "signals", "sent", "touch", to=sent[:, 1:]), r"sent\.touch is an array"),
        (changed(states, "signals", "sent", "touch", to=[1]), r"sent\.touch is \[1\]"),
        (changed(states, "ended", to="no"), r"ended is no"),
        (changed(states, "arousal", to="much"), r"arousal is much"),
        (changed(states, "age_months", to=30.0), "age from 0 to 24"),
        (changed(states, "age_months", to=None), "not a state of an environment"),
        (changed(states, "scene_seed", to=1), "cannot change its scene"),
        ([{**states[0], "random": {**states[0]["random"], "choices": {}}}, *states[1:]], "cannot be restored"),
    ):
        with pytest.raises(ValueError, match=text):
            envs.set_state(bad)
    now = envs.get_state()
    assert all(
        (one["physics"]["qpos"] == other["physics"]["qpos"]).all() for one, other in zip(now, states, strict=True)
    )
    assert [state["age_months"] for state in now] == [1, 12, 1]


WORLDS, STARTS = 4000, 5


def starts_of(seeds: np.ndarray, episode: int) -> np.ndarray:
    """Return the starts that worlds with two bodies choose; those of the second body come after five of the first."""
    body = np.arange(len(seeds)) % 2
    starts = InitialStates(put(np.array([0, STARTS])[body]), put(np.array([STARTS, 1])[body]), {}, {}, {})
    return starts.draw(put(seeds), put(np.full(len(seeds), episode))).cpu().numpy()


def test_they_are_drawn_evenly_from_those_of_the_body():
    starts = starts_of(np.arange(WORLDS), 1)
    assert (starts[1::2] == STARTS).all()
    counts = np.bincount(starts[::2], minlength=STARTS)
    assert counts.min() > 0.85 * WORLDS / 2 / STARTS
    assert len(counts) == STARTS


def test_they_follow_from_seed_and_episode():
    seeds = np.arange(WORLDS)
    first, second = starts_of(seeds, 1), starts_of(seeds, 2)
    assert (starts_of(seeds, 1) == first).all()
    assert (starts_of(seeds + 2, 1)[:-2] == first[2:]).all()
    assert 0.1 < (first == second)[::2].mean() < 0.3
