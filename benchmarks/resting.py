"""Physics that rests: sleeping objects and leaving islands out, by kind of scene.

    python benchmarks/resting.py [--rounds 15]

Each control step is two physics steps of 5 ms with the same random commands, from the same pose, in models that differ
in MuJoCo's flags only; times are CPU times taken in turn. Beside them: by how much the infant moves otherwise than
without the flag; whether a run repeats to the bit; and whether a saved and restored state goes on to the bit.
"""

import argparse
from functools import partial
from typing import Any

import mujoco
import numpy as np
from measuring import cpu_medians_s

import mimoc
from mimoc.bundle.model import load_model

CONTROL_STEPS = 100
SETTLING_STEPS = 400  # Physics steps after which toys lie still.
SCENES = {
    "lone infant": {"kind": "flat"},
    "room": {"kind": "room"},
    "room, six toys": {"kind": "room", "toys": {"count": [6, 6]}},
    "crib": {"kind": "crib"},
    "crib, six toys": {"kind": "crib", "toys": {"count": [6, 6]}},
}
SLEEP, ISLAND = int(mujoco.mjtEnableBit.mjENBL_SLEEP), int(mujoco.mjtDisableBit.mjDSBL_ISLAND)
FLAGS = {"as emitted": (0, 0), "sleep": (SLEEP, 0), "no islands": (0, ISLAND)}
"""Flags that are switched on and switched off."""
STATE = mujoco.mjtState.mjSTATE_INTEGRATION


def main() -> None:
    """Print a row for each kind of scene."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    rounds = parser.parse_args().rounds
    for name, scene in SCENES.items():
        for pose in ("supine", "sitting"):
            compare(name, {**scene, "pose": pose}, rounds)


def compare(name: str, scene: dict[str, Any], rounds: int) -> None:
    """Print how long a step takes with each choice of flags, and whether it is exact."""
    keys = {"mimoc": 1, "name": "infant", "age_months": 9, "scene": scene}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(keys))
    models = {choice: load_model(bundle) for choice in FLAGS}
    for choice, (enabled, disabled) in FLAGS.items():
        models[choice].opt.enableflags |= enabled
        models[choice].opt.disableflags |= disabled
    commands = np.random.default_rng(0).uniform(-1, 1, (CONTROL_STEPS, models["as emitted"].nu))
    runs = {choice: partial(run, model, scene["pose"], commands) for choice, model in models.items()}
    step_us = {choice: 1e6 * s / CONTROL_STEPS for choice, s in cpu_medians_s(runs, rounds).items()}
    emitted = runs["as emitted"]()
    for choice in FLAGS:
        found = runs[choice]()
        moved = np.abs(found - emitted).max()
        repeated = np.array_equal(found, runs[choice]())
        restored = goes_on(models[choice], scene["pose"], commands)
        print(
            f"{name:15} {scene['pose']:8} {choice:11} {step_us[choice]:6.0f} us"
            f" ({step_us[choice] / step_us['as emitted']:.2f}); infant differs by {moved:.1e};"
            f" repeated to the bit: {repeated}; restored to the bit: {restored}",
            flush=True,
        )


def settled(model: mujoco.MjModel, pose: str) -> mujoco.MjData:
    """Return a state in which the infant and its toys have come to rest."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_step(model, data, SETTLING_STEPS)
    return data


def run(model: mujoco.MjModel, pose: str, commands: np.ndarray) -> np.ndarray:
    """Return the angles and the place of the infant after some control steps, from the pose."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    for command in commands:
        data.ctrl[:] = command
        mujoco.mj_step(model, data, 2)
    return data.qpos[: 7 + model.nu].copy()


def goes_on(model: mujoco.MjModel, pose: str, commands: np.ndarray) -> bool:
    """Return whether a state that is saved and restored goes on to the bit."""
    data, state = settled(model, pose), np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, state, STATE)
    other = mujoco.MjData(model)
    mujoco.mj_setState(model, other, state, STATE)
    mujoco.mj_forward(model, other)
    mujoco.mj_setState(model, other, state, STATE)
    for command in commands:
        for each in (data, other):
            each.ctrl[:] = command
            mujoco.mj_step(model, each, 2)
    return np.array_equal(data.qpos, other.qpos)


if __name__ == "__main__":
    main()
