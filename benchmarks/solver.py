"""Comparison of solver settings: speed, convergence and warnings over many steps with random commands.

    python benchmarks/solver.py [--steps 100000] [--hands five_finger] [--actuation muscle]

Every step's residual is taken: |M a - f_smooth - f_constraint|, the gradient of the problem that the solver
minimises, relative to the forces in it. A step counts as converged below 1e-6. Commands are drawn anew for
every control step (two physics steps of 5 ms) from each pose, at ages 0 to 24; an episode lasts two seconds.
"""

import argparse
import itertools
import time
from dataclasses import dataclass, field

import mujoco
import numpy as np

import mimoc
from mimoc.bundle.model import load_model, simulation_warnings

BODIES = ("mitten", "five_finger")  # The second with the joints of the chest: all that there is.
AGES_MONTHS = (0, 1, 3, 6, 9, 12, 18, 24)
CONVERGED = 1e-6
EPISODE_STEPS = 400
CANDIDATES = {
    "as emitted": {},
    "dense Jacobian": {"jacobian": mujoco.mjtJacobian.mjJAC_DENSE},
    "pyramidal cones": {"cone": mujoco.mjtCone.mjCONE_PYRAMIDAL},
    "implicitfast": {"integrator": mujoco.mjtIntegrator.mjINT_IMPLICITFAST},
    "20 iterations": {"iterations": 20},
    "CG": {"solver": mujoco.mjtSolver.mjSOL_CG},
    "tolerance 1e-8": {"tolerance": 1e-8},
}


@dataclass
class Tally:
    """The results of one candidate."""

    residuals: list[float] = field(default_factory=list)
    iterations: list[int] = field(default_factory=list)
    warnings: set[str] = field(default_factory=set)
    cpu_s: float = 0.0


def main() -> None:
    """Print one row for each candidate of each body."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=100_000, help="physics steps of the settings as emitted")
    parser.add_argument("--others", type=int, default=10_000, help="physics steps of every other candidate")
    parser.add_argument("--hands", choices=BODIES, nargs="*", default=BODIES)
    parser.add_argument("--actuation", choices=("torque", "muscle"), default="torque")
    options = parser.parse_args()
    print(f"MuJoCo {mujoco.__version__}, {options.actuation}")
    heads = ("steps", "steps/s", "median", "worst", "failed", "most it.")
    for hands in options.hands:
        print(f"{hands:18}", *(f"{head:>8}" for head in heads), " warnings")
        models = [load_model(mimoc.build(_spec(age, hands, options.actuation))) for age in AGES_MONTHS]
        for name, settings in CANDIDATES.items():
            _print(name, run(models, settings, options.steps if name == "as emitted" else options.others))


def _spec(age_months: float, hands: str, actuation: str) -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate(
        {
            "mimoc": 1,
            "name": "infant",
            "age_months": age_months,
            "body": {"hands": hands, "chest_joint": hands == "five_finger"},
            "actuation": {"model": actuation},
        }
    )


def _print(name: str, tally: Tally) -> None:
    residuals = np.array(tally.residuals)
    print(
        f"{name:18} {len(residuals):8} {len(residuals) / tally.cpu_s:8.0f} {np.median(residuals):8.1e} "
        f"{residuals.max():8.1e} {(residuals > CONVERGED).sum():8} {max(tally.iterations):8}  "
        f"{', '.join(sorted(tally.warnings)) or 'none'}",
        flush=True,
    )


def run(models: list[mujoco.MjModel], settings: dict[str, float], steps: int) -> Tally:
    """Return the tally of some settings over at least *steps* physics steps, spread over ages and poses."""
    tally, generator = Tally(), np.random.default_rng(0)
    starts = itertools.cycle(itertools.product(models, range(4)))
    while len(tally.residuals) < steps:
        model, key = next(starts)
        kept = {option: getattr(model.opt, option) for option in settings}
        for option, value in settings.items():
            setattr(model.opt, option, value)
        episode(model, key, generator, tally)
        for option, value in kept.items():
            setattr(model.opt, option, value)
    return tally


def episode(model: mujoco.MjModel, key: int, generator: np.random.Generator, tally: Tally) -> None:
    """Add two seconds of random control to *tally*."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, key)
    inertia = np.zeros(model.nv)
    for step in range(EPISODE_STEPS):
        if step % 2 == 0:
            data.ctrl[:] = generator.uniform(*model.actuator_ctrlrange.T)
        start = time.process_time()
        mujoco.mj_step(model, data)
        tally.cpu_s += time.process_time() - start
        mujoco.mj_mulM(model, data, inertia, data.qacc)
        gap = inertia - data.qfrc_smooth - data.qfrc_constraint
        scale = np.abs(inertia).max() + np.abs(data.qfrc_smooth).max() + np.abs(data.qfrc_constraint).max()
        tally.residuals.append(float(np.abs(gap).max() / scale))
        tally.iterations.append(int(data.solver_niter.max()))
    tally.warnings.update(simulation_warnings(data))


if __name__ == "__main__":
    main()
