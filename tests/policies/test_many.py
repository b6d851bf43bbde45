"""Policies of many infants."""

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import mimoc
from mimoc.base.errors import KindError, PolicyError
from mimoc.policies.named import policy_of
from mimoc.policies.policy import start_again
from mimoc.schema.kinds import POLICIES, PolicyKind

AGES_MONTHS = (1, 3, 7)
MANY = [name for name in POLICIES if POLICIES[name].many]
SENSES = {"proprioception": {}, "vestibular": {}, "touch": {"density": 0.3}}


@pytest.fixture(scope="module", params=["muscle", "torque", "position"])
def bundles(request, built):
    scene = {"kind": "flat", "pose": "supine"}
    actuation = {"model": request.param}
    return [built(age_months=age, actuation=actuation, senses=SENSES, scene=scene) for age in AGES_MONTHS]


def alone(bundle, name, seed, steps, episode):
    """Return the actions of one infant, whose episodes end after some steps."""
    with mimoc.InfantEnv(bundle) as env:
        generator, (observation, _) = np.random.default_rng(seed), env.reset(seed=seed)
        policy, actions = policy_of(env, name), []
        for step in range(1, steps + 1):
            actions.append(policy(generator, observation))
            observation, *_ = env.step(actions[-1])
            if step % episode == 0:
                observation, _ = env.reset()
                start_again(policy)
        return np.array(actions)


def together(bundles, name, steps, episode):
    envs = mimoc.make_vec(bundles, autoreset_mode=AutoresetMode.SAME_STEP, max_episode_steps=episode)
    policy = mimoc.policy_vec(name, envs)
    generators, actions = [np.random.default_rng(seed) for seed in range(len(bundles))], []
    observations, _ = envs.reset(seed=0)
    for _ in range(steps):
        actions.append(policy(generators, observations))
        observations, _, terminated, truncated, _ = envs.step(actions[-1])
        policy.reset(terminated | truncated)
    envs.close()
    return np.array(actions)


@pytest.mark.parametrize("name", [*MANY, f"{'+'.join(MANY)}"])
def test_a_row_of_many_equals_the_single_infant_to_the_bit(bundles, name):
    rows = together(bundles, name, steps=12, episode=5)
    assert rows.dtype == np.float32
    for row, bundle in enumerate(bundles):
        assert rows[:, row].tobytes() == alone(bundle, name, row, steps=12, episode=5).tobytes()


def test_a_policy_without_many_acts_for_one_infant_after_another(built, registered):
    bundles = [built(age_months=age) for age in AGES_MONTHS]
    alone = PolicyKind("lonely", "commands at random", lambda env: policy_of(env, "random"))
    with registered(alone):
        assert together(bundles, "lonely+zero", 3, 9).tobytes() == together(bundles, "random", 3, 9).tobytes()


def test_a_policy_that_cannot_act_is_refused():
    with pytest.raises(KindError, match="'still' has nothing that acts; give `run` or `many`"):
        PolicyKind("still", "does nothing")


def test_a_function_from_an_environment_acts_for_many(built):
    envs = mimoc.make_vec(built(), num_envs=2)
    policy = mimoc.policy_vec(lambda env: lambda generator, seen: env.actuation.high, envs)
    assert (policy([np.random.default_rng(0)] * 2, envs.reset(seed=0)[0]) == 1).all()
    envs.close()


def test_only_environments_of_mimocs_have_policies():
    with pytest.raises(PolicyError, match=r"expected a vector environment of mimoc\.make_vec, got"):
        mimoc.policy_vec("random", {})


@pytest.mark.slow
def test_rows_equal_single_infants_that_grow():
    """All reflexes and the law of movement follow: Moro's is gone at nine months, where protective ones have come."""
    keys = {"mimoc": 1, "name": "infant", "actuation": {"model": "muscle"}, "senses": SENSES}
    specs = [mimoc.InfantSpec.model_validate({**keys, "age_months": age}) for age in (1, 3)]
    older, name, steps = (9.0, 2.5), "general_movements+reflexes", 4
    envs, expected = mimoc.make_vec(specs), []
    policy, generators = mimoc.policy_vec(name, envs), [np.random.default_rng(seed) for seed in range(2)]
    observations, _ = envs.reset(seed=0)
    rows = []
    for step in range(2 * steps):
        if step == steps:
            observations = envs.grow(older)
        rows.append(policy(generators, observations))
        observations, *_ = envs.step(rows[-1])
    envs.close()
    for row, spec in enumerate(specs):
        env = mimoc.make(spec).unwrapped
        generator, alone = np.random.default_rng(row), policy_of(env, name)
        observation, _ = env.reset(seed=row)
        for step in range(2 * steps):
            if step == steps:
                observation = env.grow(older[row])
            expected.append(alone(generator, observation))
            observation, *_ = env.step(expected[-1])
        env.close()
    assert np.array(rows).swapaxes(0, 1).tobytes() == np.array(expected).tobytes()
