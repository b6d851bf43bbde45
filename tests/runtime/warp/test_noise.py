"""Noise on MuJoCo Warp depends on nothing but the seed of its world; its terms are those of `tests/noise`."""

import math

import numpy as np
import torch
import warp as wp
from support.devices import DEVICE

import mimoc
from mimoc.runtime.warp.noise import Chance

NOISE = {"motor": 0.2, "proprioception_deg": 2.0, "touch_n": 0.5}
SENSES = {"proprioception": {"include": ["velocity", "torque", "limits", "actuation"]}, "vestibular": {}}


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


def test_random_numbers_are_normal_and_independent_of_each_other():
    """Over places, over worlds, over time, and over the channels that begin at other places."""
    chance = Chance(wp.array(np.arange(200), dtype=int))
    numbers = [chance.normals(0, (200, 2, 50)).cpu().numpy().copy()]
    numbers.append(chance.normals(1 << 24, (200, 2, 50)).cpu().numpy().copy())
    chance.advance()
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
    one, other = (Chance(wp.array(seeds, dtype=int)) for seeds in ([3, 4, 4], [9, 8, 4]))
    mine, theirs = one.normals(0, (3, 40)), other.normals(0, (3, 40))
    assert torch.equal(mine[1], mine[2])
    assert torch.equal(mine[1], theirs[2])
    assert not torch.equal(mine[0], mine[1])
    one.advance()
    one.restart({0: 4})
    assert torch.equal(one.normals(0, (3, 40))[0], theirs[2])


def test_noise_depends_on_the_seed_alone_and_leaves_a_still_infant_near_the_truth():
    noisy = mimoc.make_vec(build(noise=NOISE), 3, device=DEVICE, touch="bodies")
    exact = noisy.infants[0]
    exact.reset(seed=0)
    command = np.zeros(noisy.action_space.shape, np.float32)
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
    noisy.close()
