"""MuJoCo's USD exporter: the solids of an infant, whose skin it cannot write, as files that OpenUSD opens."""

import tempfile
from pathlib import Path

import mujoco
from mujoco.usd.exporter import USDExporter
from pxr import Usd, UsdGeom

SOLIDS_GROUP = 5


def use(bundles: Path) -> str:
    meshes = 0
    for name in ("nine_months", "muscle", "all_senses"):
        model = mujoco.MjModel.from_xml_path(str(bundles / name / "scene.xml"))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        options = mujoco.MjvOption()
        options.flags[mujoco.mjtVisFlag.mjVIS_SKIN] = False
        options.geomgroup[SOLIDS_GROUP] = True
        with tempfile.TemporaryDirectory() as folder:
            exporter = USDExporter(model, output_directory=name, output_directory_root=folder, verbose=False)
            exporter.update_scene(data, scene_option=options)
            exporter.save_scene("usda")
            (frame,) = Path(folder).rglob("frame_*.usda")
            stage = Usd.Stage.Open(str(frame))
            written = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
        assert len(written) == int((model.geom_group <= 2).sum() + (model.geom_group == SOLIDS_GROUP).sum())
        meshes += len(written)
    return f"{meshes} meshes"
