"""Policies that need no training act for each infant of a world as for one that is alone."""

import numpy as np
import pytest
from support.store import built
from support.worlds import ANNA, BEN, placed, world

from mimoc.base.errors import UnknownNameError
from mimoc.policies.many import policy_vec
from mimoc.policies.named import policy_of
from mimoc.policies.policy_file import interface_of
from mimoc.policies.rollout import Run, rollout
from mimoc.runtime.opening.environments import open_infant
from mimoc.runtime.world_env import WorldEnv


@pytest.mark.parametrize("policy", ["random", "zero", "general_movements", "reflexes", "general_movements+reflexes"])
def test_a_policy_commands_what_it_does_alone(policy):
    shared = WorldEnv(placed({"anna": ANNA, "ben": BEN}, {"y_cm": 0}, {"y_cm": 500}))
    alone = open_infant(built(ANNA))
    observation, _ = alone.reset(seed=3)
    observations, _ = shared.reset(seed=3)
    one, another = policy_of(alone, policy), policy_of(shared.infants["anna"], policy)
    for generators in ((np.random.default_rng(5), np.random.default_rng(5)),):
        for _ in range(5):
            action, commanded = one(generators[0], observation), another(generators[1], observations["anna"])
            assert np.allclose(action, commanded, rtol=0, atol=1e-5)
            observation, *_ = alone.step(action)
            observations, *_ = shared.step({"anna": commanded, "ben": shared.infants["ben"].rest})


def test_a_policy_that_was_trained_alone_fits_an_infant_in_a_world():
    shared = WorldEnv(world(anna=ANNA, ben=BEN))
    assert interface_of(shared.infants["anna"]) == interface_of(open_infant(built(ANNA)))


def test_a_run_is_summed_up_for_each_infant():
    run = Run(WorldEnv(world(anna=ANNA, ben=BEN)), "general_movements", seed=1)
    for _ in range(10):
        run.step()
    summaries = run.summaries()
    assert summaries.keys() == {"anna", "ben"}
    for summary in summaries.values():
        assert (summary.steps, summary.episodes, summary.unstable) == (10, 1, False)
        assert summary.joint_speed_rad_s > 0.05
    assert summaries["anna"].joint_speed_rad_s != summaries["ben"].joint_speed_rad_s


def test_a_policy_that_there_is_not_is_refused():
    with pytest.raises(UnknownNameError, match="'dance' is not a policy"):
        Run(WorldEnv(world(anna=ANNA, ben=BEN)), "dance", seed=0)


def test_policies_of_all_infants_take_the_form_of_their_environment():
    """By name in a world, with a policy for one of them; single ones for one infant; rows in a vector environment."""
    shared, alone = WorldEnv(world(anna=ANNA, ben=BEN)), open_infant(built(ANNA))
    observations, _ = shared.reset(seed=3)
    observation, _ = alone.reset(seed=3)
    act = policy_vec({"anna": "general_movements"}, shared)
    actions = act({name: np.random.default_rng(5) for name in shared.agents}, observations)
    single = policy_vec("general_movements", alone)
    assert (actions["anna"] == single(np.random.default_rng(5), observation)).all()
    assert (actions["ben"] == shared.infants["ben"].rest).all()
    act.reset(["ben"])
    single.reset()
    with pytest.raises(UnknownNameError, match="'kim' is not a name of an infant"):
        policy_vec({"kim": "zero"}, shared)


def test_a_rollout_yields_the_start_of_each_episode_and_its_steps(open_env):
    env = open_env(task={"kind": "reach", "steps": 3})
    steps = list(rollout(env, "random", episodes=2, seed=7))
    assert [(step.episode, step.number, step.ended) for step in steps] == [
        *((0, number, number == 3) for number in range(4)),
        *((1, number, number == 3) for number in range(4)),
    ]
    again = list(rollout(env, "random", episodes=1, seed=8))
    assert [step.reward for step in again] == [step.reward for step in steps[4:]]
    assert len([*rollout(env, "random", seconds=0.05)]) == len([*rollout(env, "random", steps=5)]) == 7
