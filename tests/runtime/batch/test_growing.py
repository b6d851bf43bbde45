"""Infants that grow side by side live as they do alone."""

from functools import partial

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from support import store
from support.same import assert_same

import mimoc
from mimoc.runtime.batch.vector_env import BatchEnv
from mimoc.runtime.opening.environments import open_infant

NOISE = {"motor": 0.1, "delay_jitter_ms": 10}


def bundle(age_months: float = 6, **keys) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "senses": {"proprioception": {}, "vestibular": {}}}
    return store.built({**spec, **keys})


@pytest.mark.full
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_an_infant_that_grows_gives_what_it_gives_alone_in_the_wrapper(mode):
    """Mid-episode and across episodes, with physiological delays, which change their length."""
    infant = bundle(delays={"preset": "physiological"}, noise=NOISE, task={"kind": "reach", "steps": 5})
    schedule = mimoc.growth_schedule("grown", (6, 9), 12, stage_months=1.0)
    alone = SyncVectorEnv(
        [lambda: mimoc.GrowthWrapper(mimoc.make(infant), schedule)] * 2,
        autoreset_mode=mode,
        observation_mode="different",
    )
    together = BatchEnv([partial(open_infant, infant)] * 2, autoreset_mode=mode, schedule=schedule)
    assert_same(together.reset(seed=3), alone.reset(seed=3), "reset")
    together.action_space.seed(0)
    ages = set()
    for step in range(15):
        actions = together.action_space.sample()
        ours = together.step(actions)
        assert_same(ours, alone.step(actions), f"step {step}")
        ages |= set(ours[-1]["age_months"].tolist())
    assert ages == {6.0, 7.0, 8.0, 9.0}
    together.close()
    alone.close()


def test_infants_grow_to_one_age_or_to_one_each_in_the_midst_of_an_episode():
    many, alone = mimoc.make_vec([bundle(6), bundle(9)], 3), [mimoc.make(bundle(age)) for age in (6, 9, 6)]
    many.reset(seed=1)
    for seed, env in enumerate(alone, start=1):
        env.reset(seed=seed)
    many.action_space.seed(0)
    for ages in ([7, None, 24], [12] * 3):
        observation = many.grow(12 if ages == [12] * 3 else ages)
        actions = many.action_space.sample()
        stepped = many.step(actions)
        for index, (env, age) in enumerate(zip(alone, ages, strict=True)):
            own = env.unwrapped.grow(to=age) if age is not None else None
            if own is not None:
                assert all(np.array_equal(observation[name][index], own[name]) for name in own)
            own = env.step(actions[index])[0]
            assert all(np.array_equal(stepped[0][name][index], own[name]) for name in own)
        many_ages = [12.0] * 3 if ages == [12] * 3 else [7.0, 9.0, 24.0]
        assert stepped[-1]["age_months"].tolist() == many_ages
    many.close()


def test_a_reset_gives_each_infant_an_age():
    many = mimoc.make_vec(bundle(6), 3)
    _, info = many.reset(seed=0, options={"age_months": [8, None, 10.5]})
    assert info["age_months"].tolist() == [8, 6, 10.5]
    many.close()


@pytest.mark.parametrize("ages", [25, [6, 7], [6, 7, "old"]])
def test_wrong_ages_are_refused(ages):
    many = mimoc.make_vec(bundle(6), 3)
    many.reset(seed=0)
    with pytest.raises(ValueError, match=r"24 months|one value"):
        many.grow(ages)
    many.close()
