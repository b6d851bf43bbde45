"""Infants with noise: each noise acts on its own channel, by the seed, and is part of the state."""

import copy
import dataclasses
import importlib
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.running import flail
from support.same import same

import mimoc
from mimoc.components.senses.proprioception.run import ProprioceptionNoise
from mimoc.components.senses.touch.run import TouchNoise
from mimoc.runtime.noise import (
    BandLimited,
    Draw,
    LowPass,
    MotorNoise,
    Noise,
    NoiseStreams,
    NoisyMotors,
    Smooth,
    bind_motor_noise,
)
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import NUMPY
from mimoc.schema.senses import NoiseEntry

SENSES = {
    "proprioception": {"include": ["velocity", "torque"]},
    "vestibular": {"canals": "age"},
    "touch": {"density": 0.1},
}
ALL = {
    "motor": 0.2,
    "proprioception_deg": 1.0,
    "vestibular_thresholds": 1.0,
    "touch_n": 0.05,
    "delay_jitter_ms": 10.0,
}
STEPS = 8


@pytest.fixture(scope="module", params=["torque", "muscle"])
def quiet(request, built) -> mimoc.Bundle:
    """Return a sitting infant whose signals are late."""
    return built(
        senses=SENSES,
        delays={"preset": "physiological"},
        actuation={"model": request.param},
        scene={"kind": "flat", "pose": "sitting"},
    )


def noisy(bundle: mimoc.Bundle, **noise: float) -> mimoc.InfantEnv:
    """Return the environment of a bundle with some noise."""
    manifest = bundle.manifest.model_copy(update={"noise": NoiseEntry(**noise)})
    return mimoc.InfantEnv(dataclasses.replace(bundle, manifest=manifest))


def run(env: mimoc.InfantEnv, seed: int = 0) -> list[dict[str, np.ndarray]]:
    return [env.reset(seed=seed)[0], *flail(env, STEPS)]


def test_the_same_seed_gives_the_same_noise_and_another_seed_another(quiet):
    one, other = noisy(quiet, **ALL), noisy(quiet, **ALL)
    first = run(one)
    flail(other, STEPS)
    assert same(run(other), first)
    assert not same(run(other, seed=1), first)


def test_episodes_without_a_seed_differ_and_repeat_after_a_seed(quiet):
    env = noisy(quiet, **ALL)
    one, two = run(env, seed=3), [env.reset()[0], *flail(env, STEPS)]
    assert not same(one, two)
    env.reset(seed=3)
    flail(env, STEPS)
    assert same([env.reset()[0], *flail(env, STEPS)], two)


@pytest.mark.parametrize("duplicate", [copy.deepcopy, copy.copy, lambda env: pickle.loads(pickle.dumps(env))])
def test_forks_and_copies_have_the_same_noise(quiet, duplicate):
    env = noisy(quiet, **ALL)
    run(env, seed=5)
    state, twin, fork = env.get_state(), duplicate(env), noisy(quiet, **ALL)
    mine = flail(env, STEPS, 1)
    assert same(flail(twin, STEPS, 1), mine)
    fork.set_state(pickle.loads(pickle.dumps(state)))
    assert same(flail(fork, STEPS, 1), mine)
    for _ in range(2):  # A state is not changed by what comes after it.
        env.set_state(state)
        assert same(flail(env, STEPS, 1), mine)


def test_noise_leaves_the_random_numbers_of_the_task_alone(quiet):
    draws = []
    for noise in ({}, ALL):
        env = noisy(quiet, **noise)
        run(env)
        draws.append(env.np_random.random(3).tolist())
    assert draws[0] == draws[1]


@pytest.mark.parametrize(("key", "changed"), [("proprioception_deg", "proprioception"), ("touch_n", "touch")])
def test_noise_of_a_sense_changes_nothing_else(quiet, key, changed):
    for silent, loud in zip(run(noisy(quiet)), run(noisy(quiet, **{key: ALL[key]})), strict=True):
        assert not np.array_equal(silent[changed], loud[changed])
        assert all(np.array_equal(silent[other], loud[other]) for other in silent if other != changed)


def test_the_noise_of_a_channel_does_not_depend_on_that_of_others(quiet):
    """Noise of touch does not move the body: the proprioception of both is the same, noise included."""
    one, other = run(noisy(quiet, proprioception_deg=1.0)), run(noisy(quiet, proprioception_deg=1.0, touch_n=1.0))
    assert all(np.array_equal(a["proprioception"], b["proprioception"]) for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("key", ["motor", "delay_jitter_ms"])
def test_noise_of_commands_moves_the_body(quiet, key):
    silent, loud = noisy(quiet), noisy(quiet, **{key: ALL[key]})
    for env in (silent, loud):
        run(env)
    assert not np.array_equal(silent.data.qpos, loud.data.qpos)


# Laws of each noise, as a term of NumPy's arrays, which one infant and many have, and of torch's, which a device has.


@pytest.fixture(scope="module", params=["numpy", pytest.param("torch", marks=pytest.mark.extras)])
def library(request):
    """Return an array library, and what moves NumPy's arrays there."""
    if request.param == "numpy":
        return NUMPY, np.asarray
    torch = importlib.import_module("torch")
    return importlib.import_module("array_api_compat.torch"), lambda array: torch.as_tensor(
        array, dtype={"f": torch.float32}.get(array.dtype.kind)
    )


def disturbed(library, noise: Noise, signals: list[np.ndarray], elapsed_s: float, seed: int = 0) -> list[np.ndarray]:
    """Return signals of one infant with noise, each so long after the one before."""
    (xp, put), generator = library, np.random.default_rng(seed)
    stacked: Noise = stack_terms([noise], put)
    state, results = None, []
    for signal in signals:
        draw = Draw(xp, elapsed_s, lambda shape, where=None: put(generator.standard_normal(tuple(shape))))
        result, state = stacked(draw, put(signal[None]), state)
        results.append(np.asarray(result)[0])
    return results


def driven(library, share: float, low_pass_s: float, timestep_s: float, commands: np.ndarray, steps: int) -> np.ndarray:
    """Return what drives each actuator in each physics step, shape (steps, n)."""
    one = np.ones(len(commands))
    noise = MotorNoise(np.array([share]), -one, one, LowPass(low_pass_s))
    return np.array(disturbed(library, noise, [commands] * steps, timestep_s))


@settings(max_examples=5)
@given(st.floats(0.01, 0.5), st.sampled_from([0.001, 0.005, 0.02]))
def test_motor_noise_is_a_share_of_the_command_and_lasts_60_ms(library, share, timestep_s):
    commands = np.array([0.0, 0.1, 0.5, 1.0, -1.0])
    lag = round(0.06 / timestep_s)
    noise = driven(library, share, 0.06, timestep_s, commands, 200 * lag) - commands
    assert not noise[:, 0].any()
    deviations = noise[:, 1:].std(axis=0)
    assert deviations == pytest.approx(share * np.abs(commands[1:]), rel=0.35)
    normed = noise[:, 1:] / deviations
    correlation = (normed[lag:] * normed[:-lag]).mean()
    assert correlation == pytest.approx(np.exp(-lag * timestep_s / 0.06), abs=0.15)
    assert np.abs(normed.mean(axis=0)).max() < 0.5


@pytest.mark.parametrize("bandwidth_hz", [None, 5.0])
def test_the_noise_of_a_control_step_is_that_of_its_physics_steps_one_after_the_other(bandwidth_hz, built):
    """To the bit; new commands arrive in the middle of control steps, and the state between two of them is the same."""
    env = mimoc.InfantEnv(built(actuation={"bandwidth_hz": bandwidth_hz}))
    noise = bind_motor_noise(NoiseEntry(motor=0.2), env.actuation)
    motors, actuators = NoisyMotors(noise, 4, 0.005, env.actuation, NoiseStreams(1)), env.actuation.actuators
    term, drawn = stack_terms([noise]), NoiseStreams(1)["motor"].standard_normal
    generator, data = np.random.default_rng(0), env.data
    motors.reset(data)
    _, state = term(Draw(NUMPY, np.inf, drawn), motors.commanded[actuators][None], None)
    for _ in range(3):
        motors.begin()
        for step in range(4):
            if step % 2 == 1:
                motors.commanded[:] = generator.uniform(-2, 2, len(motors.commanded))
            motors(data)
            expected, state = term(Draw(NUMPY, 0.005, drawn), motors.commanded[actuators][None], state)
            assert data.ctrl[actuators].tobytes() == expected.tobytes()
        assert motors.state[1].tobytes() == state.tobytes()
        motors.state = copy.deepcopy(motors.state)


def test_a_command_beyond_its_range_is_no_noisier_than_one_at_its_end(library):
    beyond, at_the_end = (driven(library, 0.1, 0.06, 0.005, np.full(5, level), 20) for level in (7.0, 1.0))
    assert np.array_equal(beyond, at_the_end)


def test_motors_begin_with_noise_that_is_as_large_as_later(library):
    noise = np.stack(driven(library, 0.2, 0.06, 0.005, np.ones(20_000), 13)) - 1
    assert (noise[0].std(), noise[-1].std()) == pytest.approx((0.2, 0.2), rel=0.02)
    assert (noise[0] * noise[-1]).mean() / 0.04 == pytest.approx(np.exp(-0.06 / 0.06), abs=0.02)


@settings(max_examples=30)
@given(st.floats(0, 5), st.sampled_from([1, 3]), st.integers(0, 2**32))
def test_touch_keeps_the_direction_of_forces_and_feels_nothing_where_nothing_touches(library, deviation_n, width, seed):
    draws = np.random.default_rng(seed)
    forces = draws.normal(size=(200, width)) * draws.integers(0, 2, size=(200, 1))
    forces = np.abs(forces) if width == 1 else forces
    noise = TouchNoise(np.array([deviation_n]), width)
    felt = disturbed(library, noise, [forces.flatten()], 0.01, seed)[0].reshape(-1, width)
    assert not felt[~forces.any(axis=1)].any()
    along = (felt * forces).sum(axis=1)
    assert (along >= 0).all()
    sizes = np.linalg.norm(felt, axis=1) * np.linalg.norm(forces, axis=1)
    assert along == pytest.approx(sizes, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("width", [1, 3])
def test_the_size_of_a_force_varies_by_the_stated_newtons(library, width):
    forces = np.tile([3.0, 0.0, 4.0][:width], 20_000)
    (felt,) = disturbed(library, TouchNoise(np.array([0.2]), width), [forces], 0.01)
    sizes = np.linalg.norm(felt.reshape(-1, width), axis=1)
    assert sizes.mean() == pytest.approx(5.0 if width == 3 else 3.0, abs=0.01)
    assert sizes.std() == pytest.approx(0.2, rel=0.02)


def test_angles_vary_by_the_stated_degrees_and_velocities_accordingly(library):
    """Their values, those of the rates, and the correlation of both over time."""
    count = 20_000
    errors, per = np.append(np.arange(2 * count), [0] * 5), np.repeat([1, 0.06, np.inf], [count, count, 5])
    noise = ProprioceptionNoise(np.array([np.radians(2)]), errors, per, count, Smooth(0.06))
    first, later = (np.degrees(sample) for sample in disturbed(library, noise, [np.zeros(len(errors))] * 2, 0.03))
    for sample in (first, later):
        assert sample[:count].std() == pytest.approx(2, rel=0.02)
        assert sample[count : 2 * count].std() == pytest.approx(2 / 0.06, rel=0.02)
        assert not sample[2 * count :].any()
    assert (first * later)[:count].mean() / 4 == pytest.approx(np.exp(-0.5) * 1.5, abs=0.03)


def test_angles_and_velocities_of_an_infant_are_noisy_and_its_torques_are_not(quiet):
    env, silent = noisy(quiet, proprioception_deg=2.0), noisy(quiet)
    differences = np.array([env.reset(seed=seed)[0]["proprioception"] for seed in range(40)])
    differences -= silent.reset(seed=0)[0]["proprioception"]
    layout = env.layout("proprioception")
    deviations = np.degrees(differences.std(axis=0))
    for unit, deviation_deg in (("rad", 2), ("rad/s", 2 / 0.06), ("N m", 0)):
        mine = deviations[[name.endswith(f"[{unit}]") for name in layout]]
        assert len(mine) > 20
        assert np.sqrt((mine**2).mean()) == pytest.approx(deviation_deg, rel=0.1, abs=1e-9)


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
