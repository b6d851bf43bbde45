"""When the children of a cohort reach milestones, beside WHO's children; and whether the heavy and the fat are late."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from statistics import NormalDist, mean, stdev
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.base.quantities.milestones import MILESTONE_AGES
from mimoc.base.rounding import rounded
from mimoc.studies.cohorts.infants import build_z
from mimoc.studies.cohorts.table import Cell, Rows
from mimoc.studies.milestones.report import WINDOWS

SOURCE = "WHO Multicentre Growth Reference Study Group 2006, Acta Paediatr Suppl 450: 86-95"
WHO: Mapping[str, str] = {  # WHO's milestone by the trial that comes nearest to it, whose window has WHO's ages.
    "sit": "sitting without support",
    "hands_and_knees": "hands-and-knees crawling",
    "pull_to_stand": "standing with assistance",
    "stand": "standing alone",
}

DELAYS_SOURCE = "Slining et al. 2010, J Pediatr 157: 20-25, 217 infants of 3 to 18 months"
PUBLISHED_ODDS: Mapping[str, tuple[float, float, float]] = {
    "heavy for length": (1.80, 1.09, 2.97),
    "fat": (2.32, 1.26, 4.29),
}
"""Odds of a delay, relative to all others, and their 95 % interval, by group: each the uppermost tenth, by weight for
length and by skinfolds. A delay was a score of motor development of more than one standard deviation below the mean."""
UPPERMOST = NormalDist().inv_cdf(0.9)  # z-score from which on a child is of a group.
ALL = "all together"


@dataclass(frozen=True, slots=True)
class MilestoneSpread:
    """The ages at which the children of a cohort reach a milestone."""

    trial: str
    n: int  # Children that reach it.
    not_reached: int  # Children that do not, by 24 months.
    mean_months: float | None
    sd_months: float | None
    who: str  # WHO's milestone that comes nearest; empty if there is none.
    who_mean_months: float | None
    who_sd_months: float | None


@dataclass(frozen=True, slots=True)
class DelayOdds:
    """How much more often the children of a group reach a milestone late than all others: later than mean and SD."""

    trial: str
    group: str
    n: int  # Children of the group.
    late: int  # Those of them that are late.
    others: int
    late_others: int
    odds_ratio: float
    low: float  # Lower end of its 95 % interval, by Woolf's method with a half added to each number.
    high: float


@dataclass(frozen=True, slots=True)
class MilestoneSummary:
    """When the children of a cohort reach milestones."""

    spreads: tuple[MilestoneSpread, ...]
    odds: tuple[DelayOdds, ...]
    """Only for drawn children, whose percentiles are known: for each milestone, and for the mean of their z-scores."""
    published_odds: Mapping[str, tuple[float, float, float]]
    who_source: str = SOURCE
    odds_source: str = DELAYS_SOURCE

    def to_data(self) -> dict[str, Any]:
        """Return it as plain data, numbers rounded as in files."""
        return rounded(asdict(self))


def milestone_summary(rows: Rows) -> MilestoneSummary:
    """Return when the children in the table of a cohort reach milestones; raise a MimocError if none are found."""
    children = [row for row in rows if row["step"] == "milestones" and row["status"] == "ok"]
    ages = {trial: [row.get(quantity.name) for row in children] for trial, quantity in MILESTONE_AGES.items()}
    tried = {trial: column for trial, column in ages.items() if f"{trial}_months" in (children[0] if children else ())}
    if not tried:
        raise MimocError("there are no milestones in this cohort; write 'do: [milestones]', and run it")
    scores = {trial: _scores(column) for trial, column in tried.items()}
    scores[ALL] = _scores([mean(of_child) for of_child in zip(*scores.values(), strict=True)])
    return MilestoneSummary(
        tuple(_spread(trial, column) for trial, column in tried.items()), tuple(_odds(children, scores)), PUBLISHED_ODDS
    )


def _spread(trial: str, column: Sequence[Cell]) -> MilestoneSpread:
    reached = [float(age) for age in column if isinstance(age, int | float)]
    average, deviation = (mean(reached) if reached else None), (stdev(reached) if len(reached) > 1 else None)
    who = WINDOWS[trial] if trial in WHO else None
    ages_of_who = (who.usual_months, who.sd_months) if who else (None, None)
    return MilestoneSpread(
        trial, len(reached), len(column) - len(reached), average, deviation, WHO.get(trial, ""), *ages_of_who
    )


def _scores(column: Sequence[Cell]) -> list[float]:
    """Return how many standard deviations each age lies above the mean; infinity for children that do not succeed."""
    reached = [float(age) for age in column if isinstance(age, int | float) and math.isfinite(age)]
    average, deviation = (mean(reached), stdev(reached) or 1.0) if len(reached) > 1 else (0.0, 1.0)
    return [(float(age) - average) / deviation if isinstance(age, int | float) else math.inf for age in column]


def _odds(children: Rows, scores: Mapping[str, Sequence[float]]) -> Iterator[DelayOdds]:
    for group, of_group in {"heavy for length": _is_heavy, "fat": _is_fat}.items():
        members = [of_group(child) for child in children]
        if None in members or not any(members):
            continue
        for trial, of_trial in scores.items():
            numbers = Counter((member, score > 1) for member, score in zip(members, of_trial, strict=True))
            cells = (numbers[member, late] for member in (True, False) for late in (True, False))
            yield _odds_of(trial, group, *cells)


def _odds_of(trial: str, group: str, late: int, early: int, late_others: int, early_others: int) -> DelayOdds:
    a, b, c, d = (number + 0.5 for number in (late, early, late_others, early_others))
    logarithm, width = math.log(a * d / (b * c)), NormalDist().inv_cdf(0.975) * math.sqrt(1 / a + 1 / b + 1 / c + 1 / d)
    odds = (math.exp(logarithm + sign * width) for sign in (0, -1, 1))
    return DelayOdds(trial, group, late + early, late, late_others + early_others, late_others, *odds)


def _z(child: Mapping[str, Cell], key: str) -> float | None:
    percentile = child.get(key)
    return NormalDist().inv_cdf(percentile / 100) if isinstance(percentile, int | float) else None


def _is_heavy(child: Mapping[str, Cell]) -> bool | None:
    length, weight = _z(child, "length_percentile"), _z(child, "weight_percentile")
    return None if length is None or weight is None else build_z(length, weight) >= UPPERMOST


def _is_fat(child: Mapping[str, Cell]) -> bool | None:
    fat = _z(child, "fat_percentile")
    return None if fat is None else fat >= UPPERMOST
