import dataclasses
import os
import shutil
import zipfile

import numpy as np
import pytest
from support.worlds import ANNA, world

import mimoc
import mimoc.training
from mimoc.base.errors import PolicyError, TrainingError, UnknownNameError
from mimoc.policies import policy_file
from mimoc.policies.named import policy_of
from mimoc.policies.rollout import Run
from mimoc.runtime.world_env import WorldEnv


@pytest.fixture
def policy(trained):
    return trained / "policy.zip"


def infant(bundle):
    return mimoc.InfantEnv(bundle)


def rewritten(source, target, **members):
    """Copy a zip file, with other content for some of its members; None leaves one out."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            if members.get(name, b"") is not None:
                new.writestr(name, members.get(name) or old.read(name))
    return target


def test_a_policy_is_deterministic_and_its_actions_are_in_range(bundle, policy):
    env = infant(bundle)
    act, generator = mimoc.load_policy(policy)(env), np.random.default_rng(0)
    observation, _ = env.reset(seed=3)
    action = act(generator, observation)
    np.testing.assert_array_equal(action, act(np.random.default_rng(1), observation))
    assert env.action_space.contains(action)
    assert generator.bit_generator.state == np.random.default_rng(0).bit_generator.state
    moved, *_ = env.step(np.ones_like(action))
    assert (act(generator, moved) != action).any()


def test_an_infant_runs_under_a_policy(bundle, policy):
    run = Run(infant(bundle), mimoc.load_policy(policy), seed=0)
    for _ in range(70):
        run.step()
    summary = run.summary()
    assert summary.finished >= 2
    assert summary.mean_return is not None
    assert summary.successes <= summary.finished == summary.episodes - 1


def test_a_policy_file_has_the_statistics_of_the_observations(bundle, policy):
    """Variations below the floor are not amplified."""
    act = mimoc.load_policy(policy)(infant(bundle))
    mean, deviation = act.act.args[1]["proprioception"]
    assert deviation.min() >= 0.01
    observation = {"proprioception": (mean + 1e9).astype(np.float32)}
    assert np.isfinite(act(np.random.default_rng(0), observation)).all()


def test_loading_a_policy_runs_no_code_from_its_file(bundle, policy, tmp_path):
    """Stable-Baselines3 would unpickle `data`."""
    hostile = rewritten(policy, tmp_path / "hostile.zip", data=b'{"policy_class": {":serialized:": "gASVAAAA"}}')
    assert mimoc.load_policy(hostile)(infant(bundle))


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        (
            {"senses": {"vestibular": {}}},
            "observation 'proprioception' is missing here; observation 'vestibular' was not there in training",
        ),
        (
            {"senses": {"proprioception": {"include": ["velocity"]}}},
            r"'proprioception' had shape \(295,\) in training and has",
        ),
        ({"task": {"kind": "free"}}, "the action commanded 8 actuators in training and commands 44 here"),
        (
            {"task": {"kind": "reach", "hand": "left"}},
            "element 0 of the action was act:right_shoulder_horizontal in training and is ",
        ),
        ({"actuation": {"model": "muscle"}}, "'proprioception' had shape"),
    ],
)
def test_the_policy_of_another_infant_is_refused_and_the_differences_are_named(built, policy, keys, said):
    with pytest.raises(PolicyError, match=f"trained for a different infant, 'reaching': .*{said}"):
        mimoc.load_policy(policy)(infant(built(**keys)))


def test_a_policy_can_be_used_by_infants_of_other_ages(built, policy):
    assert mimoc.load_policy(policy)(infant(built(age_months=9)))


@pytest.mark.parametrize("load", [mimoc.load_policy, mimoc.training.load_policy], ids=["mimoc", "training"])
def test_a_file_is_read_once(policy, load, monkeypatch):
    opened, read = [], policy_file.read_regular_file
    monkeypatch.setattr(policy_file, "read_regular_file", lambda *args: opened.append(args[0]) or read(*args))
    load(policy)
    assert opened == [policy]


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(PolicyError, match="there is no such file"):
        mimoc.load_policy(tmp_path / "policy.zip")


@pytest.mark.parametrize("content", [b"", b"junk", b"PK\x05\x06" + bytes(18)])
def test_a_file_that_is_not_a_policy_is_refused(tmp_path, content):
    (tmp_path / "policy.zip").write_bytes(content)
    with pytest.raises(PolicyError, match="not a policy trained by mimoc"):
        mimoc.load_policy(tmp_path / "policy.zip")


@pytest.mark.parametrize("member", ["mimoc.json", "scale.npz", "weights.npz"])
@pytest.mark.parametrize("content", [None, b"{}", b"junk"])
def test_a_damaged_policy_is_refused(policy, tmp_path, member, content):
    with pytest.raises(PolicyError, match="not a policy trained by mimoc, or it is damaged"):
        mimoc.load_policy(rewritten(policy, tmp_path / "policy.zip", **{member: content}))


def test_a_policy_of_an_earlier_version_is_to_be_trained_again(policy, tmp_path):
    with zipfile.ZipFile(policy) as archive:
        about = archive.read("mimoc.json").replace(b'"policy": 2', b'"policy": 1')
    earlier = rewritten(policy, tmp_path / "policy.zip", **{"mimoc.json": about, "weights.npz": None})
    with pytest.raises(PolicyError, match="was saved by another version of mimoc; train it again"):
        mimoc.load_policy(earlier)


def test_a_policy_can_be_moved(bundle, policy, tmp_path):
    shutil.copy(policy, tmp_path / "mine.zip")
    assert mimoc.load_policy(tmp_path / "mine.zip")(infant(bundle))
    assert os.listdir(tmp_path) == ["mine.zip"]


def test_a_trained_policy_in_a_sum_with_nothing_is_the_same_to_the_bit(bundle, policy):
    env, generator = infant(bundle), np.random.default_rng(0)
    observation, _ = env.reset(seed=3)
    alone, beside = mimoc.load_policy(policy)(env), policy_of(env, f"{policy}+zero", mimoc.load_policy)
    assert beside(generator, observation).tobytes() == alone(generator, observation).tobytes()
    assert beside.steps_per_episode == alone.steps_per_episode


@pytest.fixture(scope="module")
def env(bundle):
    return mimoc.make(bundle)


def test_an_evaluation_repeats_itself(env):
    first, second = (mimoc.evaluate(env, "random", episodes=3, seed=5) for _ in range(2))
    assert first == second
    assert [each.seed for each in first] == [5, 6, 7]


def test_each_episode_has_its_own_seed_whatever_came_before(env):
    alone = mimoc.evaluate(env, "random", episodes=1, seed=6)
    assert alone == mimoc.evaluate(env, "random", episodes=3, seed=5)[1:2]


def test_an_episode_tells_what_happened(env):
    still = mimoc.evaluate(env, "zero", episodes=1)[0]
    assert (still.steps, still.duration_s, still.success) == (30, pytest.approx(0.3), False)
    assert -30 < still.total_reward < 0


def test_a_body_is_followed(env):
    episode = mimoc.evaluate(env, "random", episodes=1, follow="right_fingers")[0]
    assert episode.path_m.shape == (episode.steps + 1, 3)
    env.reset(seed=0)
    np.testing.assert_allclose(episode.path_m[0], env.unwrapped.data.body("right_fingers").xpos)
    assert np.linalg.norm(np.diff(episode.path_m, axis=0), axis=1).min() > 0


def test_an_unknown_body_or_policy_is_refused(env):
    with pytest.raises(UnknownNameError, match="did you mean 'right_fingers'"):
        mimoc.evaluate(env, "zero", episodes=1, follow="right_finger")
    with pytest.raises(UnknownNameError, match="'reech' is not a policy"):
        mimoc.evaluate(env, "reech", episodes=1)


def test_episodes_without_an_end_are_refused(built):
    with pytest.raises(TrainingError, match="the episodes of 'reaching' do not end"):
        mimoc.evaluate(mimoc.make(built(task={"kind": "free"})), "zero", episodes=1)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
def test_episodes_side_by_side_are_those_one_after_another(env, built, mode):
    """To the bit, also where there are fewer left than infants, and where policies draw and remember."""
    envs = mimoc.make_vec(built(), num_envs=3, autoreset_mode=mode)
    for policy in ("random", "general_movements+reflexes"):
        alone = mimoc.evaluate(env, policy, episodes=5, seed=2, follow="right_fingers", steps_per_episode=12)
        beside = mimoc.evaluate(envs, policy, episodes=5, seed=2, follow="right_fingers", steps_per_episode=12)
        assert [dataclasses.replace(one, path_m=None) for one in alone] == [
            dataclasses.replace(one, path_m=None) for one in beside
        ]
        assert all((one.path_m == other.path_m).all() for one, other in zip(alone, beside, strict=True))
    ends = [one.steps for one in mimoc.evaluate(envs, "random", episodes=4)]
    assert ends == [one.steps for one in mimoc.evaluate(env, "random", episodes=4)]
    envs.close()


def test_infants_of_a_world_have_their_own_episodes():
    """Infant i draws what it does alone with the seed of the episode + i; a policy can be for one of them."""
    shared = WorldEnv(world(anna=ANNA, ben=ANNA))
    both = mimoc.evaluate(shared, "random", episodes=2, seed=4, follow="left_hand", steps_per_episode=3)
    assert [one.seed for one in both["anna"]] == [4, 5] == [one.seed for one in both["ben"]]
    one = mimoc.evaluate(shared, {"ben": "random"}, episodes=1, seed=5, follow="left_hand", steps_per_episode=3)
    assert (one["ben"][0].path_m == both["ben"][1].path_m).all(), "anna has not touched him yet"
    assert np.ptp(one["anna"][0].path_m, axis=0).max() < np.ptp(both["anna"][1].path_m, axis=0).max()
    with pytest.raises(UnknownNameError, match="'bne' is not a name of an infant of this world; did you mean 'ben'"):
        mimoc.evaluate(shared, {"bne": "random"}, episodes=1, steps_per_episode=3)
    with pytest.raises(TrainingError, match="the episodes of 'anna' do not end"):
        mimoc.evaluate(shared, "zero", episodes=1)


def test_worlds_side_by_side_have_the_episodes_of_one_world():
    """Episode i is of world i % n, and the result is by infant, to the bit."""
    pair = world(anna=ANNA, ben=ANNA)
    options = {"episodes": 3, "seed": 4, "follow": "left_hand", "steps_per_episode": 3}
    one = mimoc.evaluate(WorldEnv(pair), "general_movements", **options)
    envs = mimoc.make_vec(pair, num_envs=4)
    both = mimoc.evaluate(envs, "general_movements", **options)
    assert [*both] == [*one] == ["anna", "ben"]
    for name in one:
        assert all((a.path_m == b.path_m).all() for a, b in zip(one[name], both[name], strict=True))
    envs.close()
