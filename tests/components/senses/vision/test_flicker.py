"""Flicker: a low-pass filter over time, whatever the times between pictures."""

import numpy as np
import pytest

import mimoc
from mimoc.components.senses.vision.flicker import Persistence
from mimoc.runtime.array_library import NUMPY
from mimoc.runtime.term import stack_terms

BLINKING = {"vision": {"width_px": 16, "height_px": 16, "flicker": "age", "contrast": "age", "focus": 1}}


def filter_at(flicker_hz: float):
    return stack_terms([Persistence(np.array([flicker_hz]))])


@pytest.mark.parametrize("steps", [[0.1], [0.01] * 10, [0.03, 0.005, 0.065]])
def test_a_step_is_seen_by_the_exponential_law_whatever_the_times_between_pictures(steps):
    persist, before = filter_at(2.0), np.full((1, 2, 4, 4, 3), 20, np.uint8)
    _, state = persist(NUMPY, np.inf, before, None)
    for elapsed_s in steps:
        seen, state = persist(NUMPY, elapsed_s, before + 200, state)
    assert state == pytest.approx(20 + 200 * (1 - np.exp(-2 * np.pi * 2.0 * 0.1)), abs=1e-3)
    assert seen.dtype == np.uint8
    assert (seen == np.rint(state)).all()


@pytest.mark.parametrize(("light_hz", "flicker_hz"), [(1, 2), (2, 2), (8, 2), (8, 15)])
def test_a_flickering_light_keeps_the_share_of_a_filter_of_first_order(light_hz, flicker_hz):
    """1 / sqrt(1 + (f / f0)²), within .02, at a thousand pictures a second."""
    persist, state, seen = filter_at(float(flicker_hz)), None, []
    times_s = np.arange(0, 4, 1e-3)
    for time_s in times_s:
        light = np.full((1, 1), 128 + 100 * np.sin(2 * np.pi * light_hz * time_s))
        _, state = persist(NUMPY, 1e-3 if state is not None else np.inf, light, state)
        seen.append(state.item())
    late = np.array(seen)[2000:]
    assert np.ptp(late) / 200 == pytest.approx((1 + (light_hz / flicker_hz) ** 2) ** -0.5, abs=0.02)


def made(age_months: float = 1.0):
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "senses": BLINKING, "delays": {"vision_ms": 20}}
    return mimoc.InfantSpec.model_validate({**spec, "scene": {"kind": "room", "pose": "sitting"}})


def commands(env, count: int):
    rng = np.random.default_rng(0)
    return [rng.uniform(-1, 1, env.action_space.shape).astype(np.float32) for _ in range(count)]


def test_it_is_part_of_the_state_and_begins_again_with_an_episode():
    env = mimoc.make(made())
    first, _ = env.reset(seed=0)
    before, after = commands(env, 8)[:4], commands(env, 8)[4:]
    for command in before:
        env.step(command)
    state = env.unwrapped.get_state()
    expected = [env.step(command)[0]["eye_left"] for command in after]
    env.unwrapped.set_state(state)
    assert all((env.step(command)[0]["eye_left"] == seen).all() for command, seen in zip(after, expected, strict=True))
    assert (env.reset(seed=0)[0]["eye_left"] == first["eye_left"]).all()
    env.close()


def test_it_goes_on_while_the_infant_grows_until_it_is_mature():
    env = mimoc.make(made())
    env.reset(seed=0)
    env.step(commands(env, 1)[0])
    kept = env.unwrapped.get_state()["signals"]["noise"]["vision"][1]
    env.unwrapped.grow(to=2.5)
    assert np.array_equal(env.unwrapped.get_state()["signals"]["noise"]["vision"][1], kept)
    assert env.unwrapped.senses["vision"].filter.flicker_hz == pytest.approx([3.5])
    env.close()


def test_infants_in_a_batch_see_bit_for_bit_what_each_sees_alone():
    specs = [made(1.0), made(5.0)]
    batch, singles = mimoc.make_vec(specs, threads=2), [mimoc.make(spec) for spec in specs]
    seen, alone = batch.reset(seed=[0, 1])[0], [env.reset(seed=seed)[0] for seed, env in enumerate(singles)]
    for command in commands(singles[0], 5):
        for index, single in enumerate(alone):
            for eye in ("eye_left", "eye_right"):
                assert np.array_equal(seen[eye][index], single[eye])
        seen = batch.step(np.stack([command, command]))[0]
        alone = [env.step(command)[0] for env in singles]
    batch.close(), [env.close() for env in singles]
