"""MuJoCo Warp: its model of a scene, and ten steps that are MuJoCo's."""

from pathlib import Path

import mujoco
import mujoco_warp
import numpy as np
import warp

STEPS = 10


def use(bundles: Path) -> str:
    largest = 0.0
    for name in ("nine_months", "muscle"):
        model = mujoco.MjModel.from_xml_path(str(bundles / name / "scene.xml"))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("supine").id)
        mujoco.mj_forward(model, data)
        with warp.ScopedDevice("cpu"):
            worlds = mujoco_warp.put_data(model, data, nworld=2, nconmax=100, njmax=1000)
            there = mujoco_warp.put_model(model)
            for _ in range(STEPS):
                mujoco_warp.step(there, worlds)
        mujoco.mj_step(model, data, STEPS)
        difference = np.abs(worlds.qpos.numpy() - data.qpos)
        largest = max(largest, float(difference.max()))
    assert largest < 1e-3
    return f"largest difference {largest:.1e} after {STEPS} steps"
