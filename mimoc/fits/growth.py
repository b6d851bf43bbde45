"""The average child of any age: one growth curve for each measurement."""

from collections.abc import Mapping
from functools import cache, lru_cache
from types import MappingProxyType
from typing import Literal

from mimoc.base.errors import DataError
from mimoc.base.units import cm_to_m
from mimoc.fits.anthropometry import DataPoint, Measured, Measurements
from mimoc.fits.curves import LAST_MONTH, LogCurve, fit_count_curve, fit_log_curve
from mimoc.fits.tables import GroupMean, GrowthTables, load_tables

Placement = Literal["middle", "published"]
"""Where an age group stands on the age axis: in the middle of its months, or where MIMo v2 puts it."""

Curves = Literal["count", "paper", "published"]
"""Growth curves: Count's, with a steady part, which bodies grow by; the paper's law (eq. 1), fitted to the same points,
which their strength follows; and the curves of MIMo v2 itself: its coefficients, as published."""
Law = Literal["count", "paper"]  # The laws that curves are fitted by.

POINTS: Mapping[Law, int] = {"paper": 4, "count": 5}  # Least number of points of a curve, one of them at birth.

OTHER_SURVEY_WEIGHT = 0.5
"""Weight of the children's survey, of which one group shows where curves lead after two years: it is a mean over 18
months, of standing and sitting instead of lying children. With full weight, thighs of 22 months are 4.4 % too thick."""

PUBLISHED_AGES_MONTHS = {0: 1.0, 3: 3.0, 6: 7.0, 9: 10.0, 12: 13.5, 16: 17.5, 20: 21.5, 24: 33.0}
"""MIMo v2's ages by the first month of the group (reverse-engineered from its coefficients)."""

BIRTH = "inferred birth row"  # How a point at age zero is marked: AnthroKids has no newborns.

Fit = tuple[LogCurve, tuple[DataPoint, ...]]


@lru_cache(maxsize=64)
def measure(age_months: float, curves: Curves = "count") -> Measurements:
    """Return the measurements of the average child of *age_months*, 0 to 24, by one kind of growth curves.

    Finger diameters have no group means to fit; their published coefficients stand in. MIMo v2 published coefficients
    of 18 measurements; the others stand beside them by the paper's law.
    """
    if curves != "count":
        table = _read_all(age_months, "paper", preferred=curves == "published")
        return Measurements(age_months, table, table)
    table = _read_all(age_months, "count")
    return Measurements(age_months, table, table, measure(age_months, "paper"))


def _read_all(age_months: float, law: Law, *, preferred: bool = False) -> Mapping[str, Measured]:
    """Return all measurements; by published coefficients where these are *preferred*, or nothing else is known."""
    table = {
        name: Measured(cm_to_m(curve(age_months)), f"anthrokids.csv: {name}, log fit", curve, points)
        for name, (curve, points) in _shipped_fits(law).items()
    }
    for name, curve in load_tables().published.items():
        if preferred or name not in table:
            origin = f"anthrokids_published_fits.csv: {name}"
            table[name] = Measured(cm_to_m(curve(age_months)), origin, curve)
    return MappingProxyType(table)


def fit_growth(tables: GrowthTables, placement: Placement = "middle", law: Law = "count") -> Mapping[str, Fit]:
    """Return the growth curve of each measurement, in cm by months, and the points it goes through.

    Raises:
        DataError: If a measurement has too few groups to be fitted.
    """
    return MappingProxyType(
        {name: _fit(name, means, tables, placement, law) for name, means in tables.anthrokids.items()}
    )


@cache
def _shipped_fits(law: Law) -> Mapping[str, Fit]:
    return fit_growth(load_tables(), law=law)


def _fit(name: str, means: tuple[GroupMean, ...], tables: GrowthTables, placement: Placement, law: Law) -> Fit:
    least = POINTS[law] - (placement == "middle")
    if len(means) < least:
        raise DataError(f"anthrokids.csv: {name} has {len(means)} age groups; a growth curve needs {least}")
    points = tuple(DataPoint(group_age(mean, placement), mean.mean_cm, f"anthrokids.csv:{mean.line}") for mean in means)
    weights = [OTHER_SURVEY_WEIGHT if mean.first_month >= LAST_MONTH else 1.0 for mean in means]
    if placement == "middle":
        points = (_birth_point(name, means[0], tables), *points)
        weights = [1.0, *weights]
    ages_months, values_cm = [p.age_months for p in points], [p.value_cm for p in points]
    if law == "paper":
        return fit_log_curve(ages_months, values_cm), points
    return fit_count_curve(ages_months, values_cm, weights), points


def group_age(mean: GroupMean, placement: Placement = "middle") -> float:
    """Return the age that stands for a group, in months; completed months 0 to 2 end at the age of 3 months."""
    if placement == "published":
        return PUBLISHED_AGES_MONTHS[mean.first_month]
    return (mean.first_month + mean.last_month + 1) / 2


def _birth_point(name: str, first: GroupMean, tables: GrowthTables) -> DataPoint:
    """Return the newborn's value: the first group shrunk to WHO's birth length, the head WHO's own."""
    if name == "head_circumference":
        head_cm = tables.who["head_circumference_cm"].value(0, 0, "mean")
        return DataPoint(0.0, head_cm, f"{BIRTH}: WHO head circumference")
    shrink = tables.who["length_cm"].value(0, 0, "mean") / tables.anthrokids["crown_sole_length"][0].mean_cm
    return DataPoint(
        0.0, first.mean_cm * shrink, f"{BIRTH}: anthrokids.csv:{first.line} x {shrink:.4f} (WHO birth length)"
    )
