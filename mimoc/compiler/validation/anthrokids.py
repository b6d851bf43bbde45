"""Comparison of the compiled infant's measurements with the means of AnthroKids, by age group."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from mimoc import fits
from mimoc.compiler.availability import refuse_unavailable
from mimoc.compiler.validation.compiled import Progress, compile_infant
from mimoc.compiler.validation.measuring import measure_body
from mimoc.compiler.validation.who import is_of_one_age
from mimoc.fits.curves import LAST_MONTH
from mimoc.fits.tables import GroupMean
from mimoc.rounding import rounded
from mimoc.schema.infant import InfantSpec, validated
from mimoc.units import m_to_cm

TOLERANCE = 0.04
"""Largest deviation from the mean of a group, relative to it."""


@dataclass(frozen=True, slots=True)
class MeasurementRow:
    """One measurement of the infant at one age, and the survey's."""

    age_months: float
    measurement: str
    """AnthroKids' name."""
    value_cm: float
    mean_cm: float
    """Of the age group; a finger's, of which only curves are known, by MIMo v2's curve."""
    origin: str
    """Where the mean comes from: `anthrokids.csv:12`."""

    @property
    def deviation(self) -> float:
        """Deviation from the mean, relative to it."""
        return self.value_cm / self.mean_cm - 1

    @property
    def outside(self) -> bool:
        """Whether it deviates by more than `TOLERANCE`."""
        return abs(self.deviation) > TOLERANCE


@dataclass(frozen=True, slots=True)
class MeasurementReport:
    """Comparison of an infant with AnthroKids at the middle of each age group."""

    rows: tuple[MeasurementRow, ...]
    """Rows by age, youngest first."""

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
                "rows": [_row_data(row) for row in self.rows],
            }
        )


def compare_with_anthrokids(spec: InfantSpec | None = None, progress: Progress | None = None) -> MeasurementReport:
    """Return the comparison of an infant, compiled at the middle of each age group, with the survey's means.

    Args:
        spec: The infant; None means the average child. One that is given by lengths or weights is measured at its age.
        progress: Called after each age.

    Raises:
        SpecError: If the spec asks for what this version cannot build.
    """
    infant = validated(spec) if spec else InfantSpec(mimoc=1, name="average_child", age_months=0)
    refuse_unavailable(infant)
    groups = _groups(infant.age_months if is_of_one_age(infant) else None)
    rows: list[MeasurementRow] = []
    for done, (age_months, first_month) in enumerate(groups.items(), start=1):
        model = compile_infant(infant.model_copy(update={"age_months": age_months}))
        rows += _compare(age_months, first_month, measure_body(model))
        if progress:
            progress(done, len(groups))
    return MeasurementReport(tuple(rows))


def _groups(only_months: float | None) -> dict[float, int]:
    """Return the first month of each group by the age to measure at, or only of the group that an age belongs to."""
    means = [mean for mean in fits.load_tables().anthrokids["crown_sole_length"] if fits.group_age(mean) <= LAST_MONTH]
    if only_months is None:
        return {fits.group_age(mean): mean.first_month for mean in means}
    return {only_months: max(mean.first_month for mean in means if mean.first_month <= only_months)}


def _compare(age_months: float, first_month: int, measured_m: Mapping[str, float]) -> Iterator[MeasurementRow]:
    tables = fits.load_tables()
    for name, value_m in sorted(measured_m.items()):
        if name in tables.anthrokids:
            mean = _of_group(tables.anthrokids[name], first_month)
            yield MeasurementRow(age_months, name, m_to_cm(value_m), mean.mean_cm, f"anthrokids.csv:{mean.line}")
        else:
            mean_cm, origin = tables.published[name](age_months), f"anthrokids_published_fits.csv: {name}"
            yield MeasurementRow(age_months, name, m_to_cm(value_m), mean_cm, origin)


def _of_group(means: Sequence[GroupMean], first_month: int) -> GroupMean:
    return next(mean for mean in means if mean.first_month == first_month)


def _row_data(row: MeasurementRow) -> dict[str, Any]:
    return {
        "age_months": row.age_months,
        "measurement": row.measurement,
        "value_cm": row.value_cm,
        "mean_cm": row.mean_cm,
        "deviation": row.deviation,
        "outside": row.outside,
        "origin": row.origin,
    }
