"""Noise that changes gradually has the mean, the deviation and the time constant that it says."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from mimoc.runtime.array_library import NUMPY
from mimoc.runtime.noise import BandLimited, Draw, LowPass, MotorNoise, NoiseStreams, Smooth

COUNT = 40_000
TOLERANCE = 5 / math.sqrt(COUNT)
"""Five standard errors of a mean."""

times_s = st.floats(1e-4, 0.5)
seeds = st.integers(0, 2**32)


def generator(seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


@settings(max_examples=20)
@given(times_s, times_s, seeds)
def test_values_correlate_by_the_time_between_them_however_it_is_divided(elapsed_s, constant_s, seed):
    noise, draws = LowPass(constant_s), generator(seed)
    before = noise(None, math.inf, draws.standard_normal(COUNT))
    between = noise(before, elapsed_s / 3, draws.standard_normal(COUNT))
    after = noise(between, elapsed_s * 2 / 3, draws.standard_normal(COUNT))
    for values in (before, after):
        assert abs(values.mean()) < TOLERANCE
        assert values.var() == pytest.approx(1, abs=2 * TOLERANCE)
    assert (before * after).mean() == pytest.approx(math.exp(-elapsed_s / constant_s), abs=2 * TOLERANCE)


@settings(max_examples=20)
@given(times_s, times_s, seeds)
def test_smooth_noise_keeps_its_deviation_and_that_of_its_rate(elapsed_s, constant_s, seed):
    noise, draws = Smooth(constant_s), generator(seed)
    before = noise(NUMPY, None, math.inf, draws.standard_normal((1, 2 * COUNT)))
    values, rates = noise(NUMPY, before, elapsed_s, draws.standard_normal((1, 2 * COUNT))).reshape(2, COUNT)
    assert abs(values.mean()) < TOLERANCE
    assert values.var() == pytest.approx(1, abs=2 * TOLERANCE)
    assert rates.var() == pytest.approx(1, abs=2 * TOLERANCE)
    assert (values * rates).mean() == pytest.approx(0, abs=2 * TOLERANCE)


def test_the_rate_of_smooth_noise_is_its_derivative():
    """Over a tenth of a second, by the trapezoidal rule."""
    noise, draws, step_s, state, steps = Smooth(0.06), generator(0), 0.0001, None, []
    for _ in range(1001):
        state = noise(NUMPY, state, step_s, draws.standard_normal((1, 2 * 50)))
        steps.append(state.reshape(2, 50))
    values, rates = np.stack(steps, axis=1)
    walked = step_s / 0.06 * (rates[1:] + rates[:-1]).sum(axis=0) / 2
    assert walked == pytest.approx(values[-1] - values[0], abs=0.01)


def test_every_value_is_independent_of_the_others():
    noise, draws, values, steps = LowPass(0.06), generator(1), None, []
    for _ in range(COUNT):
        values = noise(values, 0.06, draws.standard_normal(4))
        steps.append(values)
    assert np.corrcoef(np.transpose(steps)) == pytest.approx(np.eye(4), abs=3 * TOLERANCE)


@pytest.mark.full
@settings(max_examples=20)
@given(st.floats(0.3, 12.0), st.floats(2.0, 8.0))
def test_a_command_arrives_with_the_share_of_two_filters_of_first_order(command_hz, cut_off_hz):
    """1 / (1 + (f / cut-off)²) of a sinusoid at a frequency f, sampled in time steps of .5 ms."""
    still = MotorNoise(np.zeros(1), -np.ones(1), np.ones(1), LowPass(0.06))
    follow = BandLimited(still, np.array([2 * np.pi * cut_off_hz]))
    draw, state, arrived = Draw(NUMPY, 0.0005, np.zeros), None, []
    times_s = np.arange(0, max(2.0 / command_hz, 0.5) + 1.0, 0.0005)
    for time_s in times_s:
        controls, state = follow(draw, np.sin(2 * np.pi * command_hz * np.array([[time_s]])), state)
        arrived.append(controls[0, 0])
    last = np.array(arrived)[times_s > times_s[-1] - 1.0 / command_hz]
    assert np.abs(last).max() == pytest.approx(1 / (1 + (command_hz / cut_off_hz) ** 2), rel=0.03)


def test_commands_beyond_their_range_do_not_arrive_sooner():
    follow = BandLimited(MotorNoise(np.zeros(1), -np.ones(1), np.ones(1), LowPass(0.06)), np.array([30.0]))
    draw = Draw(NUMPY, 0.01, np.zeros)
    _, state = follow(draw, np.zeros((1, 1)), None)
    (first, _), (second, _) = follow(draw, np.ones((1, 1)), state), follow(draw, 5 * np.ones((1, 1)), state)
    assert first == second
    assert 0 < first.item() < 0.1


channels = st.sampled_from(["motor", "touch", "jitter.touch", "jitter.motor", "proprioception"])


@given(st.integers(-1, 2**128 - 1), st.lists(channels, max_size=10), channels)
def test_what_other_channels_draw_changes_nothing(seed, others, channel):
    alone, among = NoiseStreams(seed), NoiseStreams(seed)
    for other in others:
        if other != channel:
            among[other].random(3)
    assert alone[channel].random(5).tolist() == among[channel].random(5).tolist()


@given(st.integers(0, 99), st.lists(channels, max_size=5), st.lists(channels, min_size=1, max_size=5))
def test_streams_go_on_from_a_state_whatever_was_drawn_in_between(seed, before, after):
    streams = NoiseStreams(seed)
    for channel in before:
        streams[channel].random()
    state = streams.state
    drawn = [streams[channel].random() for channel in after]
    other = NoiseStreams(seed + 1)
    other["motor"].random()
    for each in (streams, other):
        each.state = state
        assert [each[channel].random() for channel in after] == drawn


def test_seeds_and_channels_differ():
    one, other = NoiseStreams(1), NoiseStreams(2)
    assert len({one["touch"].random(), one["motor"].random(), other["touch"].random()}) == 3
