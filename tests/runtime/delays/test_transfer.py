"""Signals on their way when delays change: those that there is room for stay, and none overtakes another."""

import mujoco
import numpy as np
from hypothesis import assume, given, settings, strategies as st
from support.slider import MODEL, MOTORS

from mimoc.runtime.delays.schedule import Schedule
from mimoc.runtime.delays.signals import Timing
from mimoc.runtime.noise import NoiseStreams
from mimoc.runtime.sense import Vector
from mimoc.schema.senses import DelayEntry, NoiseEntry


class Clocks(Vector):
    """The time, as a trunk and a leg tell it."""

    def __init__(self):
        super().__init__("clock", ("trunk [s]", "leg [s]"), 0.0, 100.0, np.array([1, 2]))

    def __call__(self, data):
        return np.full(2, data.time)


def schedule(period: int, delay: int, legs: int | None, jitter: int, streams: NoiseStreams) -> Schedule:
    entry = DelayEntry(ms=delay, legs_ms=legs and delay + legs)
    noise = NoiseEntry(delay_jitter_ms=jitter)
    timing = Timing(period, 1, {"clock": entry, "motor": entry}, ("leg",), noise)
    return Schedule({"clock": Clocks()}, MOTORS, MODEL, timing, streams)


delays = st.integers(1, 12)
legs = st.none() | st.integers(1, 5)
"""How much later the signals of the leg are, if they are."""


@settings(max_examples=15)
@given(st.integers(1, 5), delays, legs, delays, legs, st.integers(0, 4), st.integers(0, 99))
def test_observations_keep_their_order_and_reach_their_new_delay(period, first, leg, then, leg_then, jitter, seed):
    assume(jitter == 0 or (leg is None) == (leg_then is None))  # Else each leg had a jitter of its own.
    streams, data = NoiseStreams(seed), mujoco.MjData(MODEL)
    before, after = (schedule(period, *each, jitter, streams) for each in ((first, leg), (then, leg_then)))
    before.reset(data)
    told, commanded = [], []

    def live(running: Schedule, steps: int) -> None:
        for _ in range(steps):
            number = len(told) + 1.0
            running.step([number, number], data)
            told.append(running.observe()["clock"].copy())
            commanded.append(data.ctrl.copy())

    live(before, 12)
    after.carry_on(before, data)
    live(after, 24)
    assert (np.diff(np.array(told), axis=0) >= -1e-9).all()
    assert (np.diff(np.array(commanded), axis=0) >= 0).all()
    late_ms = np.rint(1e3 * (data.time - told[-1]))
    wanted = np.array([then, then + (leg_then or 0)])
    assert (np.abs(late_ms - wanted) <= jitter).all()


@settings(max_examples=15)
@given(st.integers(1, 5), delays, legs, st.integers(0, 99))
def test_the_same_delays_change_nothing(period, delay, leg, seed):
    found = []
    for carries in (False, True):
        streams, data = NoiseStreams(seed), mujoco.MjData(MODEL)
        running = schedule(period, delay, leg, 0, streams)
        running.reset(data)
        told = []
        for number in range(24):
            if carries and number == 12:
                former, running = running, schedule(period, delay, leg, 0, streams)
                running.carry_on(former, data)
            running.step([number, number], data)
            told.append(np.concatenate([running.observe()["clock"], data.ctrl]))
        found.append(told)
    assert np.array_equal(*found)


def test_what_has_not_been_taken_yet_is_left_to_the_former_schedule():
    """The schedule of the age before can go on by itself, as when growing fails."""
    streams, data = NoiseStreams(0), mujoco.MjData(MODEL)
    before, after = (schedule(2, 6, 8, 0, streams), schedule(2, 3, 3, 0, streams))
    before.reset(data)
    state = before.state
    after.carry_on(before, data)
    after.step([1, 1], data)
    assert str(before.state) == str(state)
