"""Cost of a control step: two physics steps of 5 ms with observations, compared with a bare loop.

    python benchmarks/step.py [--rounds 100]
    python benchmarks/step.py --scenes BUNDLE/scene.xml ... [--pose supine]

Both go through the same states: the same reset, and the same random command for each control step. The bare loop
writes the command and calls `mujoco.mj_step` twice. The infants are those of `configs/`; the environment is the one
that `gymnasium.make` returns, with Gymnasium's own wrappers. Infants whose commands are late are left out. Wanted: at
most 1.3 times.

With `--scenes`, compares single physics steps of bundles, such as those of two releases: of an infant that has lain for
three seconds, without commands, and of one that gets random commands every two steps, with their mean numbers of
constraint rows.
"""

import argparse
import copy
from functools import partial
from pathlib import Path

import gymnasium
import mujoco
import numpy as np
from measuring import cpu_medians_s, felt

import mimoc

CONFIGS = sorted((Path(__file__).parents[1] / "configs").glob("*.yaml"))
CONTROL_STEPS = 50
SETTLED_S = 3.0


def main() -> None:
    """Print what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=100)
    parser.add_argument("--scenes", nargs="*", default=())
    parser.add_argument("--pose", default="supine")
    options = parser.parse_args()
    if options.scenes:
        compare_physics(options.scenes, options.pose, options.rounds)
    else:
        compare_with_bare(options.rounds)


def compare_with_bare(rounds: int) -> None:
    """Print one row for each infant."""
    print(f"{'infant':17} {'numbers':>8} {'mimoc [us]':>11} {'bare [us]':>10} {'ratio':>6}")
    for config in CONFIGS:
        bundle = mimoc.build(mimoc.load_spec(config))
        if bundle.manifest.delays.motor.ms or bundle.manifest.task.kind != "free":
            continue  # Commands come later than those of the bare loop; or there is more to do than physics.
        env = mimoc.make(bundle)
        shape = (CONTROL_STEPS, *env.action_space.shape)
        commands = np.random.default_rng(0).uniform(-1, 1, shape).astype(np.float32)
        model = env.unwrapped.model
        data = mujoco.MjData(model)
        start, driven = model.key(env.unwrapped.manifest.pose).id, env.unwrapped.actuation.actuators
        candidates = {
            "mimoc": partial(felt, env, commands),
            "bare": partial(bare, model, data, start, driven, commands),
        }
        step_us = {name: 1e6 * s / CONTROL_STEPS for name, s in cpu_medians_s(candidates, rounds).items()}
        if not np.array_equal(env.unwrapped.data.qpos, data.qpos):
            raise SystemExit("the two did not go through the same states")
        numbers = gymnasium.spaces.flatdim(env.observation_space)
        ratio = step_us["mimoc"] / step_us["bare"]
        print(f"{config.stem:17} {numbers:8} {step_us['mimoc']:11.1f} {step_us['bare']:10.1f} {ratio:6.2f}", flush=True)


def bare(model: mujoco.MjModel, data: mujoco.MjData, start: int, driven: np.ndarray, commands: np.ndarray) -> None:
    """Run the same episode with nothing but MuJoCo."""
    mujoco.mj_resetDataKeyframe(model, data, start)
    mujoco.mj_forward(model, data)
    for command in commands:
        data.ctrl[driven] = command
        mujoco.mj_step(model, data)
        mujoco.mj_step(model, data)


def compare_physics(scenes: list[str], pose: str, rounds: int) -> None:
    """Print what a physics step of each scene takes, measured alternately."""
    candidates, rows = dict[str, partial[float]](), dict[str, float]()
    for scene in scenes:
        model = mujoco.MjModel.from_xml_path(scene)
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
        mujoco.mj_step(model, data, round(SETTLED_S / model.opt.timestep))
        shape = (CONTROL_STEPS, model.nu)
        for kind, commands in {
            "rest": np.tile(data.ctrl, (CONTROL_STEPS, 1)),
            "random": np.random.default_rng(0).uniform(*model.actuator_ctrlrange.T, shape),
        }.items():
            candidates[f"{scene} {kind:6}"] = partial(steps, model, data, commands)
            rows[f"{scene} {kind:6}"] = steps(model, data, commands)
    for name, seconds in cpu_medians_s(candidates, rounds).items():
        print(f"{name} {1e6 * seconds / CONTROL_STEPS / 2:6.1f} us, {rows[name]:5.1f} rows")


def steps(model: mujoco.MjModel, start: mujoco.MjData, commands: np.ndarray) -> float:
    """Make two physics steps with each command, and return the mean number of constraint rows."""
    data, rows = copy.copy(start), 0
    for command in commands:
        data.ctrl[:] = command
        mujoco.mj_step(model, data, 2)
        rows += data.nefc
    return rows / len(commands)


if __name__ == "__main__":
    main()
