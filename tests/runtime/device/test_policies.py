"""Policies of many act for infants on a device as for the same infants on the CPU."""

import numpy as np
import pytest
import torch
from support.devices import DEVICE, infant

import mimoc
from mimoc.base.errors import PolicyError
from mimoc.schema.kinds import POLICIES

AGES_MONTHS = (1.0, 9.0)
STEPS = 4
SENSES = {"proprioception": {}, "vestibular": {}, "touch": {"density": 0.3}}
MANY = [name for name in POLICIES if POLICIES[name].many]


@pytest.fixture(scope="module")
def bundles():
    keys = {"actuation": {"model": "muscle"}, "senses": SENSES, "scene": {"kind": "flat", "pose": "supine"}}
    return [infant(age, **keys) for age in AGES_MONTHS]


@pytest.fixture(scope="module", params=["torch", "numpy"])
def on_device(request, bundles):
    envs = mimoc.make_vec(bundles, 4, device=DEVICE, arrays=request.param, touch="points")
    yield envs
    envs.close()


def on_cpu_as_numpy(array):
    return array if isinstance(array, np.ndarray) else array.cpu().numpy()


def generators():
    return [np.random.default_rng(seed) for seed in range(4)]


@pytest.mark.slow
@pytest.mark.parametrize("name", [*MANY, "+".join(MANY)])
def test_actions_on_a_device_are_those_of_the_cpu_for_the_same_observations(bundles, on_device, name):
    on_cpu = mimoc.make_vec(bundles, 4)
    ours, theirs = mimoc.policy_vec(name, on_device), mimoc.policy_vec(name, on_cpu)
    here, there = generators(), generators()
    observations, _ = on_device.reset(seed=0)
    on_cpu.reset(seed=0)
    for _ in range(STEPS):
        actions = ours(here, observations)
        if on_device.arrays == "torch":
            assert (actions.dtype, actions.device) == (torch.float32, observations["touch"].device)
        copies = {name: on_cpu_as_numpy(part).copy() for name, part in observations.items()}
        expected = theirs(there, copies)
        np.testing.assert_allclose(on_cpu_as_numpy(actions), expected, atol=2e-4)
        observations, _, terminated, truncated, _ = on_device.step(actions)
        ours.reset(terminated | truncated)
        theirs.reset(np.zeros(4, bool))
    on_cpu.close()


@pytest.mark.slow
def test_reflexes_read_the_sums_of_touch_on_bodies(bundles, make):
    envs = make(bundles, 2, arrays="torch", touch="bodies")
    policy = mimoc.policy_vec("reflexes", envs)
    observations, _ = envs.reset(seed=0)
    touched = dict(observations)
    names = envs.infants[0].senses["touch"].receptors
    model = envs.infants[0].model
    hand = [model.body(body).name for body in np.unique(names.bodies)].index("right_hand")
    touched["touch"] = observations["touch"] * 0
    touched["touch"][:, 3 * hand + 1] = 5.0  # It presses along y: into the palm of a right hand.
    actions = policy(generators()[:2], touched)
    fingers = [item.name for item in envs.infants[0].manifest.actuation.actuators].index("act:right_fingers_negative")
    assert (actions[0, fingers] > 0.5).item()
    assert (actions[1, fingers] == 0).item()  # The infant of nine months has lost the reflex.


@pytest.mark.slow
def test_policies_of_single_infants_are_refused(on_device):
    with pytest.raises(PolicyError, match="'reach' acts for single infants on the CPU; make the environment without"):
        mimoc.policy_vec("reach", on_device)
