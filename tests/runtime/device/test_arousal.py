"""Infants on a device have the arousal that a reset or a policy gives each, as on the CPU."""

import numpy as np
import pytest
import torch
from support.devices import infant, still

from mimoc.base.errors import UnknownNameError

LEVELS = [0.0, 2.0, 0.5]
CLOSE = 1e-4


def torques(ours, theirs):
    """Return what motors and springs do in the first physics step that follows, on both, shape (3, joints), [N m]."""
    ours.step(still(theirs)), theirs.step(still(theirs))
    on_device = ours.worlds.data.qfrc_actuator.numpy() + ours.worlds.data.qfrc_passive.numpy()
    return on_device, np.array([each.data.qfrc_actuator + each.data.qfrc_passive for each in theirs.infants])


def assert_agree(ours, theirs):
    on_device, expected = torques(ours, theirs)
    assert np.abs(on_device - expected).max() < CLOSE * max(1.0, np.abs(expected).max())


@pytest.mark.slow
@pytest.mark.parametrize(("model", "ages"), [("torque", (0.0, 6.0)), ("muscle", (0.0, 18.0))])
def test_motors_and_muscles_of_a_device_do_what_they_do_on_the_cpu(pair, model, ages):
    """Of three infants; one of 18 months has no tone in its muscles."""
    keys = {"development": "maturing", "actuation": {"model": model}, "senses": {"proprioception": {}}}
    scene = {"kind": "flat", "pose": "supine"}
    both = ours, theirs = pair([infant(age, scene=scene, **keys) for age in ages], 3)
    for envs in both:
        envs.reset(seed=0, options={"arousal": LEVELS})
    assert_agree(ours, theirs)
    for envs in both:
        envs.set_arousal([1.5, 0.0, 1.0])
    assert_agree(ours, theirs)
    ours.set_arousal(torch.tensor([0.3, 0.3, 9.0]))
    theirs.set_arousal([0.3, 0.3, 2.0])
    assert_agree(ours, theirs)
    for envs in both:
        envs.reset(seed=0)
    assert ours.worlds.arousal.level.tolist() == [1.0, 1.0, 1.0] == list(theirs.get_attr("arousal"))
    assert_agree(ours, theirs)
    only_first = {"reset_mask": np.array([True, False, False]), "arousal": [0.0, 0.0, 0.0]}
    for envs in both:
        envs.reset(seed=0, options=only_first)
    assert ours.worlds.arousal.level.tolist() == [0.0, 1.0, 1.0] == list(theirs.get_attr("arousal"))
    assert_agree(ours, theirs)
    for wrong in (2.1, [0.0, 1.0], [0.0, 1.0, "calm"]):
        with pytest.raises(ValueError, match="arousal"):
            ours.set_arousal(wrong)
    with pytest.raises(UnknownNameError, match="choose from age_months, arousal, pose, reset_mask"):
        ours.reset(options={"age": 9})
