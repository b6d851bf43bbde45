"""A closed environment says so, whatever is asked of it; `tests/fuzz/lives.py` asks in processes of their own."""

import copy
import pickle
from functools import partial
from inspect import isfunction
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError
from gymnasium.vector import SyncVectorEnv

import mimoc
from mimoc.runtime.batch_env import BatchEnv
from mimoc.runtime.closing import STAYS
from mimoc.runtime.opening import open_infant

EYES = {"proprioception": {}, "touch": {"density": 0.1}, "vision": {"width_px": 16, "height_px": 16}}
SIZE = {"render_mode": "rgb_array", "width": 32, "height": 32}
READABLE = STAYS | {"layout", "call", "get_attr", "seek"}


@pytest.fixture(scope="module")
def seeing(built) -> mimoc.Bundle:
    return built(senses=EYES)


KINDS = {
    "one": lambda bundle: mimoc.make(bundle, **SIZE).unwrapped,
    "many": lambda bundle: mimoc.make_vec(bundle, 2, **SIZE),
    "growing many": lambda bundle: BatchEnv([partial(open_infant, bundle, **SIZE)], schedule=lambda _: 9.5),
}
WRAPPED = {
    "gymnasium": lambda bundle, _: mimoc.make(bundle, **SIZE),
    "vector": lambda bundle, _: SyncVectorEnv([lambda: mimoc.make(bundle, **SIZE)]),
    "recorder": lambda bundle, folder: mimoc.Recorder(mimoc.make(bundle, **SIZE), folder / "recording"),
    "recorder of many": lambda bundle, folder: mimoc.Recorder(mimoc.make_vec(bundle, 2, **SIZE), folder / "recording"),
    "monitor": lambda bundle, _: _monitored(mimoc.make(bundle, **SIZE)),
    "growing": lambda bundle, _: mimoc.GrowthWrapper(mimoc.make(bundle, **SIZE), lambda steps: 9 + steps),
}


def _monitored(env: Any) -> Any:
    from stable_baselines3.common.monitor import Monitor

    return Monitor(env)


@pytest.mark.parametrize("kind", KINDS)
def test_everything_but_reading_is_refused_when_it_is_closed(kind, seeing):
    """Whatever methods mimoc may get later, too."""
    env = KINDS[kind](seeing)
    env.reset(seed=0)
    env.close()
    methods = {name for each in type(env).__mro__ for name, method in vars(each).items() if _is_ours(each, method)}
    refused = {name for name in methods if not name.startswith("_")} - READABLE
    assert refused >= {"reset", "step", "render", "grow", "set_state"}
    for name in refused:
        with pytest.raises(ClosedEnvironmentError, match=f"this environment is closed: .* calling {name}"):
            getattr(env, name)()


def _is_ours(home: type, method: object) -> bool:
    return home.__module__.startswith("mimoc.") and isfunction(method)


@pytest.mark.parametrize(
    "kind", [*sorted(WRAPPED.keys() - {"monitor"}), pytest.param("monitor", marks=pytest.mark.extras)]
)
def test_it_is_refused_within_any_wrapper_and_closed_twice_in_silence(kind, seeing, tmp_path):
    env = WRAPPED[kind](seeing, tmp_path)
    env.reset(seed=0)
    env.close()
    env.close()
    for use in (lambda: env.step(env.action_space.sample()), env.reset, env.render):
        with pytest.raises(ClosedEnvironmentError):
            use()


@pytest.mark.extras
def test_learners_of_stable_baselines_are_refused_too(seeing):
    envs = mimoc.sb3_vec_env(seeing, 2, max_episode_steps=10)
    envs.reset()
    envs.close()
    envs.close()
    for use in (envs.reset, lambda: envs.step(np.zeros((2, *envs.action_space.shape))), envs.get_images):
        with pytest.raises(ClosedEnvironmentError):
            use()


def test_what_a_closed_environment_is_can_still_be_read(seeing):
    env = mimoc.make(seeing, **SIZE)
    env.reset(seed=0)
    infant, state = env.unwrapped, env.unwrapped.get_state()
    env.close()
    assert infant.closed
    assert infant.bundle is seeing
    assert infant.action_space.contains(infant.action_space.sample())
    assert len(infant.layout("proprioception")) == infant.observation_space["proprioception"].shape[0]
    assert infant.get_state()["physics"] == pytest.approx(state["physics"])


@pytest.mark.parametrize("by", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copy_of_a_closed_environment_is_open(by, open_env):
    env, twin = open_env(senses=EYES), open_env(senses=EYES)
    for each in (env, twin):
        each.reset(seed=0)
    env.close()
    copied = by(env)
    for _ in range(3):
        action = env.action_space.sample()
        seen, expected = copied.step(action)[0], twin.step(action)[0]
        assert all(np.array_equal(seen[name], expected[name]) for name in expected)
    copied.close()


def test_what_a_script_senses_with_is_closed_once(seeing):
    class Clock:
        space = gymnasium.spaces.Box(0, np.inf, (1,))
        closed = 0

        def __call__(self, data):
            return [data.time]

        def close(self):
            self.closed += 1

    clock = Clock()
    env = mimoc.make(seeing, senses={"clock": clock})
    env.close()
    env.close()
    assert clock.closed == 1


def test_one_closed_infant_of_many_is_missed(seeing):
    envs = mimoc.make_vec(seeing, 2)
    envs.reset(seed=0)
    envs.infants[1].close()
    with pytest.raises(ClosedEnvironmentError):
        envs.step(envs.action_space.sample())
    envs.close()
