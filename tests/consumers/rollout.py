"""MuJoCo's rollout: the same states as one step after another, from the poses of a bundle."""

from pathlib import Path

import mujoco
import numpy as np
from mujoco import rollout

STEPS = 20


def use(bundles: Path) -> str:
    compared = 0
    for scene in sorted(bundles.glob("*/scene.xml")):
        model = mujoco.MjModel.from_xml_path(str(scene))
        data = mujoco.MjData(model)
        kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
        commands = np.random.default_rng(0).uniform(*model.actuator_ctrlrange.T, (model.nkey, STEPS, model.nu))
        starts, ends = np.zeros((2, model.nkey, mujoco.mj_stateSize(model, kind)))
        for key in range(model.nkey):
            mujoco.mj_resetDataKeyframe(model, data, key)
            mujoco.mj_getState(model, data, starts[key], kind)
            for data.ctrl[:] in commands[key]:
                mujoco.mj_step(model, data)
            mujoco.mj_getState(model, data, ends[key], kind)
        states, sensed = rollout.rollout(model, mujoco.MjData(model), starts, commands)
        assert sensed.shape[2] == model.nsensordata > 0
        np.testing.assert_allclose(states[:, -1], ends, rtol=1e-6, atol=1e-6)
        compared += model.nkey
    assert compared
    return f"{compared} poses, {STEPS} steps each"
