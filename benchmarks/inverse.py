"""Cost of a call of inverse dynamics by actuation model and hands. Target: 1 ms with mittens.

    python benchmarks/inverse.py [--rounds 40]

An infant of 18 months that lies on its back reaches with both hands and looks with both eyes, and its posture is held.
Each round takes it through the same control steps; the median CPU time counts, of a call and of the physics beside it.
BLAS has one thread, with which matrices of this size do best.
"""

import argparse
import os
from collections.abc import Callable
from functools import partial

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from measuring import cpu_medians_s

import mimoc

CONTROL_STEPS = 50
SENSES = {"proprioception": {}, "vestibular": {}}
EYES = ("eye_left", "eye_right")


def main() -> None:
    """Print one row for each body and actuation model."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=40)
    rounds = parser.parse_args().rounds
    print(f"{'hands':12} {'model':7} {'joints':>6} {'control [us]':>13} {'step [us]':>10}")
    for hands in ("mitten", "five_finger"):
        for model in ("torque", "muscle"):
            env = infant(hands, model)
            control = controller(env)
            candidates = {"both": partial(run, env, control), "step": partial(run, env, partial(rest, env))}
            step_us = {name: 1e6 * s / CONTROL_STEPS for name, s in cpu_medians_s(candidates, rounds).items()}
            alone_us = step_us["both"] - step_us["step"]
            print(f"{hands:12} {model:7} {len(control.joints):6} {alone_us:13.0f} {step_us['step']:10.0f}", flush=True)


def infant(hands: str, model: str) -> mimoc.InfantEnv:
    spec = {
        "mimoc": 1,
        "name": "infant",
        "age_months": 18,
        "body": {"hands": hands},
        "actuation": {"model": model},
        "senses": SENSES,
        "scene": {"kind": "flat", "pose": "supine"},
    }
    return mimoc.InfantEnv(mimoc.build(mimoc.InfantSpec.model_validate(spec)))


def controller(env: mimoc.InfantEnv) -> mimoc.InverseDynamics:
    hands = [mimoc.PositionTask(name, env.data.body(name).xipos + 0.03) for name in ("right_hand", "left_hand")]
    return mimoc.InverseDynamics(
        env.model, env.data, env.manifest, [hands, [mimoc.GazeTask(eye, hands[0].target) for eye in EYES]]
    )


def rest(env: mimoc.InfantEnv) -> np.ndarray:
    return np.clip(0.0, env.action_space.low, env.action_space.high)


def run(env: mimoc.InfantEnv, act: Callable[[], np.ndarray]) -> None:
    """Go through some control steps from the start."""
    env.reset(seed=0)
    for _ in range(CONTROL_STEPS):
        env.step(act())


if __name__ == "__main__":
    main()
