"""What a condition changes, seed by seed: each infant is compared with itself."""

from collections.abc import Mapping, Sequence
from statistics import fmean

from mimoc.studies.experiments.legs.intervals import interval, sign_test

LEVEL = 0.05  # Chance below which a direction counts as shown.
Values = Sequence[Mapping[str, float]]  # Measures of each seed.


def relative_changes(plain: Values, changed: Values, measure: str) -> list[float]:
    """Return (c - p) / mean(p) of each seed, p and c being its values without and with a condition.

    Of seeds without a value, nothing is returned; nothing at all if the mean is zero.
    """
    pairs = [(p[measure], c[measure]) for p, c in zip(plain, changed, strict=True) if measure in p and measure in c]
    mean = fmean(before for before, _ in pairs) if pairs else 0.0
    return [(after - before) / mean for before, after in pairs] if mean else []


def change_text(changes: Sequence[float]) -> str:
    """Return a mean change with its interval, and how many seeds it has the direction of."""
    if not changes:
        return "-"
    mean = interval(changes)
    rises = mean.mean > 0
    same = sum((change > 0) == rises for change in changes if change)
    return f"{mean.text(percent=True)}, {same} of {len(changes)}"


def direction(changes: Sequence[float], least: float = 0.0) -> str:
    """Return `more` or `less` if too many seeds change so for chance (p < .05), and the mean by at least some share.

    Otherwise `same`; with so few seeds that not even all of them would do, `unclear`.
    """
    if 0.5 ** len(changes) >= LEVEL:
        return "unclear"
    mean = interval(changes).mean
    if mean >= least and sign_test(changes) < LEVEL:
        return "more"
    return "less" if mean <= -least and sign_test([-change for change in changes]) < LEVEL else "same"
