"""Objects on MuJoCo Warp: they are where the spec, or a reset, puts them, and stay there as infants grow."""

from contextlib import closing

import numpy as np
import pytest
from support.devices import DEVICE
from support.scenes_of_objects import spec_with

import mimoc
from mimoc.base.errors import UnknownNameError

SPEC = {
    **spec_with(
        {"name": "ball", "radius_cm": 4, "at": "within reach of right_hand"},
        {"name": "post", "shape": "box", "motion": "fixed", "at": {"x_cm": 60, "y_cm": 0}},
        {"name": "bead", "above": "chest", "height_cm": 25},
        {
            "name": "mobile",
            "kind": "mobile",
            "figures": ["ball", "ball"],
            "above": "head",
            "height_cm": 45,
            "tied_to": "left_foot",
        },
        age_months=3,
    ),
    "actuation": {"model": "torque"},
    "senses": {"proprioception": {}},
}
ELSEWHERE = {"ball": "within reach of left_hand", "post": {"x_cm": 40, "y_cm": 30}}


def places(envs, name: str) -> np.ndarray:
    infant = envs.unwrapped.infants[0]
    return envs.unwrapped.worlds.data.xpos.numpy()[:, infant.model.body(f"object_{name}").id].copy()


def test_objects_move_and_stay_on_a_device_as_on_the_cpu():
    spec, still = mimoc.InfantSpec.model_validate(SPEC), np.zeros((2, 1), np.float32)
    with closing(mimoc.make(spec)) as single, closing(mimoc.make_vec(spec, num_envs=2, device=DEVICE)) as envs:
        still = np.zeros(envs.action_space.shape, np.float32)
        for options in ({}, {"objects": ELSEWHERE}):
            single.reset(seed=0, options=options)
            envs.reset(seed=0, options=options)
            for _ in range(3):
                single.step(still[0])
                envs.step(still)
            for name in ("ball", "post", "bead", "mobile"):
                expected = single.unwrapped.data.body(f"object_{name}").xpos
                np.testing.assert_allclose(places(envs, name), np.tile(expected, (2, 1)), atol=1e-4, err_msg=name)
        moved = places(envs, "post")
        for moves, error in (({"ball": {"x_cm": 0, "y_cm": 0}}, ValueError), ({"bal": "on post"}, UnknownNameError)):
            with pytest.raises(error):
                envs.reset(options={"objects": moves})
        states = envs.unwrapped.get_state()
        envs.reset(seed=0)
        envs.step(still)
        assert np.abs(places(envs, "post") - moved).max() > 0.1
        envs.unwrapped.set_state(states)
        envs.unwrapped.grow([6, None])
        envs.step(still)
        np.testing.assert_allclose(places(envs, "post"), moved, atol=1e-6)
