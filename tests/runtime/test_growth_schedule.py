"""Schedules of growth, and environments that follow them."""

import gymnasium
import numpy as np
import pytest

import mimoc
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.runtime.growth_schedule import read_ages

SPEC = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"proprioception": {}}}


def ages(schedule, steps):
    return [schedule(step) for step in range(steps)]


def test_growth_goes_from_the_youngest_age_to_the_oldest_and_stays_there():
    found = ages(mimoc.growth_schedule("grown", (6, 7), steps=100), 120)
    assert sorted(set(found)) == [6, 6.25, 6.5, 6.75, 7]
    assert found == sorted(found)
    assert found[:20] == [6] * 20
    assert found[99:] == [7] * 21


def test_an_adult_has_the_oldest_age_throughout():
    assert set(ages(mimoc.growth_schedule("adult", (6, 7), steps=100), 100)) == {7}


def test_all_other_courses_have_the_same_ages_for_as_long():
    grown, back, mixed, other = (
        ages(mimoc.growth_schedule(course, (0, 24), steps=970, seed=seed), 970)
        for course, seed in (("grown", 0), ("reversed", 0), ("shuffled", 0), ("shuffled", 1))
    )
    assert back == grown[::-1]
    assert sorted(mixed) == sorted(other) == grown
    assert mixed != other
    assert mixed == ages(mimoc.growth_schedule("shuffled", (0, 24), 970, seed=np.random.default_rng(0)), 970)


@pytest.mark.parametrize(("text", "expected"), [("6:12", (6, 12)), ("0:0.5", (0, 0.5))])
def test_a_range_of_ages_is_read(text, expected):
    assert read_ages(text) == expected


@pytest.mark.parametrize("text", ["6", "6-12", "12:6", "6:25", "-1:3", "six:12", "6:6", "6:nan", ""])
def test_what_is_no_range_of_ages_is_refused(text):
    with pytest.raises(MimocError, match="range of ages"):
        read_ages(text)


def test_unknown_courses_and_impossible_numbers_are_refused():
    with pytest.raises(UnknownNameError, match="did you mean 'grown'"):
        mimoc.growth_schedule("grwn", (6, 12), steps=10)
    with pytest.raises(MimocError, match="at least one control step"):
        mimoc.growth_schedule("grown", (6, 12), steps=0)
    with pytest.raises(MimocError, match="positive number of months"):
        mimoc.growth_schedule("grown", (6, 12), steps=10, stage_months=0)


def test_an_environment_grows_with_its_steps():
    env = mimoc.GrowthWrapper(mimoc.make(mimoc.InfantSpec.model_validate(SPEC)), "grown", ages_months=(9, 9.5), steps=6)
    space = env.observation_space
    told = [env.reset(seed=0)[1]["age_months"]]
    for _ in range(4):
        observation, *_, info = env.step(env.action_space.sample())
        told.append(info["age_months"])
        assert observation in space
    told.append(env.reset()[1]["age_months"])
    told += [env.step(env.action_space.sample())[4]["age_months"] for _ in range(3)]
    assert told == [9, 9, 9, 9.25, 9.25, 9.5, 9.5, 9.5, 9.5]
    assert env.reset(options={"age_months": 3})[1]["age_months"] == 3
    env.close()


def test_only_infants_grow():
    with pytest.raises(MimocError, match=r"mimoc\.make"):
        mimoc.GrowthWrapper(gymnasium.make("CartPole-v1"), lambda step: 6.0)
