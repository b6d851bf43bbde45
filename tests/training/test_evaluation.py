import dataclasses

import numpy as np
import pytest
from support.worlds import ANNA, world

import mimoc
from mimoc.base.errors import TrainingError, UnknownNameError
from mimoc.runtime.world_env import WorldEnv


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
