"""Accelerations by MuJoCo's sparse Newton solver beside those of the dense one, in states that infants come by.

    python benchmarks/sparse.py [--states 6000]

Run it with each new MuJoCo 4: 4.0.0 is excluded because both differ in rare states (see `mimoc.bundle`). A state is one
that random commands lead to, or the same with random velocities; both solvers begin with the same accelerations.
"""

import argparse
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import mujoco
import numpy as np

import mimoc

CONFIGS = Path(__file__).parents[1] / "configs"
NAMES = ("newborn", "nine_months", "two_years", "five_finger", "muscle", "playroom")
WRONG = 0.01  # Difference of accelerations, by their size, from which on a solver counts as wrong.
EPISODE_STEPS = 250
VELOCITY = 3.0  # Standard deviation of random velocities, in [m/s] and [rad/s].


def differences(name: str, number: int) -> Iterator[float]:
    """Yield how much the accelerations of both solvers differ in each state, by the size of the dense ones."""
    with closing(mimoc.make(CONFIGS / f"{name}.yaml")) as env:
        model = env.unwrapped.model
        data, sparse, dense = mujoco.MjData(model), mujoco.MjData(model), mujoco.MjData(model)
    generator = np.random.default_rng(0)
    for state in range(number):
        if state % EPISODE_STEPS == 0:
            mujoco.mj_resetDataKeyframe(model, data, state // EPISODE_STEPS % model.nkey)
        data.ctrl[:] = generator.uniform(*model.actuator_ctrlrange.T)
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        mujoco.mj_step(model, data, 2)
        if state % 5 == 0:
            data.qvel[:] += generator.normal(scale=VELOCITY, size=model.nv)
        for kind, there in ((mujoco.mjtJacobian.mjJAC_SPARSE, sparse), (mujoco.mjtJacobian.mjJAC_DENSE, dense)):
            mujoco.mj_copyState(model, data, there, mujoco.mjtState.mjSTATE_INTEGRATION)
            model.opt.jacobian = kind
            mujoco.mj_forward(model, there)
        yield float(np.linalg.norm(sparse.qacc - dense.qacc) / np.linalg.norm(dense.qacc))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--states", type=int, default=6000, help="in all")
    number = parser.parse_args().states // len(NAMES)
    print(f"MuJoCo {mujoco.__version__}, {number} states of each infant\n")
    print("| infant | median difference | largest | off by more than 1 % |\n|---|---|---|---|")
    for name in NAMES:
        found = np.array([*differences(name, number)])
        print(f"| {name} | {np.median(found):.1e} | {found.max():.1e} | {(found > WRONG).sum()} |", flush=True)


if __name__ == "__main__":
    main()
