"""Infants among furniture run in batches and on a device as they do alone."""

import numpy as np
import pytest
from support.devices import DEVICE
from support.furnished import spec_with

import mimoc

LAB = [
    {"name": "chair", "kind": "seat"},
    {"name": "table", "kind": "table", "sides_cm": [35, 60], "top_cm": 45, "at": {"x_cm": 32, "y_cm": 0}},
    {"name": "cup", "shape": "cylinder", "radius_cm": 3, "length_cm": 6, "at": "on table"},
    {"name": "mat", "kind": "mat", "at": {"x_cm": 0, "y_cm": 120}},
    {"name": "ball", "shape": "sphere", "at": "on mat"},
]
SENSES = {"proprioception": {"include": ["velocity"]}, "vestibular": {}}


def bundle(age_months: float) -> mimoc.Bundle:
    return mimoc.build(spec_with(LAB, age_months, pose="sitting", start_at="chair", senses=SENSES))


def test_an_infant_in_a_batch_is_that_of_a_single_environment_to_the_bit():
    bundles = [bundle(6), bundle(12)]
    batch, singles = mimoc.make_vec(bundles, 2, threads=1), [mimoc.make(item) for item in bundles]
    batch.reset(seed=[3, 4])
    for seed, env in enumerate(singles, start=3):
        env.reset(seed=seed)
    generator = np.random.default_rng(0)
    for _ in range(5):
        actions = generator.uniform(-1, 1, batch.action_space.shape).astype(np.float32)
        together = batch.step(actions)[0]
        for index, env in enumerate(singles):
            alone = env.step(actions[index])[0]
            for name, values in alone.items():
                assert (together[name][index] == values).all(), name
    for env in (batch, *singles):
        env.close()


@pytest.mark.extras
@pytest.mark.slow
@pytest.mark.usefixtures("kernels_compiled_quickly")
def test_on_a_device_furniture_bears_what_it_does_on_the_cpu():
    bundles = [bundle(6), bundle(12)]
    ours, theirs = mimoc.make_vec(bundles, 2, device=DEVICE), mimoc.make_vec(bundles, 2, threads=1)
    for env in (ours, theirs):
        env.reset(seed=0)
    still = np.zeros(theirs.action_space.shape, np.float32)
    for _ in range(10):
        ours.step(still), theirs.step(still)
    qpos = ours.worlds.data.qpos.numpy()
    for index, infant in enumerate(theirs.infants):
        for name in ("object_cup_free", "object_ball_free", "mimo_location"):
            address = infant.model.joint(name).qposadr[0]
            expected = infant.data.qpos[address : address + 3]
            assert qpos[index, address : address + 3] == pytest.approx(expected, abs=1e-3), name
    for env in (ours, theirs):
        env.close()
