"""dm_control's mjcf: the scene as it is, whose physics are MuJoCo's own, and two infants in an arena."""

from pathlib import Path

import mujoco
import numpy as np
from dm_control import mjcf

STEPS = 20


def use(bundles: Path) -> str:
    skins = 0
    for name in ("nine_months", "muscle", "all_senses"):
        scene = bundles / name / "scene.xml"
        physics = mjcf.Physics.from_mjcf_model(mjcf.from_path(str(scene)))
        model = mujoco.MjModel.from_xml_path(str(scene))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("sitting").id)
        physics.reset(keyframe_id=physics.model.name2id("sitting", "key"))
        np.testing.assert_array_equal(physics.data.qpos, data.qpos)
        physics.step(STEPS)
        mujoco.mj_step(model, data, STEPS)
        np.testing.assert_allclose(physics.data.qpos, data.qpos, atol=1e-6)
        assert physics.model.nskin == model.nskin > 0
        skins += model.nskin
    arena = mjcf.RootElement(model="nursery")
    for y, name in enumerate(("nine_months", "muscle")):
        infant = mjcf.from_path(str(bundles / name / "infant.xml"))
        infant.model, infant.option.integrator = name, "implicitfast"
        arena.option.timestep = infant.option.timestep
        arena.size.nuser_actuator = infant.size.nuser_actuator
        infant.find("body", "hip").freejoint.remove()
        arena.worldbody.add("site", pos=(0, y, 0)).attach(infant).add("freejoint")
    physics = mjcf.Physics.from_mjcf_model(arena)
    physics.step(STEPS)
    assert physics.bind(arena.find("body", "muscle/head")).xpos[2] > 0
    return f"{skins} skins in 3 scenes, and {physics.model.nskin} in an arena"
