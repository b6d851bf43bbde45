"""Noise on MuJoCo Warp is distributed as on the CPU, and depends on nothing but the seed of its world."""

import math

import numpy as np
import pytest
import warp as wp
from support.devices import DEVICE

import mimoc
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.chance import Chance
from mimoc.runtime.warp.noise import MotorNoise, ProprioceptionNoise, TouchNoise

WORLDS = 300
NOISE = {"motor": 0.2, "proprioception_deg": 2.0, "touch_n": 0.5}
SENSES = {"proprioception": {"include": ["velocity", "torque", "limits", "actuation"]}, "vestibular": {}}
LOW_PASS_S = 0.06


def build(**keys: object) -> mimoc.Bundle:
    """Return an infant with the kernels of those in `test_worlds`."""
    spec = {
        "mimoc": 1,
        "name": "infant",
        "age_months": 9,
        "senses": {**SENSES, "touch": {"density": 0.5}},
        "scene": {"kind": "flat", "pose": "sitting"},
        **keys,
    }
    return mimoc.build(mimoc.InfantSpec.model_validate(spec))


@pytest.fixture(scope="module")
def infant():
    env = InfantEnv(build(noise=NOISE))
    env.reset(seed=0)
    yield env
    env.close()


@pytest.fixture
def chance():
    return Chance(wp.array(np.arange(WORLDS), dtype=int))


def body():
    return wp.zeros(WORLDS, dtype=int)


def test_sensed_angles_drift_smoothly_with_the_deviation_that_is_given(infant, chance):
    """Their values, those of the rates, and the correlation of both over time are what the CPU's noise says."""
    noise = ProprioceptionNoise([infant], body(), chance, 1)
    layout = infant.layout("proprioception")
    angles, rates = (np.flatnonzero([name.endswith(unit) for name in layout]) for unit in ("[rad]", "[rad/s]"))
    found = []
    for elapsed_s in (math.inf, 0.03):
        sample = wp.zeros((WORLDS, len(layout)), dtype=float)
        noise(sample, elapsed_s=elapsed_s)
        chance.advance()
        found.append(sample.numpy().copy())
    first, later = (values[:, angles] / math.radians(2) for values in found)
    assert abs(first.mean()) < 0.05
    assert (first.std(), later.std()) == pytest.approx((1, 1), abs=0.03)
    past = 0.03 / LOW_PASS_S
    assert (first * later).mean() == pytest.approx(math.exp(-past) * (1 + past), abs=0.05)
    assert found[1][:, rates].std() == pytest.approx(math.radians(2) / LOW_PASS_S, rel=0.03)
    others = np.setdiff1d(np.arange(len(layout)), [*angles, *rates])
    assert not found[1][:, others].any()


def test_the_size_of_felt_forces_varies_and_not_their_direction(infant, chance):
    forces = np.zeros((WORLDS, 40, 3), np.float32)
    forces[:, ::2] = (0, 0.6, -0.8)
    forces[:, ::4] *= 5
    sample = wp.array(forces.reshape(WORLDS, -1), dtype=float)
    TouchNoise([infant], body(), chance, 3)(sample)
    found = sample.numpy().reshape(forces.shape)
    assert not found[:, 1::2].any()
    sizes = np.linalg.norm(found, axis=-1)
    assert sizes[:, ::4].mean() == pytest.approx(5, abs=0.05)
    assert sizes[:, ::4].std() == pytest.approx(0.5, abs=0.03)
    assert sizes[:, 2::4].min() == 0
    strong = found[:, ::4] / sizes[:, ::4, None]
    assert strong == pytest.approx(np.broadcast_to([0, 0.6, -0.8], strong.shape), abs=1e-5)


def test_motors_are_driven_by_their_commands_and_noise_in_proportion(infant, chance):
    """With a standard deviation that is a share of the command, and a correlation by its time constant."""
    count = len(infant.actuation.actuators)
    noise = MotorNoise([infant], body(), chance, timestep_s=0.005)
    high = np.broadcast_to(infant.actuation.high, (WORLDS, count))
    noise.begin(wp.zeros(WORLDS, dtype=int), wp.array(0.5 * high[:1], dtype=float))
    driven = []
    for _ in range(13):
        chance.advance()
        controls = wp.zeros((WORLDS, infant.model.nu), dtype=float)
        noise(controls)
        driven.append(controls.numpy()[:, infant.actuation.actuators] / (0.5 * high) - 1)
    assert abs(np.mean(driven)) < 0.02
    assert driven[0].std() == pytest.approx(0.2, abs=0.006)
    assert driven[-1].std() == pytest.approx(0.2, abs=0.006)
    assert (driven[0] * driven[-1]).mean() / 0.04 == pytest.approx(math.exp(-0.06 / LOW_PASS_S), abs=0.04)


def assert_same(values: np.ndarray, expected: np.ndarray) -> None:
    """Compare what is sensed, up to a GPU's order of sums, by which a light contact may vanish with its noise."""
    errors = np.abs(values - expected) / np.maximum(1.0, np.abs(expected))
    assert np.quantile(errors, 0.95) < 1e-3


def test_noise_depends_on_the_seed_alone_and_leaves_a_still_infant_near_the_truth():
    noisy = mimoc.make_vec(build(noise=NOISE, delays={"sensory_ms": 5}), 3, device=DEVICE, touch="bodies")
    exact = mimoc.make_vec(build(delays={"sensory_ms": 5}), device=DEVICE)
    command = np.zeros(noisy.action_space.shape, np.float32)

    def live(seeds: list[int]) -> list[dict[str, np.ndarray]]:
        return [noisy.reset(seed=seeds)[0], *(noisy.step(command)[0] for _ in range(3))]

    first, again, other = live([1, 2, 2]), live([1, 2, 2]), live([7, 2, 1])
    truth = [exact.reset(seed=0)[0], *(exact.step(command[:1])[0] for _ in range(3))]
    angles = [index for index, name in enumerate(noisy.infants[0].layout("proprioception")) if name.endswith("[rad]")]
    for ours, same, others, true in zip(first, again, other, truth, strict=True):
        for name in true:
            assert_same(ours[name], same[name])
            assert_same(ours[name][1], ours[name][2])
            assert_same(ours[name][1], others[name][1])
            assert_same(ours[name][0], others[name][2])
        errors = (ours["proprioception"] - true["proprioception"])[:2, angles]
        assert 0.5 < errors.std() / math.radians(2) < 1.5
        assert (ours["proprioception"][0] != ours["proprioception"][1]).any()
    noisy.close(), exact.close()
