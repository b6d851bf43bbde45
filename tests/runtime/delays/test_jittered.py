"""Signals whose delay varies keep their order, never come from the future, and take the stated time on average."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.slider import MODEL, MOTORS

from mimoc.runtime.delays.schedule import Schedule
from mimoc.runtime.delays.signals import Timing
from mimoc.runtime.noise import NoiseStreams
from mimoc.runtime.sense import Vector
from mimoc.schema.senses import DelayEntry, NoiseEntry

LONG = 4000


class Clock(Vector):
    """The time, and how often the clock was read."""

    def __init__(self):
        super().__init__("clock", ("time [s]",), 0.0, 100.0)
        self.reads = 0

    def __call__(self, data):
        self.reads += 1
        return np.array([data.time])


class Recorder:
    """The controls at each physics step, by way of MuJoCo's callback."""

    def __init__(self):
        self.found = []

    def __call__(self, model, data):
        self.found.append(data.ctrl.copy())


def opened(period: int, jitter: int, seed: int = 0, **delays: int) -> tuple[Schedule, mujoco.MjData, Clock]:
    """Return a schedule of physics steps of 1 ms, after a reset."""
    entries = {name: DelayEntry(ms=ms) for name, ms in delays.items()}
    timing = Timing(period, 1, entries, noise=NoiseEntry(delay_jitter_ms=jitter))
    clock, data = Clock(), mujoco.MjData(MODEL)
    schedule = Schedule({"clock": clock}, MOTORS, MODEL, timing, NoiseStreams(seed))
    schedule.reset(data)
    return schedule, data, clock


def lateness_ms(schedule: Schedule, data: mujoco.MjData, count: int) -> np.ndarray:
    """Return how late the observation after each control step is."""
    found = []
    for _ in range(count):
        schedule.step([0, 0], data)
        found.append(1000 * (data.time - schedule.observe()["clock"][0]))
    return np.rint(found).astype(int)


@settings(max_examples=60)
@given(st.integers(1, 6), st.integers(1, 9), st.integers(1, 9), st.integers(0, 2**32))
def test_observations_are_late_within_bounds_and_in_order(period, delay, jitter, seed):
    schedule, data, clock = opened(period, jitter, seed, clock=delay)
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
    schedule, data, _ = opened(period, jitter, seed, motor=delay)
    data.ctrl[:] = -1
    recorder = Recorder()
    mujoco.set_mjcb_control(recorder)
    try:
        for number in range(count):
            schedule.step([number, number], data)
    finally:
        mujoco.set_mjcb_control(None)
    return np.array(recorder.found)[:, 0].astype(int)


@settings(max_examples=60)
@given(st.integers(1, 6), st.integers(1, 9), st.integers(1, 9), st.integers(0, 2**32))
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
    timing = Timing(
        period, 1, {name: DelayEntry(ms=delay) for name in ("clock", "motor")}, noise=NoiseEntry(delay_jitter_ms=jitter)
    )
    schedule, data = Schedule({"clock": Clock()}, MOTORS, MODEL, timing, streams), mujoco.MjData(MODEL)
    schedule.reset(data)
    for number in range(before):
        schedule.step([number, number], data)
    state, random = schedule.state, streams.state
    physics = data.time, data.qpos.copy(), data.qvel.copy(), data.ctrl.copy()
    found = []
    for _ in range(2):
        seen = []
        for number in range(20):
            schedule.step([-number, number], data)
            seen.append((schedule.observe()["clock"].tolist(), data.ctrl.tolist(), data.qpos.tolist()))
        found.append(seen)
        schedule.state, streams.state = state, random
        data.time, data.qpos[:], data.qvel[:], data.ctrl[:] = physics
    assert found[0] == found[1]
