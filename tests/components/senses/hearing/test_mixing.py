"""Sounds reach the ears later, weaker and at the times of Woodworth's formula, in blocks that nobody hears."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from mimoc.base.geometry.spherical_head import SOUND_M_S, interaural_time_s
from mimoc.components.senses.hearing.listener import MAX_SOURCES, Mixer, Source
from mimoc.components.senses.hearing.sounds import Head, Timbre

RATE_HZ = 24_000.0
CENTRE_M = np.array([0.0, 0.0, 0.05])
NOISE = np.random.default_rng(0).normal(size=1200)
azimuths_deg = st.floats(-180, 180)


def world(turn_rad: float = 0.0) -> Any:
    """Return the data of a world with a head, body 1, that is turned to its left."""
    cosine, sine = np.cos(turn_rad), np.sin(turn_rad)
    turned = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1.0]])
    return SimpleNamespace(xpos=np.zeros((2, 3)), xmat=np.stack([np.eye(3), turned]).reshape(2, 9))


def mixer_of(*sources: Source, radius_m: float = 0.066) -> Mixer:
    mixer = Mixer(Head(radius_m, RATE_HZ), 1, CENTRE_M)
    mixer.add(sources)
    return mixer


def source(
    what: Any, azimuth_deg: float = 0.0, distance_m: float = 1.0, start: float = 0.0, gain: float = 1.0
) -> Source:
    """Return a source around the centre of the head, in the world."""
    angle = np.radians(azimuth_deg)
    return Source(what, gain, start, 0, CENTRE_M + distance_m * np.array([np.cos(angle), np.sin(angle), 0.0]))


def lag_s(left: np.ndarray, right: np.ndarray) -> float:
    """Return how much later the right ear hears, by the peak of the cross-correlation, refined by a parabola."""
    size = 4 * len(left)
    spectrum = np.conj(np.fft.rfft(left, size)) * np.fft.rfft(right, size)
    correlation = np.roll(np.fft.irfft(spectrum, size), 100)[:201]
    peak = int(correlation.argmax())
    before, at, after = correlation[peak - 1 : peak + 2]
    return (peak - 100 + 0.5 * (before - after) / (before - 2 * at + after)) / RATE_HZ


@settings(max_examples=60)
@given(azimuths_deg, st.floats(0.05, 0.09), st.floats(0.3, 3))
def test_the_lag_between_the_ears_is_woodworths_in_every_direction_and_for_every_head(
    azimuth_deg, radius_m, distance_m
):
    mixer = mixer_of(source(NOISE, azimuth_deg, distance_m), radius_m=radius_m)
    left, right = mixer.mix(world(), 0, 2000)
    aside_rad = np.arcsin(np.sin(np.radians(azimuth_deg)))
    wanted_s = np.sign(aside_rad) * interaural_time_s(abs(aside_rad), radius_m)
    assert lag_s(left, right) == pytest.approx(wanted_s, abs=0.5 / RATE_HZ)


@given(azimuths_deg, st.lists(st.integers(1, 300), min_size=1, max_size=8))
def test_sounds_in_blocks_of_any_length_are_the_same_as_in_one(azimuth_deg, counts):
    whole = mixer_of(source(NOISE, azimuth_deg)).mix(world(), 0, sum(counts))
    blocks, mixer = [], mixer_of(source(NOISE, azimuth_deg))
    for end, count in zip(np.cumsum(counts), counts, strict=True):
        blocks.append(mixer.mix(world(), int(end) - count, count))
    assert np.concatenate(blocks, axis=1) == pytest.approx(whole, abs=1e-6 * np.abs(whole).max() + 1e-12)


@given(st.floats(-20, 20))
def test_nothing_clicks_where_blocks_meet_while_the_head_turns(turns_per_s):
    """The largest step from sample to sample is that of the tone itself, whichever way the head turns."""
    hz, gain = 300.0, 1e3
    mixer, heard = mixer_of(source(Timbre("tone", hz, 300.0), gain=gain)), []
    for block in range(25):
        turn = 2 * np.pi * turns_per_s * 0.01 * (block + 1)
        heard.append(mixer.mix(world(turn), 240 * block, 240))
    steps_pa = np.abs(np.diff(np.concatenate(heard, axis=1)))
    steepest_pa = 2.2 * gain * 20e-6 * np.sqrt(2) * 2 * np.pi * hz / RATE_HZ
    assert steps_pa.max() < 1.3 * steepest_pa


@given(azimuths_deg, st.floats(0.2, 5))
def test_amplitude_falls_with_distance_and_sound_takes_its_time(azimuth_deg, distance_m):
    click = np.zeros(400)
    click[100] = 1.0
    near, far = (mixer_of(source(click, azimuth_deg, d)).mix(world(), 0, 1200) for d in (distance_m, 2 * distance_m))
    assert np.sqrt((near**2).sum() / (far**2).sum()) == pytest.approx(2, rel=0.05)
    later = far[0].argmax() - near[0].argmax()
    assert later == pytest.approx(RATE_HZ * distance_m / SOUND_M_S, abs=1.5)


@pytest.mark.parametrize("kind", ["voice", "tone", "impact"])
@pytest.mark.parametrize("hz", [80.0, 500.0, 3000.0])
def test_a_source_has_its_level_at_1_metre(kind, hz):
    """From the front of a head so small that it is not in the way."""
    lasting_ms = 400.0
    mixer = mixer_of(source(Timbre(kind, hz, lasting_ms), gain=1e3), radius_m=1e-3)
    heard = mixer.mix(world(), 0, 12_000)[0]
    over_s = 0.125 if kind == "impact" else lasting_ms / 1000
    level_db = 10 * np.log10((heard**2).sum() / RATE_HZ / over_s / 20e-6**2)
    assert level_db == pytest.approx(60, abs=0.8)


def test_sounds_add_up_end_and_are_at_most_so_many():
    one, other = source(NOISE, 40), source(NOISE[::-1].copy(), -120, start=300)
    apart = sum(mixer_of(single).mix(world(), 0, 1000) for single in (one, other))
    mixer = mixer_of(one, other)
    assert mixer.mix(world(), 0, 1000) == pytest.approx(apart, rel=1e-5, abs=1e-6)
    mixer.mix(world(), 1000, 1000)
    assert mixer.sources == []
    mixer.add([source(NOISE, start=2000, gain=float(gain)) for gain in range(2 * MAX_SOURCES)])
    assert [kept.gain for kept in mixer.sources] == list(range(MAX_SOURCES, 2 * MAX_SOURCES))


def test_a_source_on_the_left_is_louder_on_the_left_at_high_frequencies_only():
    shares = {}
    for hz in (150.0, 6000.0):
        left, right = mixer_of(source(Timbre("tone", hz, 100.0), 90)).mix(world(), 0, 2400)
        shares[hz] = 20 * np.log10(np.abs(left).max() / np.abs(right).max())
    assert shares[150.0] < 2
    assert shares[6000.0] > 10
