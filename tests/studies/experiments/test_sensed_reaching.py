"""Reaches by a controller that knows only what an infant's proprioception tells it."""

from contextlib import closing
from operator import attrgetter

import numpy as np
import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.motion.hand_movement import UNIT_M_S, Movement
from mimoc.studies.experiments.late_reaches import DELAYS, infant_of_age
from mimoc.studies.experiments.sensed_reaching import (
    TOUCHED_M,
    SensedController,
    place_in_front,
    reach_once,
)


@pytest.fixture(scope="module")
def undelayed() -> mimoc.Bundle:
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


MEASURES = (attrgetter("jerk"), attrgetter("arc_length"))


def minimum_jerk(distance_m: float = 0.2, duration_s: float = 1.0, steps: int = 400) -> np.ndarray:
    """Return a straight movement of minimum jerk (Flash & Hogan 1985), shape (n, 3)."""
    share = np.linspace(0, 1, steps + 1)
    along = 10 * share**3 - 15 * share**4 + 6 * share**5
    return distance_m * along[:, None] * np.array([0.6, 0.0, 0.8])


def test_a_movement_of_minimum_jerk_has_the_known_value():
    assert Movement(minimum_jerk(), 1 / 400).jerk == pytest.approx(-np.log(720 / 1.875**2), abs=0.03)


def test_the_spectrum_of_a_bell_is_nearly_as_short_as_can_be():
    """SPARC of a movement of minimum jerk is about -1.4 (Balasubramanian et al. 2015)."""
    assert Movement(minimum_jerk(steps=100), 0.01).arc_length == pytest.approx(-1.4, abs=0.1)


@pytest.mark.parametrize("measure", MEASURES)
@given(distance_m=st.floats(0.01, 2))
def test_size_makes_no_difference(measure, distance_m):
    assert measure(Movement(minimum_jerk(distance_m), 0.01)) == pytest.approx(
        measure(Movement(minimum_jerk(), 0.01)), abs=1e-6
    )


@given(duration_s=st.floats(0.2, 5))
def test_duration_makes_no_difference_to_jerk(duration_s):
    slow = Movement(minimum_jerk(), duration_s / 400).jerk
    assert slow == pytest.approx(Movement(minimum_jerk(), 1 / 400).jerk, abs=1e-6)


@pytest.mark.parametrize("measure", MEASURES)
@given(tremor_m=st.floats(0.002, 0.05), tremors_hz=st.floats(3, 8))
def test_a_tremor_is_less_smooth(measure, tremor_m, tremors_hz):
    smooth = minimum_jerk(steps=100)
    shaking = smooth + tremor_m * np.sin(2 * np.pi * tremors_hz * np.arange(101) / 100)[:, None]
    assert measure(Movement(shaking, 0.01)) < measure(Movement(smooth, 0.01))


@pytest.mark.parametrize("measure", MEASURES)
def test_what_does_not_move_has_no_smoothness(measure):
    assert np.isnan(measure(Movement(np.ones((50, 3)), 0.01)))
    assert np.isnan(measure(Movement(minimum_jerk()[:3], 0.01)))


def in_a_row(paths: list[np.ndarray]) -> np.ndarray:
    """Return movements one after another, each from where the one before ended."""
    ends = np.cumsum([np.zeros(3), *(path[-1] for path in paths)], axis=0)
    return np.concatenate([path[1:] + end for path, end in zip(paths, ends, strict=False)])


@given(st.lists(st.floats(0.05, 0.3), min_size=1, max_size=6))
def test_every_movement_that_starts_and_stops_is_a_unit(distances_m):
    path = in_a_row([minimum_jerk(distance_m, steps=40) for distance_m in distances_m])
    assert Movement(path, 0.01).units == len(distances_m)


def test_a_movement_that_is_cut_off_at_its_target_is_still_a_unit():
    assert Movement(minimum_jerk(steps=40)[:25], 0.01).units == 1


@given(st.floats(0.0, 0.9 * UNIT_M_S), st.floats(1, 6))
def test_ripples_of_less_than_the_least_change_of_speed_are_not_counted(height_m_s, cycles):
    speeds = 0.3 + height_m_s / 2 * np.sin(2 * np.pi * cycles * np.linspace(0, 1, 200))
    path = np.cumsum(speeds * 0.01)[:, None] * np.array([1.0, 0.0, 0.0])
    assert Movement(path, 0.01).units == 1


@given(st.floats(0, np.pi))
def test_the_path_ratio_of_an_arc_is_its_length_by_its_chord(half_rad):
    angles = np.linspace(-half_rad, half_rad, 500) if half_rad < 3 else np.linspace(-3, 3, 500)
    arc = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    half = angles[-1]
    if half > 0.01:
        assert Movement(arc, 0.01).path_ratio == pytest.approx(half / np.sin(half), rel=1e-3)
