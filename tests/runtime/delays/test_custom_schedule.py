"""A schedule of control steps takes any senses and any actuation, without a bundle."""

from itertools import pairwise

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from support.slider import MODEL, MOTORS

from mimoc.runtime.delays.schedule import Schedule, Segment, merge_segments
from mimoc.runtime.delays.signals import Timing
from mimoc.runtime.sense import Vector
from mimoc.schema.senses import DelayEntry


class Clock(Vector):
    """The time and the controls of two motors, of the trunk and of the leg."""

    def __init__(self, bodies=None):
        super().__init__("clock", ("time [s]", "trunk", "leg"), 0.0, 10.0, bodies)

    def __call__(self, data):
        return np.array([data.time, *data.ctrl])


def clocked(delays: dict[str, DelayEntry], bodies=None) -> tuple[Schedule, mujoco.MjData]:
    """Return the schedule of control steps of 4 ms and physics steps of 1 ms, after a reset."""
    timing = Timing(step_ms=4, timestep_ms=1, delays=delays, legs=("leg",))
    schedule, data = Schedule({"clock": Clock(bodies)}, MOTORS, MODEL, timing), mujoco.MjData(MODEL)
    schedule.reset(data)
    return schedule, data


def times_ms(schedule: Schedule, data: mujoco.MjData, count: int = 4) -> list[int]:
    found = [schedule.observe()["clock"]]
    for _ in range(count):
        schedule.step([1, 1], data)
        found.append(schedule.observe()["clock"])
    return [round(1000 * float(clock[0])) for clock in found]


@pytest.mark.parametrize("delay_ms", range(10))
def test_a_sense_that_is_passed_has_the_delay_that_is_given_under_its_name(delay_ms):
    schedule, data = clocked({"clock": DelayEntry(ms=delay_ms)})
    assert times_ms(schedule, data) == [max(step - delay_ms, 0) for step in (0, 4, 8, 12, 16)]


def test_a_signal_that_is_not_named_has_no_delay():
    assert times_ms(*clocked({})) == [0, 4, 8, 12, 16]


def test_a_longer_delay_of_the_legs_is_that_of_the_numbers_measured_there():
    schedule, data = clocked({"clock": DelayEntry(ms=0, legs_ms=6)}, bodies=np.array([2, 1, 1]))
    assert times_ms(schedule, data) == [0, 0, 2, 6, 10]


def test_without_bodies_all_numbers_have_the_shorter_delay():
    assert times_ms(*clocked({"clock": DelayEntry(ms=0, legs_ms=6)})) == [0, 4, 8, 12, 16]


def test_commands_to_the_leg_arrive_when_they_are_due():
    schedule, data = clocked({"motor": DelayEntry(ms=0, legs_ms=6)})
    seen = []
    for command in (1, 2, 3):
        schedule.step([command, command], data)
        seen.append(data.ctrl.tolist())
    assert seen == [[1, 0], [2, 1], [3, 2]]


def test_a_delay_between_physics_steps_is_refused():
    with pytest.raises(ValueError, match=r"1\.5 ms is 1\.50 steps of 1 ms; the nearest that works is 2 ms"):
        clocked({"clock": DelayEntry(ms=1.5)})


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
