"""How much stronger infants would have to be for their nervous system to let them sit and stand as real ones do.

    python benchmarks/nervous_strength.py [--trials sit stand] [--seeds 5] [--ages 6 11] [--most 4]

At the age at which half of real infants do it, or one that is given, bisects the common factor on the strength of all
muscles from which on an infant with delays and noise succeeds with at least half of the seeds, and prints a row of a
table in Markdown for each trial. Success need not rise with strength everywhere, so what is printed is one factor at
which success changes.
"""

import argparse
import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

from dataclasses import replace

from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones import WINDOWS
from mimoc.studies.milestones.trial import USUAL, Conditions, compile_at, try_out
from mimoc.studies.milestones.trials import TRIALS

CHILD = InfantSpec(mimoc=1, name="average_child", age_months=0)
CLOSE = 1.1  # Ratio of factors at which the bisection ends.


def succeeds(name: str, age_months: float, conditions: Conditions) -> bool:
    """Return whether the average child of an age succeeds."""
    return try_out(TRIALS[name], compile_at(CHILD, age_months, conditions), conditions).success


def factor(name: str, age_months: float, seeds: int, most: float) -> str:
    """Return the factor on strength from which on it succeeds, in words."""
    usual = replace(USUAL, seeds=seeds)
    if succeeds(name, age_months, usual):
        return "1 or less"
    if not succeeds(name, age_months, replace(usual, strength=most)):
        return f"not with {most:g}"
    low, high = 1.0, most
    while high / low > CLOSE:
        middle = (low * high) ** 0.5
        if succeeds(name, age_months, replace(usual, strength=middle)):
            high = middle
        else:
            low = middle
    return f"{low:.2f} to {high:.2f}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", nargs="+", default=["sit", "stand"], choices=TRIALS)
    parser.add_argument("--ages", nargs="+", type=float, help="in months, one for each trial; default: the usual ones")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--most", type=float, default=4.0, help="the largest factor that is tried")
    given = parser.parse_args()
    ages = given.ages or [WINDOWS[name].usual_months or 0.0 for name in given.trials]
    print("| trial | age, months | factor on strength |\n|---|---|---|")
    for name, age_months in zip(given.trials, ages, strict=True):
        print(f"| `{name}` | {age_months:g} | {factor(name, age_months, given.seeds, given.most)} |", flush=True)


if __name__ == "__main__":
    main()
