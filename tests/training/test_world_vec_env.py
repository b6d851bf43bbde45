"""Stable-Baselines3 learns one policy with all infants of worlds."""

import json

import numpy as np
import pytest
from stable_baselines3 import PPO
from support.worlds import ANNA, BEN, world

import mimoc
from mimoc.base.errors import TrainingError
from mimoc.runtime.batch.gymnasium_forms import BatchMismatchError
from mimoc.runtime.world_env import WorldEnv

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
