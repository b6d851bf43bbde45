"""Noise on MuJoCo Warp depends on nothing but the seed of its world; its terms are those of the CPU."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pytest
import torch
from support.devices import SITTING, sitting, spec, still

import mimoc
from mimoc.compiler.mjcf.scene import Placed
from mimoc.runtime.device.arrays import put
from mimoc.runtime.device.signals import CounterRandom
from mimoc.runtime.noise import LowPass, Noise
from mimoc.runtime.sense import TermSense
from mimoc.runtime.term import Field
from mimoc.schema.base import Model
from mimoc.schema.kinds import NoiseOption, SenseKind

NOISE = {"motor": 0.2, "proprioception_deg": 2.0, "vestibular_thresholds": 1.0, "touch_n": 0.5}


def test_random_numbers_are_normal_and_independent_of_each_other():
    """Over places, over worlds, over time, and over the channels that begin at other places."""
    chance = CounterRandom(put(np.arange(200)))
    numbers = [chance.normals(0, (200, 2, 50)).cpu().numpy().copy()]
    numbers.append(chance.normals(1 << 24, (200, 2, 50)).cpu().numpy().copy())
    chance.steps += 1
    numbers.append(chance.normals(0, (200, 2, 50)).cpu().numpy().copy())
    values = np.stack(numbers)
    assert abs(values.mean()) < 0.02
    assert abs(values.std() - 1) < 0.02
    assert abs((values**4).mean() - 3) < 0.2
    for one, other in ((0, 1), (0, 2), (1, 2)):
        assert abs((values[one] * values[other]).mean()) < 0.03
    assert abs((values[:, 1:] * values[:, :-1]).mean()) < 0.03
    assert abs((values[..., 1:] * values[..., :-1]).mean()) < 0.03


def test_random_numbers_follow_the_seed_of_a_world_alone():
    one, other = (CounterRandom(put(seeds)) for seeds in ([3, 4, 4], [9, 8, 4]))
    mine, theirs = one.normals(0, (3, 40)), other.normals(0, (3, 40))
    assert torch.equal(mine[1], mine[2])
    assert torch.equal(mine[1], theirs[2])
    assert not torch.equal(mine[0], mine[1])
    one.steps += 1
    one.restart({0: 4})
    assert torch.equal(one.normals(0, (3, 40))[0], theirs[2])


def test_noise_depends_on_the_seed_alone_and_leaves_a_still_infant_near_the_truth(make):
    noisy = make(sitting(noise=NOISE), 3, touch="bodies")
    exact = noisy.infants[0]
    exact.reset(seed=0)
    command = still(noisy)
    first = [noisy.reset(seed=[1, 2, 2])[0], noisy.step(command)[0]]
    again = [noisy.reset(seed=[7, 2, 1])[0], noisy.step(command)[0]]
    angles = [index for index, name in enumerate(exact.layout("proprioception")) if name.endswith("[rad]")]
    truth = exact.senses["proprioception"](exact.data)[angles]
    for ours, others in zip(first, again, strict=True):
        for name, values in ours.items():
            for row, same in ((values[2], values[1]), (others[name][1], values[1]), (others[name][2], values[0])):
                errors = np.abs(row - same) / np.maximum(1.0, np.abs(same))  # A GPU sums in any order.
                assert np.quantile(errors, 0.95) < 1e-3
        errors = ours["proprioception"][:2, angles] - truth
        assert 0.5 < errors.std() / math.radians(2) < 1.5
        assert (ours["proprioception"][0] != ours["proprioception"][1]).any()


class PlaceSpec(Model):
    """Where the trunk is."""


class PlaceEntry(Model):
    """Where the trunk is."""

    kind: Literal["place"] = "place"
    """Name of the sense."""


@dataclass(frozen=True)
class Drift(Noise):
    """Each number is wrong by an error that changes gradually."""

    deviation_m: np.ndarray
    low_pass: LowPass

    def __call__(self, draw, sample, state):
        state = self.low_pass(state, draw.elapsed_s, draw.normals(sample.shape))
        return sample + self.deviation_m * state, state


def bind_place(entry, model, bundle):
    return TermSense("place", Field("qpos", np.arange(3)), [f"{axis} [m]" for axis in "xyz"], -10.0, 10.0)


def bind_drift(amount_m, sense, low_pass_s):
    return Drift(np.array([amount_m]), LowPass(low_pass_s))


PLACE = SenseKind(
    "place",
    PlaceSpec,
    PlaceEntry,
    lambda spec, body: Placed(PlaceEntry()),
    bind_place,
    noise=NoiseOption("m", "Standard deviation of each number.", most=1.0, run=bind_drift),
)


def test_noise_that_a_plugin_brings_acts_on_one_on_many_and_on_a_device(registered, make):
    """Over the first observations of 40 seeds, and in the step after each."""
    with registered(PLACE):
        bundle = mimoc.build(spec(senses={"place": {}}, scene=SITTING, noise={"place_m": 0.1}))
        one, many, device = mimoc.make(bundle), make(bundle, 40, device="cpu", threads=1), make(bundle, 40)
        true = one.unwrapped.data.qpos[:3]
        command = np.zeros(one.action_space.shape, np.float32)
        errors = [np.array([one.reset(seed=seed)[0]["place"] for seed in range(40)]) - true]
        for envs in (many, device):
            errors.append(envs.reset(seed=0)[0]["place"] - true)
            later = envs.step(np.broadcast_to(command, envs.action_space.shape))[0]["place"] - true
            correlation = np.corrcoef(errors[-1][:, 0], later[:, 0])[0, 1]
            assert correlation == pytest.approx(math.exp(-10 / 60), abs=0.2)
        assert np.array_equal(errors[0], errors[1])
        assert [error.std() for error in errors] == pytest.approx([0.1] * 3, rel=0.25)
        one.close()
