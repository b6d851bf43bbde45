"""Infants as an environment of Stable-Baselines3: what its own gives, to the bit."""

import copy
import pickle

import numpy as np
import pytest
from stable_baselines3 import PPO
from stable_baselines3.common.logger import KVWriter, Logger
from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor
from support.same import assert_same

import mimoc
from mimoc.runtime.env import InfantEnv


@pytest.fixture
def two(bundle):
    env = mimoc.sb3_vec_env(bundle, 2, threads=2)
    yield env
    env.close()


def test_it_gives_what_stable_baselines_gives_itself(two, bundle):
    """Through the ends of episodes, after 30 steps."""
    theirs = VecMonitor(DummyVecEnv([lambda: InfantEnv(bundle)] * 2))
    for env in (two, theirs):
        env.seed(3)
    assert_same(dict(two.reset()), dict(theirs.reset()))
    assert_same(two.unwrapped.reset_infos, theirs.unwrapped.reset_infos)
    actions = np.random.default_rng(0).uniform(-1, 1, (65, 2, *two.action_space.shape)).astype(np.float32)
    ended = 0
    for step, each in enumerate(actions):
        ours, other = two.step(each), theirs.step(each)
        for info in (*ours[3], *other[3]):
            info.get("episode", {}).pop("t", None)  # The wall time.
        assert_same((dict(ours[0]), *ours[1:]), (dict(other[0]), *other[1:]), f"step {step}")
        assert_same(two.unwrapped.reset_infos, theirs.unwrapped.reset_infos)
        ended += int(ours[2].sum())
    assert ended >= 4


def test_the_last_info_of_an_episode_says_what_was_seen_and_that_time_ran_out(two):
    two.seed(0)
    two.reset()
    still = np.zeros((2, *two.action_space.shape), np.float32)
    for _ in range(29):
        _, _, done, infos = two.step(still)
        assert not done.any()
        assert not any(info["TimeLimit.truncated"] for info in infos)
    observation, _, done, infos = two.step(still)
    assert done.all()
    for index, info in enumerate(infos):
        assert info["TimeLimit.truncated"] is True
        assert info["terminal_observation"]["proprioception"].shape == two.observation_space["proprioception"].shape
        assert not np.array_equal(info["terminal_observation"]["proprioception"], observation["proprioception"][index])


def test_seeds_and_options_hold_for_one_reset(two):
    two.seed(5)
    first = two.reset()
    two.step(np.zeros((2, *two.action_space.shape), np.float32))
    two.seed(5)
    two.set_options({})
    assert_same(two.reset(), first)
    assert two.unwrapped._seeds == [None, None]


def test_methods_and_attributes_of_some_infants_can_be_had(two):
    assert two.get_attr("max_steps") == [30, 30]
    assert two.env_method("effort", indices=[1]) == [0.0]
    two.set_attr("mark", 4, indices=0)
    assert two.get_attr("mark", indices=0) == [4]
    assert two.env_is_wrapped(InfantEnv) == [False, False]


def test_pictures_are_those_of_all_infants(bundle):
    env = mimoc.sb3_vec_env(bundle, 2, render_mode="rgb_array", width=32, height=24)
    env.reset()
    assert [picture.shape for picture in env.get_images()] == [(24, 32, 3)] * 2
    assert env.render().shape[2] == 3
    env.close()


def test_ppo_learns_on_infants_of_several_ages():
    spec = {"mimoc": 1, "name": "reaching", "senses": {"proprioception": {}}, "task": {"kind": "reach", "steps": 10}}
    ages = [mimoc.InfantSpec.model_validate({**spec, "age_months": age}) for age in (9, 18)]
    env = mimoc.sb3_vec_env(ages, 4)
    agent = PPO("MultiInputPolicy", env, n_steps=16, batch_size=32, n_epochs=1, device="cpu")
    heard = Heard()
    agent.set_logger(Logger(None, [heard]))
    agent.learn(64)
    assert agent.num_timesteps == 64
    assert {"rollout/ep_rew_mean", "rollout/ep_len_mean"} <= heard.names
    env.close()


class Heard(KVWriter):
    """Keeps the names of what is logged."""

    def __init__(self):
        self.names = set()

    def write(self, key_values, key_excluded, step=0):
        self.names |= key_values.keys()

    def close(self):
        pass


def test_episodes_that_nothing_ends_are_a_warning(built):
    free = built(task={"kind": "free"})
    with pytest.warns(UserWarning, match=r"logs no returns; give max_episode_steps, such as max_episode_steps=500"):
        mimoc.sb3_vec_env(free, 2).close()
    env = mimoc.sb3_vec_env(free, 2, max_episode_steps=3)
    env.reset()
    infos = [env.step(np.zeros((2, *env.action_space.shape), np.float32))[3] for _ in range(3)]
    assert [info["episode"]["l"] for info in infos[-1]] == [3, 3]
    env.close()


def test_a_copy_and_a_pickle_go_on_as_the_original(built):
    envs = mimoc.sb3_vec_env(built(), num_envs=2)
    envs.seed(3)
    envs.reset()
    actions = np.full((2, *envs.action_space.shape), 0.2, np.float32)
    envs.step(actions)
    copies = copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))
    observed, rewards, *_ = envs.step(actions)
    for one in copies:
        seen, earned, *_ = one.step(actions)
        assert all((seen[name] == observed[name]).all() for name in observed)
        assert (earned == rewards).all()
        assert (one.episode_lengths == envs.episode_lengths).all()
        one.close()
    envs.close()
