"""How much of the order of milestones comes from the strength curves: the ages of milestones with other curves.

    python benchmarks/strength_ablation.py [--variants 'as it is' 'arms <-> legs'] [--processes 2] [--spec SPEC]

Each variant replaces `mimoc.body.strength.STRENGTH` in processes of its own, and every milestone with ages in
`windows.csv` (but for rolling) is searched for, in half months from 0 to 24. Prints a table in Markdown: the youngest
age from which on each is reached, how many are in their windows and how many at birth, and Spearman's correlation of
these ages with the usual ones of real infants, or the middle of their range. A milestone not reached at 24 months
counts as the last.
"""

import argparse
import os
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from scipy.stats import rankdata

import mimoc
from mimoc.body import strength
from mimoc.body.strength import ARMS, AXIAL, LEGS, STRENGTH, StrengthCurve
from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones import WINDOWS
from mimoc.studies.milestones.search import AGES, SearchResult, search_trials
from mimoc.studies.milestones.trial import Conditions

TRUNK_GROUPS, LEG_GROUPS, ARM_GROUPS = ("neck", "trunk"), ("hip", "knee", "ankle"), ("arm",)
USUAL = {
    name: window.usual_months or sum(window.window(of_average=True)) / 2
    for name, window in WINDOWS.items()
    if name != "roll_over"
}
TRIALS = sorted(USUAL, key=lambda name: USUAL[name])
LAST_MONTHS = 99.0  # Age at which a milestone that is not reached counts as reached.


def curves(axial: StrengthCurve, legs: StrengthCurve, arms: StrengthCurve) -> dict[str, StrengthCurve]:
    """Return the curves by group; hands and eyes keep theirs."""
    groups = {
        **dict.fromkeys(TRUNK_GROUPS, axial),
        **dict.fromkeys(LEG_GROUPS, legs),
        **dict.fromkeys(ARM_GROUPS, arms),
    }
    return {**STRENGTH, **groups}


GROWN = replace(AXIAL, newborn=1.0)
VARIANTS: Mapping[str, Mapping[str, StrengthCurve]] = {
    "as it is": STRENGTH,
    "one curve: the trunk's": curves(AXIAL, AXIAL, AXIAL),
    "one curve: the legs'": curves(LEGS, LEGS, LEGS),
    "one curve: the arms'": curves(ARMS, ARMS, ARMS),
    "trunk <-> limbs": curves(LEGS, AXIAL, AXIAL),
    "arms <-> legs": curves(AXIAL, ARMS, LEGS),
    "strength of 18 months": curves(GROWN, GROWN, GROWN),
}


def main() -> None:
    """Print a row for each variant as soon as it is known."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--variants", nargs="+", choices=VARIANTS, default=list(VARIANTS), metavar="NAME")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--spec", type=Path)
    options = parser.parse_args()
    spec = mimoc.load_spec(options.spec) if options.spec else InfantSpec(mimoc=1, name="child", age_months=0)
    print(f"| curves of strength | {' | '.join(f'`{name}`' for name in TRIALS)} | inside | at birth | order |")
    print(f"|{'---|' * (len(TRIALS) + 4)}")
    usual = " | ".join(f"{USUAL[name]:g}" for name in TRIALS)
    print(f"| real infants, usual | {usual} | | | |", flush=True)
    for variant in options.variants:
        pool = ProcessPoolExecutor(options.processes, get_context("spawn"), put_in, (variant,))
        with pool:
            jobs = {name: pool.submit(find, spec.model_dump_json(), name) for name in TRIALS}
            print(row(variant, {name: job.result() for name, job in jobs.items()}), flush=True)


def put_in(variant: str) -> None:
    """Let all infants of this process have other curves."""
    strength.STRENGTH = VARIANTS[variant]


def find(spec: str, name: str) -> SearchResult:
    """Return the search for a milestone with the curves of this process."""
    infant = InfantSpec.model_validate_json(spec)
    return search_trials(infant, Conditions(), [name], AGES)[name]


def row(variant: str, results: Mapping[str, SearchResult]) -> str:
    """Return a row of the table."""
    ages = {name: result.youngest_months for name, result in results.items()}
    inside = sum(WINDOWS[name].verdict(age, of_average=True) == "inside" for name, age in ages.items())
    ranked = [LAST_MONTHS if ages[name] is None else ages[name] for name in TRIALS]
    real = list(map(USUAL.__getitem__, TRIALS))
    order = np.corrcoef(rankdata(ranked), rankdata(real))[0, 1] if len(set(ranked)) > 1 else np.nan
    shown = " | ".join("-" if ages[name] is None else f"{ages[name]:g}" for name in TRIALS)
    born = sum(result.at_birth for result in results.values())
    return f"| {variant} | {shown} | {inside} | {born} | {order:.2f} |"


if __name__ == "__main__":
    main()
