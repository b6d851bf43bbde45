"""Cost and safety of growing: an infant at another age, and an infant that grows while it lives.

    python benchmarks/growing.py [--rounds 20] [--seeds 20] [--months 24] [--hands mitten]

First the CPU time from a spec to the loaded model of another age, beside that of a whole build and its opening, and the
time of `grow` with the next control step. Then infants flail in every pose of every seed and grow in quarter months,
and in one jump; the deepest penetration just afterwards is wanted below 0.2 mm, energy finite, without a warning.
"""

import argparse
import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from statistics import median
from typing import Any

import mujoco
import numpy as np

import mimoc
from mimoc.bundle.model import load_model, simulation_warnings
from mimoc.compiler.variants import SpecVariants

STAGE_MONTHS = 0.25
STEPS_BETWEEN = 5  # Control steps with random commands between two stages of growth.
SENSES = {"proprioception": {}, "vestibular": {}}


@dataclass
class Tally:
    """What became of infants just after they had grown."""

    depths_mm: list[float] = field(default_factory=list)
    energies_j: list[float] = field(default_factory=list)
    warnings: set[str] = field(default_factory=set)

    def add(self, infant: mimoc.InfantEnv) -> None:
        """Measure an infant that has just grown."""
        model, data = infant.model, infant.data
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_energyPos(model, data)
        mujoco.mj_energyVel(model, data)
        self.depths_mm.append(-1e3 * min([0.0, *data.contact.dist]))
        self.energies_j.append(float(data.energy.sum()))
        self.warnings.update(simulation_warnings(data))


def main() -> None:
    """Print times, then what a sweep over ages found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--months", type=float, default=24)
    parser.add_argument("--hands", choices=("mitten", "five_finger"), default="mitten")
    options = parser.parse_args()
    for name, senses in {"proprioception, balance": SENSES, "with touch": {**SENSES, "touch": {}}}.items():
        compare(name, _spec(options.hands, senses), options.rounds)
    sweep(_spec(options.hands, SENSES), options.seeds, options.months)


def _spec(hands: str, senses: dict[str, Any]) -> mimoc.InfantSpec:
    keys = {"mimoc": 1, "name": "infant", "age_months": 0, "body": {"hands": hands}, "senses": senses}
    return mimoc.InfantSpec.model_validate(keys)


def infant_of(spec: mimoc.InfantSpec) -> mimoc.InfantEnv:
    """Return the environment of a spec, without Gymnasium's wrappers."""
    variants = SpecVariants(spec)
    return mimoc.InfantEnv(variants.original, variants=variants)


def compare(name: str, spec: mimoc.InfantSpec, rounds: int) -> None:
    """Print the median CPU times of several ways to another age, taken in turn."""
    variants, env = SpecVariants(spec), infant_of(spec)
    still = np.zeros(env.model.nu, np.float32)
    env.reset(seed=0)

    def live(age_months: float) -> None:
        env.grow(to=age_months)
        env.step(still)

    ways: dict[str, Callable[[float], object]] = {
        "whole build, opened [ms]": lambda age: load_model(mimoc.build(spec.with_(age_months=age))),
        "variant: bundle and model [ms]": lambda age: variants(age, spec.scene.seed),
        "grow and the next step [ms]": live,
    }
    taken: dict[str, list[float]] = {way: [] for way in ways}
    for number in range(rounds + 1):
        for offset, (way, call) in enumerate(ways.items()):
            start = time.process_time()
            call(3 + number * 20 / rounds / 1.01 + offset / 1000)
            taken[way].append(1e3 * (time.process_time() - start))
    for way, times in taken.items():
        print(f"{name}: {way:32} median {median(times[1:]):6.1f}, least {min(times[1:]):6.1f}", flush=True)


def sweep(spec: mimoc.InfantSpec, seeds: int, months: float) -> None:
    """Print the deepest penetration after growth in quarter months and in one jump."""
    infant = infant_of(spec)
    stages = np.arange(STAGE_MONTHS, months + STAGE_MONTHS / 2, STAGE_MONTHS).tolist()
    courses = {"quarter months": stages, "one jump": [months], "one jump back": [0.0]}
    for name, ages_months in courses.items():
        tally = Tally()
        for pose, seed in itertools.product(infant.manifest.poses, range(seeds)):
            generator = np.random.default_rng(seed)
            start = months if ages_months == [0.0] else 0.0
            infant.reset(seed=seed, options={"pose": pose, "age_months": start})
            for age_months in ages_months:
                for _ in range(STEPS_BETWEEN):
                    infant.step(generator.uniform(-1, 1, infant.model.nu).astype(np.float32))
                infant.grow(to=age_months)
                tally.add(infant)
        report(name, tally)


def report(name: str, tally: Tally) -> None:
    depths_mm, energies_j = np.array(tally.depths_mm), np.array(tally.energies_j)
    print(
        f"{name:16} {len(depths_mm):6} times: deepest {depths_mm.max():.3f} mm, median {np.median(depths_mm):.3f};"
        f" energy finite: {np.isfinite(energies_j).all()}, largest {energies_j.max():.2f} J;"
        f" warnings: {', '.join(sorted(tally.warnings)) or 'none'}",
        flush=True,
    )


if __name__ == "__main__":
    main()
