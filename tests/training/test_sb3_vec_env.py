"""Infants as an environment of Stable-Baselines3: what its own gives, to the bit."""

import copy
import json
import pickle

import numpy as np
import pytest
from stable_baselines3 import PPO
from stable_baselines3.common.logger import KVWriter, Logger
from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor
from support.same import assert_same
from support.worlds import ANNA, BEN, world

import mimoc
from mimoc.base.errors import TrainingError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.gymnasium_forms import BatchMismatchError
from mimoc.runtime.world_env import WorldEnv


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


ARM = {
    "mimoc": 1,
    "name": "one",
    "age_months": 9,
    "senses": {"proprioception": {"include": ["velocity"]}},
    "actuation": {"regions": ["right_arm"]},
}


class LiftHand(mimoc.Task):
    """The reward is the height of the right hand."""

    def bind(self, model, bundle):
        (arm,) = (arm for arm in bundle.manifest.anatomy.arms if arm.side == "right")
        self.hand = model.body(arm.end).id

    def judge(self, data, action, effort):
        return mimoc.Judgement({"height": float(data.xpos[self.hand, 2])})


@pytest.fixture
def lifting():
    return mimoc.make_parallel(world(anna=ARM, ben=ARM), tasks={"anna": LiftHand(steps=50), "ben": LiftHand(steps=50)})


@pytest.mark.slow
def test_ppo_learns_with_two_infants(lifting):
    envs = mimoc.world_vec_env(lifting)
    learner = PPO("MultiInputPolicy", envs, n_steps=500, batch_size=500, n_epochs=1, seed=0, device="cpu")
    before = [weights.detach().clone() for weights in learner.policy.parameters()]
    learner.learn(2000)
    assert learner.num_timesteps == 2000
    after = list(learner.policy.parameters())
    assert all(np.isfinite(weights.detach().numpy()).all() for weights in after)
    assert any(
        not np.array_equal(one.numpy(), other.detach().numpy()) for one, other in zip(before, after, strict=True)
    )
    envs.close()


def test_rows_are_infants_and_a_world_is_reset_as_a_whole(lifting):
    twins = mimoc.make_parallel(world(anna=ARM, ben=ARM), tasks={"anna": LiftHand(steps=3), "ben": LiftHand(steps=9)})
    envs = mimoc.world_vec_env(twins, lifting)
    assert envs.num_envs == 4
    envs.seed(4)
    first = envs.reset()["proprioception"]
    actions = np.zeros((4, *envs.action_space.shape), np.float32)
    for step in range(3):
        observed, rewards, done, infos = envs.step(actions)
        assert done.tolist() == ([True, True, False, False] if step == 2 else [False] * 4)
    assert rewards.dtype == np.float32
    assert [info["TimeLimit.truncated"] for info in infos] == [True, True, False, False]
    assert not np.array_equal(infos[0]["terminal_observation"]["proprioception"], observed["proprioception"][0])
    assert np.array_equal(observed["proprioception"][:2], first[:2])
    assert envs.get_attr("age_months") == [9.0] * 4
    envs.close()


def test_infants_that_command_other_things_have_no_policy_in_common():
    with pytest.raises(BatchMismatchError):
        mimoc.world_vec_env(mimoc.make_parallel(world(anna=ARM, ben={**ARM, "actuation": {"regions": ["left_arm"]}})))
    with pytest.raises(BatchMismatchError):
        mimoc.world_vec_env(mimoc.make_parallel(world(anna=ANNA, ben={**BEN, "senses": {}})))


# A training.


def test_all_infants_of_a_world_learn_one_policy_which_is_resumed_to_the_bit(learn, learned, same, tmp_path):
    source, limit = world(anna=ARM, ben=ARM), {"task": LiftHand(), "steps_per_episode": 9}
    training = learn("whole", source=source, envs=3, **limit)
    assert (training.curve.steps, {row.episode_steps for row in training.curve.rows}) == (256, {9})
    settings = json.loads((tmp_path / "whole" / "run.json").read_text())["settings"]
    assert settings["envs"] == 4, "two whole worlds"
    assert isinstance(mimoc.read_world_bundle(tmp_path / "whole" / "bundle"), mimoc.WorldBundle)
    learn("halves", 128, source=source, envs=4, **limit)
    resumed = learn("halves", source=tmp_path / "halves" / "bundle", envs=4, **limit)
    assert resumed.resumed_at == 128
    assert same(learned(training.policy), learned(resumed.policy))
    both = mimoc.evaluate(WorldEnv(source), mimoc.load_policy(resumed.policy), episodes=1)
    assert [(name, one.steps) for name, (one,) in both.items()] == [("anna", 9), ("ben", 9)]


def test_a_world_of_a_training_grows_and_is_recorded(learn, tmp_path):
    options = {"task": LiftHand(), "steps_per_episode": 9, "grow": "9:9.5", "record": tmp_path / "recording"}
    learn("grown", 128, source=world(anna=ARM, ben=ARM), threads=1, **options)
    recording = mimoc.read_recording(tmp_path / "recording")
    assert (recording.infants, len(recording) > 10) == (2, True)
    changes = [change for episode in recording for made in episode.changes.values() for change in made]
    ages = [value for what, value in changes if what == "age_months"]
    assert 9 < max(ages) <= 9.5


def test_a_training_on_worlds_says_in_one_line_what_it_cannot(learn, tmp_path):
    balanced = mimoc.InfantSpec(**{**BEN, "senses": {"vestibular": {}}})
    with pytest.raises(BatchMismatchError, match=r"infants 0 .* and 1 .* cannot share a batch, because they differ in"):
        learn(source={"anna": mimoc.InfantSpec(**ANNA), "ben": balanced})
    for option, value in {"processes": True, "device": "warp:cpu"}.items():
        with pytest.raises(TrainingError, match=f"leave out --{option}"):
            learn(source=world(anna=ARM, ben=ARM), **{option: value})
    assert list(tmp_path.iterdir()) == []
