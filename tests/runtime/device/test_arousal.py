"""Infants on a device have the arousal that a reset or a policy gives each, as on the CPU."""

import numpy as np
import pytest
import torch
from support.devices import DEVICE

import mimoc
from mimoc.base.errors import UnknownNameError

LEVELS = [0.0, 2.0, 0.5]
CLOSE = 1e-4


def build(model, age_months):
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "development": "maturing"}
    spec |= {
        "actuation": {"model": model},
        "senses": {"proprioception": {}},
        "scene": {"kind": "flat", "pose": "supine"},
    }
    return mimoc.build(mimoc.InfantSpec.model_validate(spec))


@pytest.fixture(params=[("torque", (0.0, 6.0)), ("muscle", (0.0, 18.0))], ids=["torque", "muscle"])
def pair(request):
    """Return the same three infants on a device and on the CPU; one of 18 months has no tone in its muscles."""
    model, ages = request.param
    bundles = [build(model, age) for age in ages]
    both = mimoc.make_vec(bundles, 3, device=DEVICE), mimoc.make_vec(bundles, 3, threads=1)
    yield both
    for envs in both:
        envs.close()


def torques(ours, theirs):
    """Return what motors and springs do in the first physics step that follows, on both, shape (3, joints), [N m]."""
    still = np.zeros(theirs.action_space.shape, np.float32)
    ours.step(still), theirs.step(still)
    on_device = ours.worlds.data.qfrc_actuator.numpy() + ours.worlds.data.qfrc_passive.numpy()
    return on_device, np.array([each.data.qfrc_actuator + each.data.qfrc_passive for each in theirs.infants])


def assert_agree(ours, theirs):
    on_device, expected = torques(ours, theirs)
    assert np.abs(on_device - expected).max() < CLOSE * max(1.0, np.abs(expected).max())


@pytest.mark.slow
def test_motors_and_muscles_of_a_device_do_what_they_do_on_the_cpu(pair):
    ours, theirs = pair
    for envs in pair:
        envs.reset(seed=0, options={"arousal": LEVELS})
    assert_agree(ours, theirs)
    for envs in pair:
        envs.set_arousal([1.5, 0.0, 1.0])
    assert_agree(ours, theirs)
    ours.set_arousal(torch.tensor([0.3, 0.3, 9.0]))
    theirs.set_arousal([0.3, 0.3, 2.0])
    assert_agree(ours, theirs)
    for envs in pair:
        envs.reset(seed=0)
    assert ours.worlds.arousal.level.tolist() == [1.0, 1.0, 1.0] == list(theirs.get_attr("arousal"))
    assert_agree(ours, theirs)
    only_first = {"reset_mask": np.array([True, False, False]), "arousal": [0.0, 0.0, 0.0]}
    for envs in pair:
        envs.reset(seed=0, options=only_first)
    assert ours.worlds.arousal.level.tolist() == [0.0, 1.0, 1.0] == list(theirs.get_attr("arousal"))
    assert_agree(ours, theirs)
    for wrong in (2.1, [0.0, 1.0], [0.0, 1.0, "calm"]):
        with pytest.raises(ValueError, match="arousal"):
            ours.set_arousal(wrong)
    with pytest.raises(UnknownNameError, match="choose from age_months, arousal, pose, reset_mask"):
        ours.reset(options={"age": 9})
