import dataclasses

import numpy as np
import pytest

from mimoc.base.errors import UnknownNameError
from mimoc.policies.rollout import Run
from mimoc.policies.spec import needs_argument
from mimoc.schema.kinds import POLICIES


def summary(env, policy="random", seed=0, steps=50):
    """Return what happened in a run, without the time it took."""
    run = Run(env, policy, seed)
    for _ in range(steps):
        run.step()
    return dataclasses.replace(run.summary(), wall_s=0)


@pytest.mark.parametrize(
    "policy", [name for name, kind in POLICIES.items() if not needs_argument(kind) and name != "look_around"]
)
def test_the_same_seed_gives_the_same_numbers(open_env, policy):
    assert summary(open_env(), policy, seed=7) == summary(open_env(), policy, seed=7)


def test_another_seed_gives_other_numbers(env):
    assert summary(env, seed=1) != summary(env, seed=2)


def test_an_environment_can_run_again(env):
    first = summary(env)
    assert summary(env, "zero") != first
    assert summary(env) == first


def test_a_run_is_summed_up(env):
    run = Run(env, "random", seed=0)
    heads = []
    for _ in range(20):
        run.step()
        heads.append(env.data.body("head").xipos[2])
    told = run.summary()
    assert (told.steps, told.episodes, told.total_reward, told.unstable) == (20, 1, 0.0, False)
    assert told.simulated_s == pytest.approx(0.2)
    assert told.wall_s > 0
    assert told.head_height_m == (min(heads), max(heads))
    assert heads[-1] == pytest.approx(env.data.geom("head").xpos[2], abs=0.05)
    assert told.metrics == {}


def test_episodes_that_come_to_their_end_are_told_of(open_env):
    told = summary(open_env(task={"kind": "reach", "steps": 25}), "zero", steps=60)
    assert (told.episodes, told.finished, told.successes, told.time_to_success_s) == (3, 2, 0, None)
    assert -25 < told.mean_return < 0


def test_successes_and_the_time_to_them_are_told_of(open_env):
    """A hand that waves about hits the ball now and then; slow muscles would make it wave less."""
    env = open_env(age_months=18, development="published", task={"kind": "reach", "steps": 1000})
    told = summary(env, steps=1500)
    assert 1 <= told.successes <= told.finished
    assert 0 < told.time_to_success_s < 10
    assert told.mean_return > 0


def test_a_policy_acts_on_what_it_observes(env):
    seen = []

    def watching(env):
        still = np.zeros(env.action_space.shape, np.float32)
        return lambda generator, observation: [seen.append(observation), still][1]

    summary(env, watching, steps=3)
    assert [each.keys() for each in seen] == [env.observation_space.spaces.keys()] * 3
    assert (seen[0]["proprioception"] != seen[2]["proprioception"]).any()


@pytest.mark.parametrize(("development", "calmer"), [("published", 0.1), ("maturing", 0.25)])
def test_nothing_commanded_is_calmer_than_anything(open_env, development, calmer):
    """Without commands, limbs only settle. Slow muscles follow commands that change at each step by a third as far."""
    env = open_env(development=development, scene={"kind": "flat", "pose": "supine"})
    zero, random = summary(env, "zero", steps=200), summary(env, "random", steps=200)
    assert zero.joint_speed_rad_s < calmer * random.joint_speed_rad_s
    assert zero.hip_path_m < calmer * random.hip_path_m


def test_a_simulation_that_breaks_down_begins_another_episode(env):
    run = Run(env, "zero", seed=0)
    run.step()
    env.data.qvel[:] = np.nan
    run.step()
    run.step()
    told = run.summary()
    assert (told.steps, told.episodes, told.unstable) == (3, 2, True)
    assert np.isfinite((told.total_reward, told.hip_path_m, *told.head_height_m)).all()


def test_an_unknown_policy_is_refused(env):
    with pytest.raises(UnknownNameError, match="'rnadom' is not a policy; did you mean 'random'"):
        Run(env, "rnadom", seed=0)
