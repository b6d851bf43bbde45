"""Adapting receptors of the skin: what they make of forces over time, alone, together and in an infant."""

import array_api_strict as strict
import numpy as np
import pytest
from hypothesis import given, strategies as st
from support import store

import mimoc
from mimoc.components.senses.touch.adaptation import adapting, stroking
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import NUMPY

CHANNELS = ("sa1", "ra", "pc")


def felt(forces_n, step_s=0.01, channels=CHANNELS):
    """Return what the channels make of a force at one point over time, which begins with nothing, by channel."""
    term, state, responses = stack_terms([adapting(channels, 1)]), None, []
    for force_n in (0.0, *forces_n):
        response, state = term(NUMPY, step_s, np.array([[force_n]]), state)
        responses.append(response[0])
    return dict(zip(channels, np.array(responses)[1:].T, strict=True))


@pytest.mark.parametrize("step_s", [0.005, 0.01, 0.02])
@pytest.mark.parametrize("force_n", [0.1, 1.0, 20.0])
def test_a_steady_force_is_felt_three_times_at_first_then_as_it_is_then_less(force_n, step_s):
    sa1 = felt(np.full(round(12 / step_s), force_n), step_s)["sa1"] / force_n
    assert sa1[0] == pytest.approx(3, abs=0.15)
    assert sa1[round(0.6 / step_s)] == pytest.approx(1, abs=0.07)
    assert sa1[-1] == pytest.approx(0.7, abs=0.01)
    assert (np.diff(sa1) <= 1e-6).all()


def test_rapidly_adapting_receptors_are_silent_soon_and_feel_the_end():
    ra = felt([1.0] * 100 + [0.0] * 100)["ra"]
    assert ra[0] > 0.85
    assert ra[15] < 0.08
    assert ra[99] < 1e-3
    assert ra[100] > 0.85


@pytest.mark.parametrize(("frequency_hz", "gain"), [(0.3, 0.1), (3.0, 0.707), (20.0, 0.99)])
def test_rapidly_adapting_receptors_feel_what_is_faster_than_3_hz(frequency_hz, gain):
    times_s = np.arange(0, 10, 0.002)
    ra = felt(5 + np.sin(2 * np.pi * frequency_hz * times_s), 0.002)["ra"]
    assert ra[-3000:].max() == pytest.approx(gain, abs=0.01)


def test_onsets_are_felt_once():
    assert felt([0, 2, 3, 0, 0, 1])["pc"].tolist() == [0, 2, 0, 0, 0, 1]


@given(st.lists(st.sampled_from([0.0, 0.0, 0.0, 1e-5, 0.5, 4.0]), min_size=1, max_size=30), st.integers(0, 5))
def test_points_that_nothing_touches_are_left_out_without_a_difference(forces_n, seed):
    """One infant's touched points are as all points of many are, by the array API as well."""
    channels, points = (*CHANNELS, "ct"), 4
    term, one, many, standard = stack_terms([adapting(channels, 2)]), None, None, None
    twice = stack_terms([adapting(channels, 2)] * 2, strict.asarray)
    shares = np.random.default_rng(seed).uniform(0, 1, (len(forces_n), 1, points, 2))
    for force_n, share in zip(forces_n, shares, strict=True):
        sample = (force_n * share * (share[..., :1] > 0.5)).reshape(1, -1)
        single, one = term(NUMPY, 0.01, sample, one)
        both, many = term(NUMPY, 0.01, np.repeat(sample, 2, axis=0), many)
        others, standard = twice(strict, 0.01, strict.asarray(np.repeat(sample, 2, axis=0)), standard)
        assert both == pytest.approx(np.repeat(single, 2, axis=0), rel=1e-5, abs=1e-5)
        assert np.asarray(others) == pytest.approx(both, rel=1e-5, abs=1e-6)


@given(st.floats(1e-4, 10), st.floats(1e-4, 10))
def test_stroking_is_felt_most_at_3_cm_per_second(one, other):
    assert stroking(np.array(0.03)) == pytest.approx(1)
    assert stroking(np.array([0.003, 0.3])) == pytest.approx([1 / 16, 1 / 16], rel=1e-6)
    near, far = sorted((one, other), key=lambda speed: abs(np.log(speed / 0.03)))
    assert stroking(np.array(near)) >= stroking(np.array(far))


def infant(**touch) -> mimoc.InfantEnv:
    spec = {"mimoc": 1, "name": "infant", "age_months": 6, "scene": {"kind": "flat", "pose": "supine"}}
    return mimoc.InfantEnv(store.built({**spec, "senses": {"touch": {"density": 0.3, **touch}}}))


def test_an_infant_feels_by_its_channels_what_its_pressure_was():
    env, plain = infant(channels=["sa1", "ra", "pc", "ct"]), infant(quantity="normal")
    observation, pressure = env.reset(seed=0)[0]["touch"], plain.reset(seed=0)[0]["touch"]
    assert env.observation_space["touch"].shape == (4 * len(pressure),)
    assert observation.reshape(4, -1)[0] == pytest.approx(0.7 * pressure, rel=1e-4)
    rng = np.random.default_rng(0)
    for _ in range(30):
        action = rng.uniform(-1, 1, env.action_space.shape).astype(np.float32)
        observation, pressure = env.step(action)[0]["touch"], plain.step(action)[0]["touch"]
    sa1, ra, pc, ct = observation.reshape(4, -1)
    pressed = pressure > 0
    assert (ra[pressed] > 0).all()
    assert (pc[~pressed] == 0).all()
    assert (ct[~pressed] == 0).all()
    assert ct.max() <= 1
    assert ct.max() > 0
    hairless = [index for index, name in enumerate(env.layout("touch")[: len(ct)]) if "hand" in name or "foot" in name]
    assert (ct[hairless] == 0).all()
    assert sa1[pressed].max() > 0


def test_channels_are_of_pressure_and_are_explained():
    env = infant(channels=["ra"])
    assert env.manifest.senses.touch.quantity == "normal"
    assert env.layout("touch")[0].endswith(" ra [N]")
