"""Speed of mimoc compared with MIMo's own code, in one process and the same MuJoCo.

    python benchmarks/beside_mimo.py PATH_TO_MIMO [--hands mitten] [--pose sitting] [--pixels 64] [--rounds 7]

PATH_TO_MIMO is the folder with `mimoEnv` in a copy of https://github.com/babybench/BabyBench2025_Starter_Kit; its code
also needs cachetools, CacheToolsUtils, imageio, matplotlib, networkx, opencv-python-headless and rtree. Both infants
are 18 months old, as MIMo is, with torque motors, alone on a floor in the same posture, and get random commands for
control steps of two physics steps of 5 ms. Physics is `mujoco.mj_step` alone; an environment observes proprioception
and the vestibular sense, then touch on the whole body or both eyes as well, as each does by default (but without
acuity, which MIMo lacks). Neither has wrappers. All alternate, and the median CPU time of an episode with its reset
counts; Mesa draws in one thread.
"""

import argparse
import importlib
import io
import os
import sys
from contextlib import ExitStack, redirect_stdout
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

os.environ.setdefault("MUJOCO_GL", "egl")
os.environ["LP_NUM_THREADS"] = "0"

import gymnasium
import mujoco
import numpy as np
from beside import (
    CONTROL_STEPS,
    ENVIRONMENTS,
    STEP_S,
    bare,
    check_observations,
    landed,
    random_commands,
    render_its_camera,
    without_toys,
)
from measuring import cpu_medians_s, felt

import mimoc
from mimoc.bundle.model import load_model


def main() -> None:
    """Print one row for physics and one for each combination of senses."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mimo", type=Path, help="folder with mimoEnv")
    parser.add_argument("--hands", choices=tuple(ENVIRONMENTS), default="mitten")
    parser.add_argument("--pose", choices=("sitting", "supine"), default="sitting")
    parser.add_argument("--pixels", type=int, default=64, help="width and height of an image")
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    if not (options.mimo / "mimoEnv" / "envs" / "dummy.py").is_file():
        parser.error(f"{options.mimo} does not contain MIMo's code (mimoEnv/envs/dummy.py)")
    code = import_mimo(options.mimo)
    print(f"MuJoCo {mujoco.__version__}, Gymnasium {gymnasium.__version__}, NumPy {np.__version__}")
    print(f"{'':28}{'numbers':>16}{'contacts':>16}{'CPU ms/simulated s':>22}")
    print(f"{'hands':13}{'senses':15}" + f"{'MIMo':>8}{'mimoc':>8}" * 2 + f"{'MIMo':>11}{'mimoc':>11}{'ratio':>8}")
    with ExitStack() as opened:
        compare(opened, code, options.hands, options.pose, options.pixels, options.rounds)


def compare(opened: ExitStack, code: ModuleType, hands: str, pose: str, pixels: int, rounds: int) -> None:
    """Measure both infants with all senses in turn, and print a row for each sense."""
    envs, episodes = {}, {}
    for senses, steps in CONTROL_STEPS.items():
        mine = open_mimoc(hands, pose, senses, pixels)
        for name, env in (("MIMo", open_mimo(code, hands, pose, senses, pixels)), ("mimoc", mine)):
            commands = random_commands(steps, env.model.nu)
            opened.callback(env.close)  # At the end, as an OpenGL context ends others with it.
            envs[senses, name] = env
            episodes[f"{senses} {name}"] = partial(bare if senses == "physics" else felt, env, commands)
    medians_s = cpu_medians_s(episodes, rounds)
    for senses, steps in CONTROL_STEPS.items():
        pair = [envs[senses, name] for name in ("MIMo", "mimoc")]
        for env in pair:
            check_observations(env, senses)
        numbers = "".join(f"{gymnasium.spaces.flatdim(env.observation_space):8}" for env in pair)
        contacts = "".join(f"{env.data.ncon:8}" for env in pair)
        theirs_ms, ours_ms = (1e3 * medians_s[f"{senses} {name}"] / (steps * STEP_S) for name in ("MIMo", "mimoc"))
        times = f"{theirs_ms:11.1f}{ours_ms:11.1f}{theirs_ms / ours_ms:8.2f}"
        print(f"{hands:13}{senses:15}{numbers}{contacts}{times}", flush=True)


def import_mimo(folder: Path) -> ModuleType:
    """Return MIMo's module of environments without a task.

    Its tables of joints' sizes have MuJoCo's types as keys, which are no longer those that a model has.
    """
    sys.path.insert(0, str(folder))
    utils = importlib.import_module("mimoEnv.utils")
    for name in ("MUJOCO_JOINT_SIZES", "MUJOCO_DOF_SIZES"):
        setattr(utils, name, {int(kind): size for kind, size in getattr(utils, name).items()})
    return importlib.import_module("mimoEnv.envs.dummy")


def open_mimo(code: ModuleType, hands: str, pose: str, senses: str, pixels: int) -> Any:
    """Return MIMo's environment, adapted to Gymnasium 1, whose episodes begin in mimoc's pose."""

    class Adapted(getattr(code, ENVIRONMENTS[hands])):
        render = render_its_camera

        def _initialize_simulation(self):
            self.model = without_toys(self.fullpath)
            self.data = mujoco.MjData(self.model)
            super()._initialize_simulation()
            return self.model, self.data

    size = {"width": pixels, "height": pixels}
    parameters: dict[str, dict | None] = {
        "vision_params": {"eye_left": size, "eye_right": size} if senses == "eyes" else None
    }
    if senses != "touch":
        parameters["touch_params"] = None
    with redirect_stdout(io.StringIO()):  # It prints the number of points of the skin.
        env = Adapted(**parameters)
    env.init_qpos[:] = landed(env.model, pose, load_model(mimoc.build(infant(hands, pose, {}))))
    return env


def open_mimoc(hands: str, pose: str, senses: str, pixels: int) -> Any:
    """Return mimoc's environment."""
    return mimoc.make(mimoc.build(infant(hands, pose, senses_of(senses, pixels)))).unwrapped


def senses_of(senses: str, pixels: int) -> dict:
    """Return the senses of a spec, by the name of what is measured."""
    wanted = {"proprioception": {}, "vestibular": {}}
    if senses == "touch":
        wanted["touch"] = {}
    if senses == "eyes":
        wanted["vision"] = {"width_px": pixels, "height_px": pixels, "acuity": "off"}
    return wanted


def infant(hands: str, pose: str, senses: dict, *, chest_joint: bool = False) -> mimoc.InfantSpec:
    """Return the spec of an infant on a floor."""
    body = {"hands": hands, "chest_joint": chest_joint}
    spec = {"mimoc": 1, "name": "infant", "age_months": 18, "body": body}
    return mimoc.InfantSpec.model_validate(spec | {"senses": senses, "scene": {"kind": "flat", "pose": pose}})


if __name__ == "__main__":
    main()
