"""Reaches by a controller that knows only what an infant's proprioception tells it."""

from contextlib import closing

import numpy as np
import pytest

import mimoc
from mimoc.studies.experiments.late_reaches import DELAYS, infant_of_age
from mimoc.studies.experiments.sensed_reaching import TOUCHED_M, SensedController, place_in_front, reach_once


@pytest.fixture(scope="module")
def undelayed() -> mimoc.Bundle:
    """Return an infant of six months without delays or noise."""
    return mimoc.build(infant_of_age(6, "none").with_(noise=None))


def test_without_delay_and_noise_it_arrives_as_slowly_as_infants_do(undelayed):
    with closing(mimoc.InfantEnv(undelayed)) as env:
        reach = reach_once(env, 0, np.random.default_rng(1), most_s=3.0)
    assert reach.arrived
    assert reach.duration_s >= 0.4
    assert reach.speed_m_s.max() < 0.8
    travelled_m = np.linalg.norm(reach.path_m[-1] - reach.path_m[0])
    assert travelled_m == pytest.approx(reach.distance_m, abs=2 * TOUCHED_M)


def test_the_controller_acts_on_what_is_sensed_and_not_on_what_is(undelayed):
    """The same observation gives the same action, wherever the body is by then."""
    with closing(mimoc.InfantEnv(undelayed)) as env:
        observation, _ = env.reset(seed=0)
        control = SensedController(env)
        control.aim(place_in_front(env, np.random.default_rng(0)))
        action = control(observation)
        later, *_ = env.step(env.action_space.high)
        assert np.array_equal(control(observation), action)
        assert not np.array_equal(control(later), action)


@pytest.mark.parametrize("delay", DELAYS)
def test_infants_differ_in_nothing_but_age_and_delay(delay):
    young, old = infant_of_age(4, delay), infant_of_age(9, delay)
    assert young.with_(age_months=9) == old
    assert young.with_(delays=None, noise={"delay_jitter_ms": None}) == infant_of_age(4, "none")


def test_a_reach_that_is_given_up_has_not_arrived(undelayed):
    with closing(mimoc.InfantEnv(undelayed)) as env:
        reach = reach_once(env, 0, np.random.default_rng(1), most_s=0.1)
    assert not reach.arrived
    assert reach.duration_s <= 0.1
