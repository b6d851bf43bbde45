"""MuJoCo's MjSpec: an infant with muscles and one with motors, attached to a scene of somebody else."""

from pathlib import Path

import mujoco
import numpy as np

OPTIONS = ("timestep", "cone", "jacobian", "solver", "iterations", "ls_iterations", "tolerance", "disableflags")


def use(bundles: Path) -> str:
    host = mujoco.MjSpec()
    host.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[5, 5, 1])
    alone = []
    for y, name in enumerate(("muscle", "nine_months")):
        infant = mujoco.MjSpec.from_file(str(bundles / name / "infant.xml"))
        alone.append(mujoco.MjModel.from_xml_path(str(bundles / name / "infant.xml")))
        for option in OPTIONS:
            setattr(host.option, option, getattr(infant.option, option))
        host.option.integrator = infant.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        host.nuser_actuator = infant.nuser_actuator
        host.attach(infant, prefix=f"{name}_", frame=host.worldbody.add_frame(pos=[0, y, 0]))
    model = host.compile()
    assert model.nu == sum(each.nu for each in alone)
    assert model.ntendon == sum(each.ntendon for each in alone)
    vertices = np.concatenate([each.skin_vert for each in alone])
    np.testing.assert_array_equal(model.skin_vert, vertices)  # Though files of both have the same names.
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 50)
    assert np.isfinite(data.qpos).all()
    assert not data.warning.number.any()
    return f"{model.nbody} bodies, {model.nskin} skins"
