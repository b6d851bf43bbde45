"""Whether infants grow safely: every kind of infant, in every pose, from every seed, in quarter months and in one jump.

    python benchmarks/growing_sweep.py [--seeds 20] [--months 24] [--infants 'mitten*crib*' ...]

Infants flail with random commands and grow: from birth to the last age in quarter months, in one jump, and in one jump
back. Wanted just after each growth: no contact of the infant deeper than 0.2 mm, none of anything else that growth made
deeper than that; while they flail on: finite energy, and no warning of MuJoCo. Infants that fail are listed with what
repeats them, and the exit code is 1. The whole sweep needs some hours of one core; `--seeds 1` a quarter of an hour.
"""

import argparse
import fnmatch
import itertools
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np

import mimoc
from mimoc.bundle.model import simulation_warnings
from mimoc.cli.console import progress
from mimoc.compiler.variants import SpecVariants

STAGE_MONTHS = 0.25
STEPS_BETWEEN = 5  # Control steps with random commands before each growth.
STEPS_AFTER = 20  # Control steps after the last growth.
DEEPEST_M = 2e-4  # Wanted just after growth.
FAILURES_SHOWN = 5  # Most failures that are listed for each infant.
HANDS = ("mitten", "five_finger")
DEVELOPMENT = ("maturing", "published")
ACTUATION = ("torque", "muscle", "position")
SCENES: dict[str, dict[str, Any]] = {
    "flat": {},
    "crib": {"kind": "crib", "toys": {"count": [3, 3]}},
    "room": {"kind": "room", "toys": {"count": [4, 4]}},
}


@dataclass
class Tally:
    """What became of the infants of one kind."""

    depths_m: list[float] = field(default_factory=list)  # Deepest penetration of each just after it has grown.
    largest_j: float = -np.inf
    failures: list[str] = field(default_factory=list)

    def add(self, other: "Tally") -> None:
        """Add what became of others."""
        self.depths_m += other.depths_m
        self.largest_j = max(self.largest_j, other.largest_j)
        self.failures += other.failures


def main() -> None:
    """Sweep over all infants that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--months", type=float, default=24)
    parser.add_argument("--infants", nargs="*", default=["*"], help="names of infants, such as 'five_finger*crib'")
    options = parser.parse_args()
    total, start_s = Tally(), time.process_time()
    for name, spec in infants(options.infants):
        found = swept(name, spec, options.seeds, options.months)
        report(name, found)
        total.add(found)
    report(f"all, {(time.process_time() - start_s) / 60:.1f} min of CPU time", total)
    sys.exit(1 if total.failures else 0)


def infants(patterns: Sequence[str]) -> Iterator[tuple[str, mimoc.InfantSpec]]:
    """Yield each kind of infant whose name matches a pattern, with its spec."""
    for hands, development, actuation, scene in itertools.product(HANDS, DEVELOPMENT, ACTUATION, SCENES):
        name = f"{hands} {development} {actuation} {scene}"
        if any(fnmatch.fnmatch(name, pattern) for pattern in patterns):
            keys = {"mimoc": 1, "name": "infant", "age_months": 0, "development": development, "scene": SCENES[scene]}
            keys |= {"body": {"hands": hands}, "actuation": {"model": actuation}, "senses": {"vestibular": {}}}
            yield name, mimoc.InfantSpec.model_validate(keys)


def swept(name: str, spec: mimoc.InfantSpec, seeds: int, months: float) -> Tally:
    """Return what became of the infants of a spec in all poses, from all seeds, by all courses."""
    stages = np.arange(0.0, months + STAGE_MONTHS / 2, STAGE_MONTHS).tolist()
    courses = {"quarter months": stages, "one jump": [0.0, months], "one jump back": [months, 0.0]}
    variants, tally = SpecVariants(spec), Tally()
    grown, total = 0, seeds * sum(len(ages) - 1 for ages in courses.values())
    with progress(name) as show:
        for (course, ages_months), seed in itertools.product(courses.items(), range(seeds)):
            lives = [Life(variants, pose, seed, ages_months[0]) for pose in variants.original.manifest.poses]
            for age_months in ages_months[1:]:  # All poses at each age, whose variant is then built once.
                for life in lives:
                    life.grow(age_months, f"{name}, {course}, {life.pose}, seed {seed}", tally)
                show(grown := grown + 1, total)
            for life in lives:
                life.end(f"{name}, {course}, {life.pose}, seed {seed}", tally)
    return tally


class Life:
    """An infant that flails and grows."""

    def __init__(self, variants: SpecVariants, pose: str, seed: int, age_months: float):
        self.pose, self._generator = pose, np.random.default_rng(seed)
        self.infant = mimoc.InfantEnv(variants(age_months, 0), variants=variants)
        self.infant.reset(seed=seed, options={"pose": pose})

    def grow(self, age_months: float, told: str, tally: Tally) -> None:
        """Flail, grow, and count what came of it."""
        self._flail(STEPS_BETWEEN, told, tally)
        before_m = max(DEEPEST_M, depths_m(self.infant)[1])
        self.infant.grow(to=age_months)
        own_m, others_m = depths_m(self.infant)
        tally.depths_m.append(own_m)
        if own_m >= DEEPEST_M or others_m > before_m + 1e-5:
            tally.failures.append(
                f"{told}, {age_months:g} months: {1e3 * own_m:.2f} mm, others {1e3 * others_m:.2f} mm"
            )

    def end(self, told: str, tally: Tally) -> None:
        """Flail for a last time."""
        with closing(self.infant):
            self._flail(STEPS_AFTER, told, tally)

    def _flail(self, steps: int, told: str, tally: Tally) -> None:
        infant = self.infant
        for _ in range(steps):
            infant.step(self._generator.uniform(-1, 1, infant.model.nu).astype(np.float32))
        mujoco.mj_energyPos(infant.model, infant.data)
        mujoco.mj_energyVel(infant.model, infant.data)
        energy_j = float(infant.data.energy.sum())
        tally.largest_j = max(tally.largest_j, energy_j)
        found = [*simulation_warnings(infant.data), *(["energy is not finite"] if not np.isfinite(energy_j) else [])]
        if found:
            tally.failures.append(f"{told}, at {infant.age_months:g} months: {', '.join(found)}")


def depths_m(infant: mimoc.InfantEnv) -> tuple[float, float]:
    """Return the deepest penetration of the infant into itself or anything else, and that of all other things."""
    model, data = infant.model, infant.data
    mujoco.mj_fwdPosition(model, data)
    own = model.body_rootid[model.geom_bodyid] == model.body(infant.manifest.root_body).id
    touched = own[data.contact.geom].any(axis=1)
    depths = -data.contact.dist
    return max([0.0, *depths[touched]]), max([0.0, *depths[~touched]])


def report(name: str, tally: Tally) -> None:
    depths_mm = 1e3 * np.array(tally.depths_m)
    print(
        f"{name:40} grew {len(depths_mm):6} times: deepest {depths_mm.max():.3f} mm, median {np.median(depths_mm):.3f};"
        f" most energy {tally.largest_j:.1f} J; {len(tally.failures)} failures",
        flush=True,
    )
    for failure in tally.failures[:FAILURES_SHOWN]:
        print(f"    {failure}", flush=True)


if __name__ == "__main__":
    main()
