"""Comparison of the compiled infant's measurements with the means of AnthroKids, by age group."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from mimoc import fits
from mimoc.base.rounding import rounded
from mimoc.base.units import m_to_cm
from mimoc.compiler.child import checked_or_average, child_of
from mimoc.compiler.measuring import SAME, Progress, compare_at_ages, compile_infant, measure_body
from mimoc.fits.curves import LAST_MONTH
from mimoc.fits.growth import group_age
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import unsided

TOLERANCE = 0.04  # Largest deviation from the mean of a group, relative to it.


@dataclass(frozen=True, slots=True)
class MeasurementRow:
    """One measurement of the infant at one age, and the survey's."""

    age_months: float
    measurement: str  # AnthroKids' name.
    value_cm: float
    mean_cm: float  # Of the age group; a finger's, of which only curves are known, by MIMo v2's curve.
    origin: str  # Where the mean comes from: `anthrokids.csv:12`.
    requested: float = 1.0  # What the spec asks for, relative to the average child of this age.
    is_judged: bool = True
    """Whether it can be outside: what other measurements and factors of parts change is only reported."""

    @property
    def goal_cm(self) -> float:
        """What it is compared with: the mean, times what the spec asks for."""
        return self.mean_cm * self.requested

    @property
    def deviation(self) -> float:
        """Deviation from the goal, relative to it."""
        return self.value_cm / self.goal_cm - 1

    @property
    def outside(self) -> bool:
        """Whether it deviates by more than `TOLERANCE`."""
        return self.is_judged and abs(self.deviation) > TOLERANCE

    def to_data(self) -> dict[str, Any]:
        """Return the row as plain data, not rounded."""
        return {name: getattr(self, name) for name in COLUMNS}


COLUMNS = (
    *("age_months", "measurement", "value_cm", "mean_cm", "requested", "deviation"),
    *("is_judged", "outside", "origin"),
)


@dataclass(frozen=True, slots=True)
class MeasurementReport:
    """Comparison of an infant with AnthroKids at the middle of each age group."""

    rows: tuple[MeasurementRow, ...]  # Rows by age, youngest first.

    @property
    def within_tolerance(self) -> bool:
        """Whether no measurement deviates by more than `TOLERANCE`."""
        return not any(row.outside for row in self.rows)

    @property
    def ages_months(self) -> Sequence[float]:
        """Ages, youngest first."""
        return list(dict.fromkeys(row.age_months for row in self.rows))

    def by_measurement(self) -> Iterator[tuple[str, Mapping[float, MeasurementRow]]]:
        """Yield each measurement, in alphabetical order, with its rows by age in months."""
        ordered = sorted(self.rows, key=lambda row: (row.measurement, row.age_months))
        for name, rows in groupby(ordered, key=lambda row: row.measurement):
            yield name, {row.age_months: row for row in rows}

    def to_data(self) -> dict[str, Any]:
        """Return the report as plain data, numbers rounded as in files; `deviation` and `tolerance` are shares."""
        return rounded(
            {
                "survey": "AnthroKids (Snyder et al. 1977)",
                "tolerance": TOLERANCE,
                "within_tolerance": self.within_tolerance,
                "rows": [row.to_data() for row in self.rows],
            }
        )


def compare_with_anthrokids(spec: InfantSpec | None = None, progress: Progress | None = None) -> MeasurementReport:
    """Return the comparison of an infant, or the average child, in the middle of age groups with the survey's means.

    Raises:
        SpecError: If the spec asks for what this version cannot build, or for a child that there is not at some age.
    """
    infant = checked_or_average(spec)
    means = fits.load_tables().anthrokids["crown_sole_length"]
    ages_months = [age for age in map(group_age, means) if age <= LAST_MONTH]
    return MeasurementReport(compare_at_ages(infant, ages_months, _compare, progress))


def _compare(child: InfantSpec) -> Iterator[MeasurementRow]:
    tables, age_months, average = fits.load_tables(), child.age_months, fits.measure(child.age_months)
    wanted = child_of(child).measurements
    wanted_m, measured_m = wanted.of_side("left"), measure_body(compile_infant(child))
    whole = child.model_copy(update={"body": child.body.model_copy(update={"parts": {}, "measurements": {}})})
    unchanged_m = measured_m if whole == child else measure_body(compile_infant(whole))
    named = {unsided(key) for key in child.body.measurements if not key.startswith("right_")}
    for name, value_m in sorted(measured_m.items()):
        if name in tables.anthrokids:
            mean = next(mean for mean in tables.anthrokids[name] if group_age(mean) == age_months)
            mean_cm, origin = mean.mean_cm, f"anthrokids.csv:{mean.line}"
        else:
            mean_cm, origin = tables.published[name](age_months), f"anthrokids_published_fits.csv: {name}"
        requested = wanted_m[name] / average[name]
        is_judged = name in named or math.isclose(value_m, unchanged_m[name], rel_tol=SAME)
        yield MeasurementRow(age_months, name, m_to_cm(value_m), mean_cm, origin, requested, is_judged)
