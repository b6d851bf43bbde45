import numpy as np
import pytest

import mimoc
from mimoc.base.errors import TrainingError, UnknownNameError


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
