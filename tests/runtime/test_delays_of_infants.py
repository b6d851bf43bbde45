"""Signals are delayed by exactly as many physics steps as the manifest says, whatever the control step is."""

import dataclasses
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st

import mimoc
from mimoc.schema.senses import DelayEntry, DelaysEntry

TIMESTEP_MS = 5.0
SENSES = {
    "proprioception": {},
    "vestibular": {},
    "touch": {"density": 0.2},
    "vision": {"width_px": 8, "height_px": 6, "acuity": "off"},
}
LEGS = ("right_upper_leg", "left_upper_leg")
OF_LEGS = ("left_hip", "right_hip", "leg", "knee", "ankle", "foot", "toe")
"""In the names of joints, sensors, actuators and bodies of the legs."""
PHYSICS_STEPS = 24

steps = st.integers(0, 11)
periods = st.integers(1, 5)


@pytest.fixture(scope="module")
def all_senses(built) -> mimoc.Bundle:
    """Return a sitting infant with every sense."""
    return built(senses=SENSES, scene={"kind": "flat", "pose": "sitting"})


@contextmanager
def opened(bundle: mimoc.Bundle, period: int, delays: DelaysEntry | None = None) -> Iterator[mimoc.InfantEnv]:
    """Yield an environment whose control step is *period* physics steps, and whose signals are late."""
    changes = {"step_ms": period * TIMESTEP_MS, "delays": delays or DelaysEntry()}
    env = mimoc.InfantEnv(dataclasses.replace(bundle, manifest=bundle.manifest.model_copy(update=changes)))
    yield env
    env.close()


def late(steps: int, legs_steps: int | None = None) -> DelayEntry:
    return DelayEntry(ms=steps * TIMESTEP_MS, legs_ms=None if legs_steps is None else legs_steps * TIMESTEP_MS)


def commands(env: mimoc.InfantEnv, period: int) -> np.ndarray:
    """Return a command for each physics step, drawn anew for each control step, shape (steps, n)."""
    drawn = np.random.default_rng(0).uniform(-1, 1, (PHYSICS_STEPS // period + 1, *env.action_space.shape))
    return np.repeat(drawn, period, axis=0)[:PHYSICS_STEPS].astype(np.float32)


def observations(env: mimoc.InfantEnv, actions: np.ndarray) -> list[dict[str, np.ndarray]]:
    """Return what is observed at the reset and after each action."""
    return [env.reset(seed=0)[0], *(env.step(action)[0] for action in actions)]


def joint_angles(env: mimoc.InfantEnv, actions: np.ndarray) -> np.ndarray:
    """Return the angles after each action."""
    env.reset(seed=0)
    found = []
    for action in actions:
        env.step(action)
        found.append(env.data.qpos.copy())
    return np.array(found)


@pytest.fixture(scope="module")
def undelayed(all_senses) -> Callable[[int], list[dict[str, np.ndarray]]]:
    """Return what gives, for a control step of so many physics steps, what is observed at each physics step."""

    @cache
    def by_step(period: int) -> list[dict[str, np.ndarray]]:
        with opened(all_senses, 1) as prompt:
            return observations(prompt, commands(prompt, period))

    return by_step


@settings(max_examples=12)
@example(2, 3, 7, 0, 1)
@given(periods, steps, steps, steps, steps)
@pytest.mark.slow
def test_every_sense_is_its_own_undelayed_stream_shifted(all_senses, undelayed, period, first, second, third, fourth):
    """Also where the delay is no whole number of control steps; until then there is the observation of the reset."""
    delays = dict(zip(SENSES, (first, second, third, fourth), strict=True))
    by_step = undelayed(period)
    with opened(all_senses, period, DelaysEntry(**{sense: late(delays[sense]) for sense in SENSES})) as env:
        seen = observations(env, commands(env, period)[::period])
    for index in range(PHYSICS_STEPS // period + 1):
        for key in by_step[0]:
            sense = "vision" if key.startswith("eye_") else key
            sampled_at = max(index * period - delays[sense], 0)
            assert np.array_equal(seen[index][key], by_step[sampled_at][key]), (key, index)


@settings(max_examples=10)
@example(2, 3)
@given(periods, steps)
def test_commands_arrive_exactly_that_late_and_the_infant_rests_till_then(bundle, period, delay):
    with opened(bundle, 1) as prompt:
        actions = commands(prompt, period)
        at_rest = np.zeros((delay, actions.shape[1]), np.float32)
        expected = joint_angles(prompt, np.concatenate([at_rest, actions])[:PHYSICS_STEPS])
    with opened(bundle, period, DelaysEntry(motor=late(delay))) as env:
        found = joint_angles(env, actions[::period][: PHYSICS_STEPS // period])
    assert np.array_equal(found, expected[period - 1 :: period][: len(found)])


def test_servos_hold_the_pose_until_a_command_arrives(built):
    held = built(actuation={"model": "position"}, delays={"motor_ms": 100}, scene={"pose": "sitting"})
    with opened(held, 2, held.manifest.delays) as env:
        env.reset(seed=0)
        start = env.data.ctrl.copy()
        assert start.any()
        for _ in range(10):
            env.step(env.action_space.high)
            assert np.array_equal(env.data.ctrl, start)
        env.step(env.action_space.high)
        assert np.array_equal(env.data.ctrl, env.action_space.high)


@settings(max_examples=10)
@example(2, 3, 6)
@given(periods, steps, steps)
@pytest.mark.slow
def test_the_legs_can_have_a_longer_delay(all_senses, undelayed, period, delay, legs_delay):
    entry = late(delay, legs_delay)
    by_step = undelayed(period)
    with opened(all_senses, period, DelaysEntry(proprioception=entry, touch=entry, legs=LEGS)) as env:
        seen = observations(env, commands(env, period)[::period])
        names = {sense: env.layout(sense) for sense in ("proprioception", "touch")}
    for sense, layout in names.items():
        is_of_leg = np.array([any(part in name for part in OF_LEGS) for name in layout])
        assert 0 < is_of_leg.sum() < len(layout)
        for index in range(PHYSICS_STEPS // period + 1):
            early, later = (by_step[max(index * period - ms, 0)][sense] for ms in (delay, legs_delay))
            assert np.array_equal(seen[index][sense], np.where(is_of_leg, later, early))


def test_commands_to_the_legs_can_have_a_longer_delay(bundle):
    with opened(bundle, 2, DelaysEntry(motor=late(1, 4), legs=LEGS)) as env:
        env.reset(seed=0)
        names = [actuator.name for actuator in env.manifest.actuation.actuators]
        legs = np.array([any(part in name for part in OF_LEGS) for name in names])
        arrived = []
        for _ in range(3):
            env.step(env.action_space.high)
            arrived.append((env.data.ctrl[~legs].all(), env.data.ctrl[legs].any()))
        assert arrived == [(True, False), (True, False), (True, True)]
        assert env.data.ctrl.all()


def test_a_wrong_action_leaves_everything_as_it_was(all_senses):
    with (
        opened(all_senses, 2, DelaysEntry(motor=late(3), touch=late(3))) as env,
        opened(all_senses, 2, DelaysEntry(motor=late(3), touch=late(3))) as other,
    ):
        actions = commands(env, 2)[::2]
        env.reset(seed=0)
        with pytest.raises(ValueError, match=r"expected a finite action of shape \(44,\), got"):
            env.step(np.zeros(3))
        seen = [env.step(action)[0]["touch"] for action in actions]
        assert np.array_equal(seen, [each["touch"] for each in observations(other, actions)[1:]])


def test_the_delays_of_a_spec_are_in_the_manifest(built):
    bundle = built(senses=SENSES, delays={"preset": "physiological", "vision_ms": 15})
    assert bundle.manifest.delays.vision == DelayEntry(ms=15)
    assert bundle.manifest.delays.touch == DelayEntry(ms=20, legs_ms=30)
