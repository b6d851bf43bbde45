"""Delays that vary do so on MuJoCo Warp as on the CPU."""

import numpy as np
import torch
from hypothesis import given, settings, strategies as st
from support.devices import infant, random_actions

import mimoc
from mimoc.base.random_streams import stream
from mimoc.runtime.delays import Delay, DelayedCommands, DelayedSamples
from mimoc.runtime.device.arrays import put
from mimoc.runtime.device.signals import CounterRandom, DelayLine, Delays
from mimoc.runtime.noise import NoiseStreams


def jittered(age_months: float) -> mimoc.Bundle:
    return infant(age_months, delays={"preset": "physiological"}, noise={"delay_jitter_ms": 10})


def drawn_as_on_the_cpu(line: DelayLine, signal: str, streams: list) -> object:
    """Return random numbers from the streams of the CPU: one when an episode begins, then one for each physics step."""

    def draw(shape):
        numbers = np.zeros(shape)
        for world, channel in np.argwhere(line._most.cpu().numpy() > 0):
            name = f"noise.jitter.{signal}{'.legs' if channel else ''}"
            is_begin = len(shape) == 2
            if is_begin and name in streams[world]:
                continue
            generator = streams[world].setdefault(name, stream(int(world), name))
            numbers[world, channel] = generator.random() if is_begin else generator.random(shape[2])
        return torch.tensor(numbers, device=line.arrived.device)

    return draw


def test_delays_vary_as_on_the_cpu_to_the_physics_step_if_the_same_numbers_are_drawn(pair):
    """Those of senses and of commands, of arms and of legs, at two ages."""
    (ours, theirs), streams = pair([jittered(1), jittered(20)]), [{}, {}]

    def draw_as_on_the_cpu() -> dict[str, DelayLine]:
        lines = {name: sense.line for name, sense in ours.worlds.bound.senses.items()}
        for name, line in {**lines, "motor": ours.worlds.bound.commands}.items():
            line._uniforms = drawn_as_on_the_cpu(line, name, streams)
        return lines

    lines = draw_as_on_the_cpu()
    ours.reset(seed=0), theirs.reset(seed=0)
    generator, deviations = np.random.default_rng(1), set()
    angles = [name.endswith("[rad]") for name in theirs.infants[0].layout("proprioception")]
    for step in range(20):
        if step == 12:  # To ages with the same delays.
            ours.grow([1.2, 19.8]), theirs.grow([1.2, 19.8])
            lines = draw_as_on_the_cpu()
        action = random_actions(theirs, generator)
        seen, expected = ours.step(action)[0], theirs.step(action)[0]
        errors = np.abs(seen["proprioception"] - expected["proprioception"])
        assert errors[:, angles].max() < 1e-4
        assert np.abs(seen["vestibular"] - expected["vestibular"]).max() < 3e-3
        deviations.update(lines["proprioception"].deviations.cpu().numpy().ravel().tolist())
    assert deviations == {-2, -1, 0, 1, 2}


def line_of(delay: int, jitter: int, period: int, uniforms: object, are_commands: bool = False) -> DelayLine:
    """Return a line of one number in one world."""
    delays = Delays(*(np.array([[number]]) for number in (delay, jitter, 0)))
    return DelayLine(delays, period, put(np.zeros(1, int)), uniforms, are_commands)


def drawn_by(streams: NoiseStreams) -> object:
    """Return random numbers of 64 bits from a stream of the CPU."""
    return lambda shape: put(streams["jitter.x"].random(shape)).double()


def arriving(line: DelayLine, clock: int, period: int) -> float:
    """Return when the sample was taken that arrives at the end of a control step."""
    line.advance(period)
    for rest in sorted(line.rests, reverse=True):
        line.send(put(clock), put(np.full((1, 1), float(clock * period - rest))), int(rest))
    return line.receive(put(clock)).item()


DELAYS = st.integers(1, 5), st.integers(0, 12), st.integers(0, 4), st.integers(0, 2**32)
"""The control step, a delay and its jitter, in physics steps, and a seed."""


@settings(max_examples=30)
@given(*DELAYS)
def test_samples_arrive_as_on_the_cpu(period, delay, jitter, seed):
    most, (ours, theirs) = min(jitter, delay), (NoiseStreams(seed), NoiseStreams(seed))
    line, samples = (
        line_of(delay, most, period, drawn_by(ours)),
        DelayedSamples(Delay(delay, most, theirs, "jitter.x"), period),
    )
    line.fill(put(np.ones(1, bool)), put(np.zeros((1, 1))))
    samples.reset(0.0)
    for clock in range(1, 25):
        if most:
            samples.begin()
        for after in samples.sampled_after:
            samples.send(float((clock - 1) * period + after))
        assert max(arriving(line, clock, period), 0) == samples.arrived


@settings(max_examples=30)
@given(*DELAYS)
def test_commands_arrive_as_on_the_cpu(period, delay, jitter, seed):
    most, (ours, theirs) = min(jitter, delay), (NoiseStreams(seed), NoiseStreams(seed))
    line = line_of(delay, most, period, drawn_by(ours), are_commands=True)
    one = np.arange(1)
    commands, controls = DelayedCommands(Delay(delay, most, theirs, "jitter.x"), period, one, one), np.zeros(1)
    line.fill(put(np.ones(1, bool)), put(np.zeros((1, 1))))
    commands.reset()
    for clock in range(1, 25):
        line.send(put(clock), put(np.full((1, 1), float(clock))))
        commands.begin(np.full(1, float(clock)))
        for after in range(period):
            line.advance(1)
            if after in commands.applied_after:
                commands.apply(controls)
            assert line.receive(put(clock), after).item() == controls


@settings(max_examples=20)
@given(*DELAYS[:3], st.booleans())
def test_a_delay_that_could_vary_and_does_not_is_a_plain_one(period, delay, jitter, are_commands):
    lines = [line_of(delay, most, period, lambda shape: put(np.full(shape, 0.5)), are_commands) for most in (0, jitter)]
    for line in lines:
        line.fill(put(np.ones(1, bool)), put(np.zeros((1, 1))))
    for clock in range(1, 20):
        if are_commands:
            for line in lines:
                line.send(put(clock), put(np.full((1, 1), float(clock))))
            for after in range(period):
                plain, varying = (line.receive(put(clock), after).item() for line in lines)
                assert plain == varying
        else:
            plain, varying = (max(arriving(line, clock, period), 0) for line in lines)
            assert plain == varying


@settings(max_examples=30)
@given(st.integers(1, 4), st.integers(1, 12), st.integers(1, 12), st.integers(1, 4), st.integers(0, 2**32))
def test_nothing_is_overtaken_when_delays_change_in_the_midst_of_an_episode(period, first, then, jitter, seed):
    uniforms = drawn_by(NoiseStreams(seed))
    before, after = (line_of(delay, min(jitter, delay), period, uniforms) for delay in (first, then))
    before.fill(put(np.ones(1, bool)), put(np.zeros((1, 1))))
    told = [arriving(before, clock, period) for clock in range(1, 12)]
    after.restore(put(11), before.history(put(11)))
    after.deviate(before.deviations)
    told += [after.receive(put(11)).item(), *(arriving(after, clock, period) for clock in range(12, 40))]
    assert (np.diff(told) >= 0).all()
    assert 0 <= 39 * period - told[-1] - then + min(jitter, then) <= 2 * min(jitter, then)


def a_line(worlds: int) -> DelayLine:
    """Return a line of two numbers that vary by up to 3 and 1 physics steps."""
    delays = Delays(np.array([[4, 1]]), np.array([[3, 1]]), np.array([[0, 1]]))
    chance = CounterRandom(put(np.arange(worlds)))
    line = DelayLine(delays, 2, put(np.zeros(worlds, int)), chance.uniforms_of(0))
    line.chance = chance
    return line


def test_deviations_are_equally_likely_at_any_time_and_change_by_a_step_at_most():
    line = a_line(6000)
    line.fill(put(np.ones(6000, bool)), put(np.zeros((6000, 2))))
    before = line.deviations.clone()
    for step in range(9):
        most = (3, 1)
        for channel, limit in enumerate(most):
            counts = torch.bincount(line.deviations[:, channel] + limit, minlength=2 * limit + 1).cpu().numpy()
            assert np.abs(counts / 6000 - 1 / (2 * limit + 1)).max() < 0.025, (step, channel)
        line.chance.steps += 1
        line.advance(1)
        moves = (line.deviations - before).abs()
        assert moves.max() == 1
        before = line.deviations.clone()


def test_nothing_that_was_sent_later_arrives_earlier():
    line = a_line(50)
    line.fill(put(np.ones(50, bool)), put(np.zeros((50, 2))))
    former = line.arrived.clone()
    for clock in range(1, 30):
        line.advance(2)
        for rest in (1, 0):
            line.send(put(clock), put(np.full((50, 2), 2.0 * clock - rest)), rest)
            line.chance.steps += 1
        arrived = line.receive(put(clock))
        assert (arrived >= former).all()
        late = 2 * clock - arrived[:, 0]
        assert clock < 5 or ((late >= 1) & (late <= 7)).all()
        former = arrived.clone()


def test_a_history_goes_into_lines_with_other_delays_in_order():
    """The newest stay on their way; where there is room for more, the oldest is there for longer."""
    body = put(np.zeros(2, int))

    def line_with(delay: int) -> DelayLine:
        delays = Delays(np.array([[delay]]), np.zeros((1, 1), int), np.zeros((1, 1), int))
        return DelayLine(delays, 2, body, CounterRandom(body).uniforms_of(0))

    line = line_with(6)
    for clock in range(10):
        line.send(put(clock), put(np.full((2, 1), float(clock))), 0)
    history = line.history(put(9))
    assert history[0, :, 0].tolist() == [9, 8, 7, 6]
    for delay, arriving in ((6, [6, 7, 8, 9, 10]), (2, [8, 9, 10, 11, 12]), (10, [6, 6, 6, 7, 8])):
        other, arrived = line_with(delay), []
        other.restore(put(9), history)
        for clock in range(9, 14):
            if clock > 9:
                other.send(put(clock), put(np.full((2, 1), float(clock))), 0)
            arrived.append(other.receive(put(clock))[0, 0].item())
        assert arrived == arriving
