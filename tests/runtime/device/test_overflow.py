"""Contacts that do not fit end the episode of the infant that loses them; the room grows, and all others go on."""

from typing import Any

import mujoco_warp as mjw
import numpy as np
import pytest
from support.devices import break_down, infant, random_actions, sitting, still

from mimoc.runtime.device import capacity, simulation as worlds
from mimoc.runtime.device.capacity import COUNTS, FLAGS, HARMLESS, LENGTH, LOSING, PAIRS, ROWS, Capacity, Room
from mimoc.runtime.device.signals import DeviceError
from mimoc.runtime.device.vector_env import DeviceEnv

CLOSE = 3e-3
NEFC = int(mjw.OverflowType.NEFC)
ENOUGH = {"contacts": 100, "constraints": 200}


@pytest.fixture
def begun(make):
    """Return what makes infants on the device and resets them."""

    def reset(*arguments: Any, **options: Any) -> DeviceEnv:
        env = make(*arguments, **options)
        env.reset(seed=0)
        return env

    return reset


def set_flags(env: DeviceEnv, *flags: int) -> None:
    """Let MuJoCo Warp have set these flags of each infant."""
    env.worlds.data.overflow.assign(np.array(flags, np.int32))


def test_flags_that_lose_nothing_are_counted_and_cleared(begun):
    """For 5 to 9 million control steps of thousands, one of them was enough to end everything."""
    env = begun(sitting(9), 2, **ENOUGH)
    before = env.room
    for step in range(3):
        set_flags(env, HARMLESS, 0)
        _, _, _, truncated, info = env.step(still(env))
        assert not truncated.any()
        assert not info["overflowed"].any()
        assert info["_overflowed"].all()
        assert not env.worlds.data.overflow.numpy().any()
        assert env.overflows["epa_horizon"] == step
    env.step(still(env))
    assert env.overflows["epa_horizon"] == 3
    assert env.overflows["iterations"] >= 3
    assert env.overflows["nefc"] == 0
    assert env.room == before


def test_every_flag_is_counted_and_either_loses_contacts_or_does_not():
    assert set(FLAGS) == {flag.name.lower() for flag in mjw.OverflowType}
    assert int(mjw.OverflowType.ALL) == HARMLESS | LOSING
    assert HARMLESS & LOSING == 0
    assert all(1 << bit == mjw.OverflowType[name.upper()] for name, bit in FLAGS.items())


@pytest.mark.parametrize("given", [{"contacts": 2}, {"constraints": 25}])
def test_infants_whose_contacts_do_not_fit_begin_anew_with_more_room(begun, given):
    """And then move as those do that had enough from the start."""
    ours, theirs = begun(sitting(9), 2, **{**ENOUGH, **given}), begun(sitting(9), 2, **ENOUGH)
    before = ours.room
    *_, terminated, truncated, info = ours.step(still(ours))
    assert info["overflowed"].tolist() == truncated.tolist() == [True, True]
    assert not terminated.any()
    lost = 0
    while truncated.any():
        lost += 1
        *_, truncated, info = ours.step(still(ours))
        if not truncated.any():  # Their episodes began anew in this step, in which contacts may still have been lost.
            *_, truncated, info = ours.step(still(ours))
    assert lost < 5
    assert (ours.room.contacts > before.contacts) == ("contacts" in given)
    assert (ours.room.constraints > before.constraints) == ("constraints" in given)
    theirs.step(still(theirs))
    for _ in range(3):
        assert_same(ours.step(still(ours))[0], theirs.step(still(theirs))[0])
    flags = ("narrowphase", "broadphase") if "contacts" in given else ("nefc",)
    assert any(ours.overflows[name] for name in flags)


def assert_same(seen: Any, expected: Any, infants: Any = slice(None)) -> None:
    """Compare what some infants observe, relatively if it is large."""
    for name, values in expected.items():
        errors = np.abs(seen[name] - values) / np.maximum(1.0, np.abs(values))
        assert errors[infants].max() < CLOSE, name


def reaching(age_months: float) -> Any:
    noise = {"motor": 0.1, "proprioception_deg": 1.0}
    return infant(age_months, task={"kind": "reach"}, noise=noise, delays={"sensory_ms": 20, "motor_ms": 10})


def test_all_others_go_on_as_if_there_had_been_enough_room_from_the_start(begun):
    """Their states, delays, noise, rewards, steps to the end of the episode and later starts.

    Those of 18 months do not have the rows that they need at first; then the room grows twice.
    """
    options = {"autoreset_mode": "SameStep", "max_episode_steps": 6, "starts": 3}
    bundles = [reaching(12), reaching(18)]
    ours, theirs = begun(bundles, 4, **options, contacts=60, constraints=100), begun(bundles, 4, **options)
    generator = np.random.default_rng(0)
    others, lost = [0, 2], {0: [False, True, False, True], 3: [False, True, False, False]}
    for step in range(14):
        if step == 3:
            set_flags(ours, 0, NEFC, 0, 0)
        command = 0.5 * random_actions(ours, generator)
        seen, rewards, terminated, truncated, info = ours.step(command)
        expected, wanted, ends, cuts, rest = theirs.step(command)
        assert_same(seen, expected, others)
        assert_same(info["final_obs"], rest["final_obs"], others)
        assert rewards[others] == pytest.approx(wanted[others], rel=CLOSE, abs=CLOSE)
        assert terminated[others].tolist() == ends[others].tolist()
        assert truncated[others].tolist() == cuts[others].tolist() == [step in (5, 11)] * 2
        assert info["overflowed"].tolist() == lost.get(step, [False] * 4)
        assert truncated[1] == (step in (0, 3, 9))
    assert ours.room.contacts == 60
    assert ours.room.constraints > 1.5 * 100
    assert ours.overflows["nefc"] == 3


def test_room_grows_before_anything_is_lost(begun):
    """Hands are on thighs at the end of the first control step, not before."""
    env = begun(sitting(12), 2, **ENOUGH)
    env.step(still(env))
    rows = int(env.worlds.data.nefc.numpy().max())
    short = begun(sitting(12), 2, contacts=100, constraints=rows + 4)
    for _ in range(3):
        *_, truncated, info = short.step(still(short))
        assert not truncated.any()
        assert not info["overflowed"].any()
    assert short.room.constraints > 1.4 * rows
    assert short.room.contacts == 100


def test_where_room_cannot_grow_many_that_lose_contacts_are_an_error_and_few_are_not(begun, monkeypatch):
    monkeypatch.setattr(capacity, "LARGEST", 0.01)
    env = begun(sitting(9), 2, contacts=2, constraints=200)
    env.step(still(env))
    with pytest.raises(
        DeviceError, match=r"of 2 infants, such as 0, .* no more room than contacts=2 and constraints=200"
    ):
        env.step(still(env))
    monkeypatch.setattr(worlds, "RARE", 1.0)
    assert env.step(still(env))[-1]["overflowed"].tolist() == [False, False]  # They wait for their new episodes.
    assert env.step(still(env))[-1]["overflowed"].tolist() == [True, True]
    assert env.room == Capacity(2, 200)


def test_memory_that_does_not_do_is_a_limit_and_other_errors_are_raised(begun, monkeypatch):
    env = begun(sitting(9), 2, contacts=2, constraints=200)

    def refuse(*arguments: Any) -> None:
        raise RuntimeError(said)

    monkeypatch.setattr(worlds, "enlarged", refuse)
    said = "Failed to allocate 1073741824 bytes on device 'cuda:0'"
    env.step(still(env))
    with pytest.raises(DeviceError, match="no more room than contacts=2"):
        env.step(still(env))
    again = begun(sitting(9), 2, contacts=2, constraints=200)
    again.step(still(again))
    said = "something else"
    with pytest.raises(RuntimeError, match=said):
        again.step(still(again))


def test_room_is_made_for_what_was_short_in_proportion_to_what_was_needed():
    few = Room(Capacity(100, 100), largest=Capacity(1000, 400), worlds=10)
    assert few.after(reported()) == few.present
    assert few.after(reported(pairs=800, rows=80)) == few.present
    assert few.after(reported(pairs=900)) == Capacity(150, 100)
    assert few.after(reported(pairs=3000)) == Capacity(450, 100)
    assert few.after(reported(rows=81)) == Capacity(100, 150)
    assert few.after(reported(rows=300)) == Capacity(100, 400)
    assert few.after(reported(broadphase=10)) == Capacity(150, 100)
    assert few.after(reported(nefc=1)) == Capacity(100, 150)
    assert few.after(reported(epa_horizon=10, ls_iterations=10)) == few.present
    assert Room(Capacity(100, 500), Capacity(100, 400), 10).after(reported(rows=600)) == Capacity(100, 500)


def reported(pairs: int = 0, rows: int = 0, **flags: int) -> np.ndarray:
    """Return a report in which flags were set in some infants."""
    report = np.zeros(LENGTH, int)
    report[[PAIRS, ROWS]] = pairs, rows
    for name, count in flags.items():
        report[COUNTS + FLAGS[name]] = count
    return report


def test_an_unstable_infant_needs_no_room(begun):
    env = begun(sitting(9), 2, **ENOUGH)
    break_down(env)
    set_flags(env, NEFC, 0)
    *_, terminated, truncated, info = env.step(still(env))
    assert terminated.tolist() == info["unstable"].tolist() == [True, False]
    assert not truncated.any()
    assert not info["overflowed"].any()
    env.step(still(env))
    assert env.room == Capacity(**ENOUGH)


def test_the_room_at_first_is_more_than_what_infants_need_that_move_at_random(begun):
    env = begun(sitting(9), 2)
    generator = np.random.default_rng(0)
    first = env.room
    for _ in range(6):
        assert not env.step(random_actions(env, generator))[-1]["overflowed"].any()
    assert env.room == first
    assert capacity.SPARE_CONTACTS < capacity.LARGEST
    assert capacity.FULL < 1
