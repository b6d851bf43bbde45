"""
Two infants in one MuJoCo model
===============================

`infant.xml` of a bundle is an infant by itself. Attached twice with prefixes, it is a pair, in plain MuJoCo.
"""

import tempfile
from contextlib import closing
from pathlib import Path

import matplotlib.pyplot as plt
import mujoco

import mimoc
from mimoc.render.body_camera import BodyCamera

OPTIONS = ["timestep", "integrator", "cone", "jacobian", "solver", "iterations", "ls_iterations", "tolerance"]
OPTIONS += ["disableflags"]

spec = mimoc.InfantSpec(mimoc=1, name="twin", age_months=12, senses={})
host = mujoco.MjSpec()
host.visual.headlight.ambient = [0.5] * 3
host.worldbody.add_light(pos=[0, 0, 3], diffuse=[0.7] * 3)
host.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[2, 2, 1], rgba=[0.5, 0.6, 0.6, 1])
with tempfile.TemporaryDirectory() as folder:
    bundle = mimoc.build(spec)
    mimoc.write_bundle(bundle, Path(folder) / "twin")
    for prefix, y in (("anna_", -0.25), ("ben_", 0.25)):
        infant = mujoco.MjSpec.from_file(str(Path(folder) / "twin" / "infant.xml"))
        for option in OPTIONS:
            setattr(host.option, option, getattr(infant.option, option))
        host.nuser_actuator = infant.nuser_actuator
        host.attach(infant, prefix=prefix, frame=host.worldbody.add_frame(pos=[0, y, 0]))
    model = host.compile()

data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
with closing(
    BodyCamera(model, [prefix + bundle.manifest.root_body for prefix in ("anna_", "ben_")], 400, 300)
) as camera:
    plt.imshow(camera.render(data))
plt.axis("off")
plt.show()
