"""Stability of random infants under extreme commands: warnings and violations of joint limits.

    python benchmarks/flailing.py [--infants 300]

Draws infants of any age and of both laws of development: each with mittens or five fingers, torques, muscles or servos;
average ones and individuals between WHO's percentiles 1 and 99; some with parts scaled within what the language allows
(half of the factors at the ends of their range), some with muscle groups up to ten times as strong. Each goes through a
second of random and a second of alternating commands, as `mimoc check` gives them. Wanted: no NaN, no warning of
MuJoCo; joints at most 15 degrees beyond a limit at the median over infants, and never more than 60; a kinetic energy of
never more than 20 J/kg.
"""

import argparse
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from operator import attrgetter
from typing import Any

import mujoco
import numpy as np

import mimoc
from mimoc.base.errors import SpecError
from mimoc.bundle.model import load_model
from mimoc.runtime.check import COMMANDS, Flailing, flail
from mimoc.schema.names import limb_bodies, trunk_bodies

STEP_S = 0.01
MODELS, HANDS = ("torque", "muscle", "position"), ("mitten", "five_finger")
MEASURES = ("length_percentile", "weight_percentile", "head_percentile")
GROUPS = ("arms", "hands", "legs", "trunk", "neck", "eyes")
POSES = ("supine", "prone", "sitting", "standing")
LAWS = ("maturing", "published")


def draw(generator: np.random.Generator, number: int) -> dict[str, Any]:
    """Return a spec: every stratum of models, hands and what is unusual comes once in 48 numbers."""
    model, hands, unusual = MODELS[number % 3], HANDS[number // 3 % 2], number // 6 % 8
    body: dict[str, Any] = {"hands": hands, "chest_joint": bool(generator.random() < 0.5)}
    strength = {}
    if unusual & 1:
        percentiles = {key: float(generator.choice([1, 99, generator.uniform(1, 99)])) for key in MEASURES}
        body["individual"] = {"sex": str(generator.choice(["male", "female"])), **percentiles}
    if unusual & 2:
        names = generator.choice([*trunk_bodies(), *limb_bodies(hands)], generator.integers(1, 5), replace=False)
        body["parts"] = {str(name): {key: _factor(generator) for key in ("length", "girth")} for name in names}
    if unusual & 4:
        groups = generator.choice(GROUPS, 2, replace=False)
        strength = {str(group): float(10 ** generator.uniform(-0.5, 1)) for group in groups}
    return {
        "mimoc": 1,
        "name": "drawn",
        "age_months": float(generator.choice([0, 24, *generator.uniform(0, 24, 4)])),
        "body": body,
        "actuation": {"model": model, "strength": strength},
        "scene": {"kind": "flat", "pose": str(generator.choice(POSES))},
        "development": str(generator.choice(LAWS)),
    }


def _factor(generator: np.random.Generator) -> float:
    return float(generator.choice([0.5, 2.0, *(2 ** generator.uniform(-1, 1, 2))]))


def infants(generator: np.random.Generator, first: int = 0) -> Iterator[tuple[dict[str, Any], mimoc.Bundle]]:
    """Yield infants without end, and what they were drawn as: of each number the first draw that makes a child."""
    number = first
    while True:
        drawn = draw(generator, number)
        try:
            yield drawn, mimoc.build(mimoc.InfantSpec.model_validate(drawn))
        except SpecError:
            continue
        number += 1


def flailed(drawn: dict[str, Any], bundle: mimoc.Bundle, generator: np.random.Generator) -> list[Flailing]:
    """Return what each kind of commands does to an infant in the pose it starts in."""
    model, found = load_model(bundle), []
    for commands in COMMANDS.values():
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(drawn["scene"]["pose"]).id)
        found.append(flail(data, commands(model, generator, STEP_S), STEP_S, bundle.manifest.root_body))
    return found


@dataclass(frozen=True, slots=True)
class Worst:
    """The worst of an infant's trials."""

    drawn: dict[str, Any]
    beyond_deg: float
    energy_j_per_kg: float
    warned: bool


def worst_of(drawn: dict[str, Any], found: list[Flailing]) -> Worst:
    """Return the worst of an infant's trials."""
    beyond_deg, energy = (max(getattr(each, name) for each in found) for name in ("beyond_deg", "energy_j_per_kg"))
    return Worst(drawn, beyond_deg, energy, any(each.warnings for each in found))


def main() -> None:
    """Print a row for each kind of infant, and the infants whose joints go furthest and whose limbs move fastest."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--infants", type=int, default=300)
    generator = np.random.default_rng(0)
    worst: defaultdict[str, list[Worst]] = defaultdict(list)
    for drawn, bundle in islice(infants(generator), parser.parse_args().infants):
        found = worst_of(drawn, flailed(drawn, bundle, generator))
        for kind in (f"{drawn['actuation']['model']}, {drawn['body']['hands']}", drawn["development"], "all"):
            worst[kind].append(found)
    columns = ("number", "median [deg]", "largest [deg]", "largest [J/kg]")
    print(f"{'infants':24} {' '.join(f'{column:>14}' for column in columns)}")
    for kind, values in worst.items():
        beyond_deg, energy = ([getattr(each, name) for each in values] for name in ("beyond_deg", "energy_j_per_kg"))
        print(f"{kind:24} {len(values):14} {np.median(beyond_deg):14.1f} {max(beyond_deg):14.1f} {max(energy):14.1f}")
    print(f"with warnings of MuJoCo: {sum(each.warned for each in worst['all'])}")
    for name in ("beyond_deg", "energy_j_per_kg"):
        print(f"largest {name}: {max(worst['all'], key=attrgetter(name)).drawn}")


if __name__ == "__main__":
    main()
