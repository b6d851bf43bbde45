"""mjlab's entity: the infants of the program in docs/compatibility.md, in a scene, moved by its simulation."""

import re
from pathlib import Path
from typing import Any

import torch
from mjlab.entity import EntityCfg
from mjlab.scene import Scene, SceneCfg
from mjlab.sim import Simulation, SimulationCfg
from mjlab.terrains import TerrainEntityCfg

PAGE = Path(__file__).parents[2] / "docs" / "compatibility.md"
STEPS = 5


def use(bundles: Path) -> str:
    (program,) = re.findall(r"^```\{code-block\} python\n(# mjlab.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL)
    names: dict[str, Any] = {}
    exec(program.replace("out/", f"{bundles}/"), names)
    return "; ".join(_moved(name, names[name]) for name in ("with_motors", "with_muscles"))


def _moved(name: str, cfg: EntityCfg) -> str:
    terrain = TerrainEntityCfg(terrain_type="plane")
    scene = Scene(SceneCfg(num_envs=2, entities={"infant": cfg}, terrain=terrain), device="cpu")
    settings = SimulationCfg(njmax=300)
    settings.mujoco.timestep = 0.005
    simulation = Simulation(num_envs=2, cfg=settings, model=scene.compile(), device="cpu")
    scene.initialize(simulation.mj_model, simulation.model, simulation.data)
    infant = scene["infant"]
    assert infant.num_actuators == simulation.mj_model.nu > 40
    commands = torch.zeros(2, infant.num_joints)
    commands[1] = 1.0
    infant.set_joint_effort_target(commands)
    for _ in range(STEPS):
        scene.write_data_to_sim()
        simulation.step()
        scene.update(settings.mujoco.timestep)
    still, moved = simulation.data.ctrl
    assert not still.any()
    assert 40 < moved.count_nonzero() <= infant.num_actuators
    assert torch.isfinite(infant.data.joint_pos).all()
    assert not torch.allclose(infant.data.joint_pos[0], infant.data.joint_pos[1], atol=1e-3)
    return f"{name}: {infant.num_actuators} actuators"
