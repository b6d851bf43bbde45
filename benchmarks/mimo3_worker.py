"""MIMo 3's side of `mimo3.py`: runs in MIMo 3's own Python and MuJoCo, and answers requests line by line, as JSON."""

import contextlib
import importlib
import json
import os
import sys
import time
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gymnasium
import mujoco
import numpy as np
from beside import (
    CONTROL_STEPS,
    ENVIRONMENTS,
    bare,
    check_observations,
    landed,
    random_commands,
    render_its_camera,
    without_toys,
)
from gymnasium.envs.mujoco import MujocoEnv
from measuring import felt

EPISODES: dict[str, Any] = {}


def serve() -> None:
    """Answer requests from standard input until it ends; what MIMo's code prints goes to standard error."""
    answers, sys.stdout = sys.stdout, sys.stderr
    for line in sys.stdin:
        request = json.loads(line)
        with contextlib.redirect_stdout(sys.stderr):
            answer = globals()[f"answer_{request.pop('ask')}"](**request)
        print(json.dumps(answer), file=answers, flush=True)


def answer_versions() -> dict[str, str]:
    """Return the versions of what it runs on."""
    return {"MuJoCo": mujoco.__version__, "Gymnasium": gymnasium.__version__, "NumPy": np.__version__}


def answer_open(name: str, hands: str, pose: str, senses: str, pixels: int, scene: str) -> dict[str, float]:
    """Open MIMo 3's environment in a pose of the infant in *scene*; return its size and the CPU time that it took."""
    start = time.process_time()
    env = _opened(hands, senses, pixels)
    making_s = time.process_time() - start
    env.init_qpos[:] = landed(env.model, pose, mujoco.MjModel.from_xml_path(scene))
    EPISODES[name] = partial(felt, env, random_commands(CONTROL_STEPS[senses], env.model.nu))
    env.reset(seed=0)
    check_observations(env, senses)
    numbers = gymnasium.spaces.flatdim(env.observation_space)
    return {"numbers": numbers, "contacts": env.data.ncon, "making_s": making_s}


def answer_physics(name: str, hands: str, pose: str, scene: str, own: bool) -> dict[str, int]:
    """Load a body alone on its floor: MIMo 3's own, in a pose of the infant in *scene*, or that infant."""
    posed = mujoco.MjModel.from_xml_path(scene)
    model = without_toys(_scene(hands)) if own else posed
    data, qpos = mujoco.MjData(model), landed(model, pose, posed) if own else posed.key(pose).qpos

    def reset(seed: int) -> None:
        mujoco.mj_resetData(model, data)
        data.qpos[:] = qpos
        mujoco.mj_forward(model, data)

    commands = random_commands(CONTROL_STEPS["physics"], model.nu)
    EPISODES[name] = partial(bare, SimpleNamespace(model=model, data=data, reset=reset), commands)
    EPISODES[name]()
    return {"numbers": model.nv, "contacts": data.ncon}


def answer_episode(name: str) -> float:
    """Return the CPU time of one episode, in seconds."""
    start = time.process_time()
    EPISODES[name]()
    return time.process_time() - start


def answer_grown(age_months: float, hands: str) -> dict[str, Any]:
    """Return mass and solids of MIMo 3 at an age, all joints at zero."""
    growth = importlib.import_module("mimo_infant.growth.growth")
    remove = importlib.import_module("mimo_infant.growth.scene").delete_growth_scene
    path = growth.adjust_mimo_to_age(age_months, _scene(hands))  # It writes beside the scene.
    try:
        model = mujoco.MjModel.from_xml_path(path)
    finally:
        remove(path)
    data, root = mujoco.MjData(model), model.body("mimo_location").id
    mujoco.mj_kinematics(model, data)
    own = np.flatnonzero(model.body_rootid[model.geom_bodyid] == root)
    return {
        "mass_kg": float(model.body_subtreemass[root]),
        "names": [model.geom(geom).name for geom in own],
        "types": model.geom_type[own].tolist(),
        "sizes_m": model.geom_size[own].tolist(),
        "places_m": data.geom_xpos[own].tolist(),
        "turns": data.geom_xmat[own].tolist(),
    }


def _scene(hands: str) -> str:
    scenes = importlib.import_module("mimo_infant.simulation.envs.dummy")
    return scenes.BENCHMARK_XML if hands == "mitten" else scenes.BENCHMARK_XML_V2


class _WithoutToys(MujocoEnv):
    """Stands below MIMo's environment in the order of its bases."""

    def _initialize_simulation(self) -> tuple[mujoco.MjModel, mujoco.MjData]:
        model = without_toys(self.fullpath)
        model.vis.global_.offwidth, model.vis.global_.offheight = self.width, self.height
        return model, mujoco.MjData(model)


def _opened(hands: str, senses: str, pixels: int) -> Any:
    kind = getattr(importlib.import_module("mimo_infant.simulation.envs.dummy"), ENVIRONMENTS[hands])
    adapted = type("Adapted", (kind, _WithoutToys), {"render": render_its_camera})
    eye = {"width": pixels, "height": pixels, "fovy": 60, "acuity": False, "foveation": False}
    parameters: dict[str, Any] = {"vision_params": None}
    if senses == "eyes":
        parameters["vision_params"] = {"eye_left": dict(eye), "eye_right": dict(eye)}
    if senses != "touch":
        parameters["touch_params"] = None
    return adapted(**parameters)


os.environ.setdefault("MUJOCO_GL", "egl")
os.environ["LP_NUM_THREADS"] = "0"
sys.path.insert(0, str(Path(os.environ["MIMO3"])))
