"""Delays that vary do so on MuJoCo Warp as on the CPU."""

import numpy as np
import torch
from support import store
from support.devices import DEVICE

import mimoc
from mimoc.base.random_streams import stream
from mimoc.runtime.device.arrays import put
from mimoc.runtime.device.lines import DelayLine, Delays
from mimoc.runtime.device.noise import CounterRandom

SENSES = {"proprioception": {"include": ["velocity", "torque", "limits", "actuation"]}, "vestibular": {}}


def jittered(age_months: float) -> mimoc.Bundle:
    keys = {"delays": {"preset": "physiological"}, "noise": {"delay_jitter_ms": 10}}
    return store.built({"mimoc": 1, "name": "infant", "age_months": age_months, "senses": SENSES, **keys})


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


def test_delays_vary_as_on_the_cpu_to_the_physics_step_if_the_same_numbers_are_drawn():
    """Those of senses and of commands, of arms and of legs, at two ages."""
    bundles = [jittered(1), jittered(20)]
    ours, theirs = mimoc.make_vec(bundles, device=DEVICE), mimoc.make_vec(bundles, threads=1)
    streams = [{}, {}]
    lines = {name: sense.line for name, sense in ours.worlds.bound.senses.items()}
    for name, line in {**lines, "motor": ours.worlds.bound.commands}.items():
        line._uniforms = drawn_as_on_the_cpu(line, name, streams)
    ours.reset(seed=0), theirs.reset(seed=0)
    generator, deviations = np.random.default_rng(1), set()
    angles = [name.endswith("[rad]") for name in theirs.infants[0].layout("proprioception")]
    for _ in range(20):
        action = generator.uniform(-1, 1, theirs.action_space.shape).astype(np.float32)
        seen, expected = ours.step(action)[0], theirs.step(action)[0]
        errors = np.abs(seen["proprioception"] - expected["proprioception"])
        assert errors[:, angles].max() < 1e-4
        assert np.abs(seen["vestibular"] - expected["vestibular"]).max() < 3e-3
        deviations.update(lines["proprioception"].deviations.cpu().numpy().ravel().tolist())
    assert deviations == {-2, -1, 0, 1, 2}
    ours.close(), theirs.close()


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
