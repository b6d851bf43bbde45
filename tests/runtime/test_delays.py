"""Delays take any senses and any actuation: signals come in order, as late as is stated, and never from the future."""

from itertools import pairwise

import mujoco
import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from support.slider import MODEL, MOTORS

from mimoc.runtime.control_step import ControlStep, Schedule, Segment, merge_segments
from mimoc.runtime.delays import Delay, DelayedSamples, Timing
from mimoc.runtime.noise import NoiseStreams
from mimoc.runtime.sense import Vector
from mimoc.schema.senses import DelayEntry, NoiseEntry

PERIOD, LONG = 2, 4000
TRUNK_AND_LEG = np.array([1, 2, 1, 2])
seeds = st.integers(0, 2**32)

# One signal.


def line(length, sample):
    samples = DelayedSamples(Delay(length * PERIOD), PERIOD)
    samples.reset(sample)
    return samples


def sent(samples, items):
    arrived = []
    for item in items:
        samples.send(item)
        arrived.append(samples.arrived)
    return arrived


@given(st.integers(0, 20), st.lists(st.integers(), max_size=50))
def test_what_goes_in_comes_out_that_much_later(length, items):
    assert sent(line(length, "rest"), items) == (["rest"] * length + items)[: len(items)]


@given(st.integers(0, 5), st.lists(st.integers(), max_size=10), st.lists(st.integers(), max_size=10))
def test_a_line_goes_on_from_what_another_held(length, before, after):
    one, other = line(length, 0), line(length, -1)
    sent(one, before)
    other.state = one.state
    assert sent(one, after) == sent(other, after)


def test_a_state_is_a_list_of_its_own():
    samples = line(2, "rest")
    samples.state[0].clear()
    assert samples.state[0] == ["rest"] * 3


@settings(max_examples=30)
@given(st.integers(1, 12), seeds, st.lists(st.integers(1, 20), min_size=1, max_size=20))
def test_a_deviation_keeps_within_its_bounds_and_changes_by_a_step_at_most(most, seed, parts):
    delay = Delay(most, most, NoiseStreams(seed), "jitter.touch")
    delay.reset()
    found = [delay.deviation, *(value - most for part in parts for value in delay.advance(part))]
    assert len(found) == 1 + sum(parts)
    assert max(map(abs, found)) <= most
    assert np.abs(np.diff(found)).max() <= 1


@pytest.mark.parametrize("most", [1, 2, 4])
def test_all_deviations_are_equally_likely_so_that_the_mean_is_zero(most):
    delay, count = Delay(most, most, NoiseStreams(0), "jitter.touch"), 30_000
    delay.reset()
    counts = np.bincount(np.array(delay.advance(count)), minlength=2 * most + 1)
    assert counts / count == pytest.approx(1 / (2 * most + 1), rel=0.15)


def test_a_deviation_begins_anywhere():
    delay, begun = Delay(2, 2, NoiseStreams(0), "jitter.touch"), set()
    for _ in range(100):
        delay.reset()
        begun.add(delay.deviation)
    assert begun == {-2, -1, 0, 1, 2}


# Schedules of control steps, with physics steps of 1 ms.


class Clock(Vector):
    """The time, as the trunk and the leg tell it, and the controls of both; and how often it was read."""

    def __init__(self, bodies=None):
        super().__init__("clock", ("time [s]", "time of the leg [s]", "trunk", "leg"), 0.0, 100.0, bodies)
        self.reads = 0

    def __call__(self, data):
        self.reads += 1
        return np.array([data.time, data.time, *data.ctrl])


def scheduled(
    period: int, jitter: int = 0, streams: NoiseStreams | None = None, bodies=TRUNK_AND_LEG, **delays: DelayEntry | int
) -> tuple[Schedule, Clock]:
    entries = {name: DelayEntry(ms=delay) if isinstance(delay, int) else delay for name, delay in delays.items()}
    timing, clock = Timing(period, 1, entries, ("leg",), NoiseEntry(delay_jitter_ms=jitter)), Clock(bodies)
    return Schedule({"clock": clock}, MOTORS, MODEL, timing, streams or NoiseStreams(0)), clock


def opened(*arguments, **keys) -> tuple[Schedule, mujoco.MjData, Clock]:
    """Return a schedule after a reset."""
    (schedule, clock), data = scheduled(*arguments, **keys), mujoco.MjData(MODEL)
    schedule.reset(data)
    return schedule, data, clock


def step(schedule: Schedule, data: mujoco.MjData, trunk: float, leg: float | None = None) -> None:
    """Make a control step with the commands of both motors."""
    action = [trunk, trunk if leg is None else leg]
    ControlStep({"": schedule}, {"": data})({"": schedule.controls(action, data)})


def times_ms(schedule: Schedule, data: mujoco.MjData, clock: Clock, number: int = 0) -> list[int]:
    """Return what is observed of the time at a reset and after four control steps."""
    found = [schedule.observe()["clock"]]
    for _ in range(4):
        step(schedule, data, 1)
        found.append(schedule.observe()["clock"])
    return [round(1000 * float(each[number])) for each in found]


@pytest.mark.parametrize("delay_ms", range(10))
def test_a_sense_that_is_passed_has_the_delay_that_is_given_under_its_name(delay_ms):
    assert times_ms(*opened(4, clock=delay_ms)) == [max(step - delay_ms, 0) for step in (0, 4, 8, 12, 16)]


def test_a_signal_that_is_not_named_has_no_delay():
    assert times_ms(*opened(4)) == [0, 4, 8, 12, 16]


def test_a_longer_delay_of_the_legs_is_that_of_the_numbers_measured_there():
    late = DelayEntry(ms=0, legs_ms=6)
    assert times_ms(*opened(4, clock=late), 0) == [0, 4, 8, 12, 16]
    assert times_ms(*opened(4, clock=late), 1) == [0, 0, 2, 6, 10]
    assert times_ms(*opened(4, clock=late, bodies=None), 1) == [0, 4, 8, 12, 16]


def test_commands_to_the_leg_arrive_when_they_are_due():
    schedule, data, _ = opened(4, motor=DelayEntry(ms=0, legs_ms=6))
    seen = []
    for command in (1, 2, 3):
        step(schedule, data, command)
        seen.append(data.ctrl.tolist())
    assert seen == [[1, 0], [2, 1], [3, 2]]


def test_a_delay_between_physics_steps_is_refused():
    with pytest.raises(ValueError, match=r"1\.5 ms is 1\.50 steps of 1 ms; the nearest that works is 2 ms"):
        opened(4, clock=DelayEntry(ms=1.5))


CUTS = st.lists(st.integers(1, 9), unique=True).map(sorted)


def segments(cuts: list[int]) -> list[Segment]:
    """Return the segments of a control step of ten physics steps that is cut at some of them."""
    return [Segment((), end - start, ()) for start, end in pairwise([0, *cuts, 10])]


@given(st.dictionaries(st.sampled_from(["anna", "ben", "kim"]), CUTS, min_size=1))
def test_every_segment_begins_and_ends_once_at_its_time(infants):
    of_infants = {name: segments(cuts) for name, cuts in infants.items()}
    time, begun, ended = 0, {name: [] for name in infants}, {name: [] for name in infants}
    for part in merge_segments(of_infants):
        for name, segment in part.begun:
            assert time == sum(earlier.physics_steps for earlier in begun[name])
            begun[name].append(segment)
        assert part.physics_steps > 0
        time += part.physics_steps
        for name, segment in part.ended:
            ended[name].append(segment)
            assert time == sum(earlier.physics_steps for earlier in ended[name])
    assert time == 10
    assert begun == ended == of_infants


# Delays that vary.


def lateness_ms(schedule: Schedule, data: mujoco.MjData, count: int) -> np.ndarray:
    """Return how late the observation after each control step is."""
    found = []
    for _ in range(count):
        step(schedule, data, 0)
        found.append(1000 * (data.time - schedule.observe()["clock"][0]))
    return np.rint(found).astype(int)


@settings(max_examples=60)
@given(st.integers(1, 6), st.integers(1, 9), st.integers(1, 9), seeds)
def test_observations_are_late_within_bounds_and_in_order(period, delay, jitter, seed):
    schedule, data, clock = opened(period, jitter, NoiseStreams(seed), clock=delay)
    late = lateness_ms(schedule, data, 60)
    began = -(-(delay + jitter) // period)
    most = min(jitter, delay)
    assert late[began:].min() >= delay - most
    assert late.max() <= delay + most
    sampled_at = period * np.arange(1, 61) - late
    assert (np.diff(sampled_at) >= 0).all()
    assert sampled_at.min() >= 0
    assert clock.reads <= 1 + 60 + (delay + most) // period + 1


@pytest.mark.parametrize(("period", "delay", "jitter"), [(2, 6, 2), (4, 3, 2), (1, 5, 1)])
def test_the_mean_delay_is_the_stated_one(period, delay, jitter):
    late = lateness_ms(*opened(period, jitter, clock=delay)[:2], LONG)
    deviation = np.sqrt(jitter * (jitter + 1) / 3)
    assert late[10:].mean() == pytest.approx(delay, abs=0.1)
    assert late[10:].std() == pytest.approx(deviation, abs=0.1)


def controls(period: int, jitter: int, delay: int, seed: int, count: int) -> np.ndarray:
    """Return the number of the command that is applied at each physics step, -1 before the first arrives."""
    schedule, data, _ = opened(period, jitter, NoiseStreams(seed), motor=delay)
    data.ctrl[:], found = -1, []
    mujoco.set_mjcb_control(lambda model, data: found.append(data.ctrl.copy()))
    try:
        for number in range(count):
            step(schedule, data, number)
    finally:
        mujoco.set_mjcb_control(None)
    return np.array(found)[:, 0].astype(int)


@settings(max_examples=60)
@given(st.integers(1, 6), st.integers(1, 9), st.integers(1, 9), seeds)
def test_commands_arrive_within_bounds_and_in_order(period, delay, jitter, seed):
    applied, most = controls(period, jitter, delay, seed, 30), min(jitter, delay)
    now = np.arange(len(applied))
    assert (applied >= np.maximum((now - delay - most) // period, -1)).all()
    assert (applied <= np.maximum((now - delay + most) // period, -1)).all()
    assert (np.diff(applied) >= 0).all()


def test_the_mean_delay_of_commands_is_the_stated_one():
    applied = controls(4, 2, 6, 0, LONG)
    now = np.arange(len(applied))
    late = now[1:][np.diff(applied) > 0] - 4 * applied[1:][np.diff(applied) > 0]
    assert late.mean() == pytest.approx(6, abs=0.2)
    assert set(late) == {4, 5, 6, 7, 8}


def test_without_a_delay_nothing_varies():
    schedule, data, _ = opened(4, 8)
    assert not lateness_ms(schedule, data, 50).any()


@settings(max_examples=30)
@given(st.integers(1, 5), st.integers(0, 9), st.integers(0, 9), st.integers(0, 20), st.integers(0, 99))
def test_a_schedule_goes_on_from_a_state(period, delay, jitter, before, seed):
    streams = NoiseStreams(seed)
    schedule, data, _ = opened(period, jitter, streams, clock=delay, motor=delay)
    for number in range(before):
        step(schedule, data, number)
    state, random = schedule.state, streams.state
    physics = data.time, data.qpos.copy(), data.qvel.copy(), data.ctrl.copy()
    found = []
    for _ in range(2):
        seen = []
        for number in range(20):
            step(schedule, data, -number, number)
            seen.append((schedule.observe()["clock"].tolist(), data.ctrl.tolist(), data.qpos.tolist()))
        found.append(seen)
        schedule.state, streams.state = state, random
        data.time, data.qpos[:], data.qvel[:], data.ctrl[:] = physics
    assert found[0] == found[1]


# Delays that change while signals are on their way, as an infant grows.


def grown(period: int, delay: int, legs: int | None, jitter: int, streams: NoiseStreams) -> Schedule:
    entry = DelayEntry(ms=delay, legs_ms=legs and delay + legs)
    return scheduled(period, jitter, streams, clock=entry, motor=entry)[0]


delays = st.integers(1, 12)
legs = st.none() | st.integers(1, 5)
"""How much later the signals of the leg are, if they are."""


@settings(max_examples=15)
@given(st.integers(1, 5), delays, legs, delays, legs, st.integers(0, 4), st.integers(0, 99))
def test_observations_keep_their_order_and_reach_their_new_delay(period, first, leg, then, leg_then, jitter, seed):
    assume(jitter == 0 or (leg is None) == (leg_then is None))  # Else each leg had a jitter of its own.
    streams, data = NoiseStreams(seed), mujoco.MjData(MODEL)
    before, after = (grown(period, *each, jitter, streams) for each in ((first, leg), (then, leg_then)))
    before.reset(data)
    told, commanded = [], []

    def live(running: Schedule, steps: int) -> None:
        for _ in range(steps):
            number = len(told) + 1.0
            step(running, data, number)
            told.append(running.observe()["clock"][:2].copy())
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
        running = grown(period, delay, leg, 0, streams)
        running.reset(data)
        told = []
        for number in range(24):
            if carries and number == 12:
                former, running = running, grown(period, delay, leg, 0, streams)
                running.carry_on(former, data)
            step(running, data, number)
            told.append(np.concatenate([running.observe()["clock"], data.ctrl]))
        found.append(told)
    assert np.array_equal(*found)


def test_what_has_not_been_taken_yet_is_left_to_the_former_schedule():
    """The schedule of the age before can go on by itself, as when growing fails."""
    streams, data = NoiseStreams(0), mujoco.MjData(MODEL)
    before, after = (grown(2, 6, 8, 0, streams), grown(2, 3, 3, 0, streams))
    before.reset(data)
    state = before.state
    after.carry_on(before, data)
    step(after, data, 1)
    assert str(before.state) == str(state)
