"""Comparison of the compiled infant with WHO's growth standards, by age."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import mujoco
import numpy as np

from mimoc import fits
from mimoc.base.rounding import rounded
from mimoc.base.units import m_to_cm
from mimoc.body.kinematics import Stature
from mimoc.compiler.child import checked_or_average
from mimoc.compiler.validation.requests import (
    PRIMITIVES,
    ROOT,
    Progress,
    Requests,
    compile_infant,
    own_solids,
    requests_of,
    solid_extents,
)
from mimoc.compiler.variants import at_age_unchecked, errors_at
from mimoc.fits.who import REFERENCES, Reference, percentile
from mimoc.geometry.primitives import girth
from mimoc.schema.infant import InfantSpec

MONTHS = range(25)
"""Ages of the comparison, in whole months."""
AVERAGE_SD = 1.0
"""How far the average child may be from WHO's mean of boys and girls, in standard deviations."""
REQUESTED_SD = 0.01
"""How far a measure may be from what the spec asks for, in standard deviations of WHO's children: at the 3rd percentile
that is 0.07 percentiles, at the 50th 0.4. Bodies are solved to 1e-7."""


@dataclass(frozen=True, slots=True)
class Row:
    """One measure of the infant at one age, with its scores in WHO's standards."""

    age_months: float
    indicator: str
    """`length_cm`, `weight_kg`, `head_circumference_cm` or `arm_circumference_cm`."""
    value: float
    """Value, in the unit of the indicator's name."""
    z: Mapping[Reference, float]
    """Standard deviations above the median of boys, of girls and of their mean."""
    reference: Reference = "mean"
    """Whom it is judged by: children of its sex, or the mean of both if the spec gives none."""
    requested_z: float | None = None
    """The z-score that the spec asks for; None if it asks for none."""
    is_judged: bool = True
    """Whether it can be missed: what follows from other measures of an individual is only reported."""

    @property
    def percentile(self) -> Mapping[Reference, float]:
        """Percentiles, 0 to 100, by reference."""
        return {reference: percentile(z) for reference, z in self.z.items()}

    @property
    def deviation(self) -> float:
        """Standard deviations above what the spec asks for, or above WHO's median if it asks for nothing."""
        return self.z[self.reference] - (self.requested_z or 0.0)

    @property
    def outside_one_sd(self) -> bool:
        """Whether it is more than one standard deviation from the median, whatever the spec asks for."""
        return abs(self.z[self.reference]) > 1

    @property
    def missed(self) -> bool:
        """Whether it is not what the spec asks for, or of the average child, too far from the mean of both sexes."""
        limit = AVERAGE_SD if self.requested_z is None else REQUESTED_SD
        return self.is_judged and abs(self.deviation) > limit


@dataclass(frozen=True, slots=True)
class GrowthReport:
    """Comparison of an infant with WHO's standards at several ages."""

    rows: tuple[Row, ...]
    """Rows by age, youngest first; at each age length, weight, head and, from three months on, arm."""

    @property
    def passed(self) -> bool:
        """Whether no measure is missed."""
        return not any(row.missed for row in self.rows)

    @property
    def within_one_sd(self) -> bool:
        """Whether no measure is more than one standard deviation from the median, whatever the spec asks for."""
        return not any(row.outside_one_sd for row in self.rows)

    @property
    def reference(self) -> Reference:
        """Whom the infant is judged by."""
        return self.rows[0].reference

    @property
    def worst(self) -> Mapping[str, Row]:
        """The row furthest from what the spec asks for, or from WHO's median, by indicator."""
        return {
            indicator: max(rows, key=lambda row: abs(row.deviation)) for indicator, rows in self.by_indicator.items()
        }

    @property
    def series(self) -> Mapping[str, Sequence[tuple[float, float]]]:
        """Age in months and value, by indicator."""
        return {
            indicator: [(row.age_months, row.value) for row in rows] for indicator, rows in self.by_indicator.items()
        }

    def by_age(self) -> Iterator[tuple[float, Mapping[str, Row]]]:
        """Yield each age in months with its rows by indicator."""
        for age_months, rows in groupby(self.rows, key=lambda row: row.age_months):
            yield age_months, {row.indicator: row for row in rows}

    def to_data(self) -> dict[str, Any]:
        """Return the report as plain data, numbers rounded as in files.

        `rows` are as in `Row`; `worst` holds one of them for each indicator; `z` and `percentile` have the keys
        `male`, `female` and `mean`; `requested_percentile` is that of `requested_z`, both by `reference`.
        """
        return rounded(
            {
                "standard": "WHO Child Growth Standards",
                "reference": self.reference,
                "tolerance_sd": {"average": AVERAGE_SD, "requested": REQUESTED_SD},
                "passed": self.passed,
                "within_one_sd": self.within_one_sd,
                "worst": {indicator: _row_data(row) for indicator, row in self.worst.items()},
                "rows": [_row_data(row) for row in self.rows],
            }
        )

    @property
    def by_indicator(self) -> Mapping[str, Sequence[Row]]:
        """Rows by indicator, youngest first."""
        indicators = dict.fromkeys(row.indicator for row in self.rows)
        return {indicator: [row for row in self.rows if row.indicator == indicator] for indicator in indicators}


def grow_against_who(
    spec: InfantSpec | None = None, months: Iterable[float] | None = None, progress: Progress | None = None
) -> GrowthReport:
    """Return the comparison of an infant, compiled at several ages, with WHO's standards.

    Args:
        spec: The infant, which is measured at its own age too; None means the average child.
        months: Ages in months, 0 to 24; None means every whole month.
        progress: Called after each age.

    Raises:
        SpecError: If the spec asks for what this version cannot build, or for a child that there is not at some age.
    """
    infant = checked_or_average(spec)
    ages = sorted({*map(float, MONTHS if months is None else months), *([infant.age_months] if spec else ())})
    rows: list[Row] = []
    for done, age_months in enumerate(ages, start=1):
        rows += _rows_at(infant, age_months)
        if progress:
            progress(done, len(ages))
    return GrowthReport(tuple(rows))


def _rows_at(infant: InfantSpec, age_months: float) -> list[Row]:
    """Return the rows of an infant that has grown to an age."""
    with errors_at(infant, age_months):
        child = at_age_unchecked(infant, age_months)
        measures = measure_compiled(compile_infant(child))
        individual = child.body.individual
        sex = individual.sex if individual else None
        return compare_with_who(age_months, measures, sex or "mean", requests_of(child, measures))


def measure_compiled(model: mujoco.MjModel) -> Stature:
    """Return length, weight and circumferences of a compiled infant with all joints at zero, of the left arm."""
    return Stature(
        length_cm=m_to_cm(_standing_height_m(model)),
        weight_kg=float(model.body_subtreemass[model.body(ROOT).id]),
        head_circumference_cm=m_to_cm(_girth_m(model, "head")),
        arm_circumference_cm=_arm_circumference_cm(model),
    )


def compare_with_who(
    age_months: float, measures: Stature, reference: Reference = "mean", requests: Requests | None = None
) -> list[Row]:
    """Return the rows of one age: one for each indicator that WHO has a standard for at that age.

    Args:
        age_months: The age.
        measures: The measures of the infant.
        reference: Whom it is judged by.
        requests: What its spec asks for; None means the average child.
    """
    rows = []
    for indicator, standard in fits.load_tables().who.items():
        value = measures[indicator]
        if value is None or not standard.covers(age_months):
            continue
        z: dict[Reference, float] = {to: standard.z_score(value, age_months, to) for to in REFERENCES}
        wanted, is_judged = (requests or {}).get(indicator), indicator not in (requests or {})
        wanted_z = None if wanted is None else standard.z_score(wanted, age_months, reference)
        rows.append(Row(age_months, indicator, value, z, reference, wanted_z, is_judged or wanted is not None))
    return rows


def _row_data(row: Row) -> dict[str, Any]:
    return {
        "age_months": row.age_months,
        "indicator": row.indicator,
        "value": row.value,
        "z": row.z,
        "percentile": row.percentile,
        "requested_z": row.requested_z,
        "requested_percentile": None if row.requested_z is None else percentile(row.requested_z),
        "is_judged": row.is_judged,
        "missed": row.missed,
        "outside_one_sd": row.outside_one_sd,
    }


def _arm_circumference_cm(model: mujoco.MjModel) -> float | None:
    """Return the circumference of the left upper arm, or of the right one if there is no left one, or None."""
    geom = mujoco.mjtObj.mjOBJ_GEOM
    arms = [name for name in ("left_uarm1", "right_uarm1") if mujoco.mj_name2id(model, geom, name) >= 0]
    return m_to_cm(_girth_m(model, arms[0])) if arms else None


def _girth_m(model: mujoco.MjModel, geom: str) -> float:
    shape = model.geom(geom)
    return float(girth(PRIMITIVES[shape.type[0]], shape.size))


def _standing_height_m(model: mujoco.MjModel) -> float:
    """Return the crown-sole length: the vertical extent of the infant's geoms with all joints at zero."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    flesh = own_solids(model)
    middles = data.geom_xpos[flesh, 2]
    up = data.geom_xmat[flesh].reshape(-1, 3, 3)[:, 2]  # The vertical, in the frame of each geom.
    halves = solid_extents(model, flesh).along(up)
    return float(np.max(middles + halves) - np.min(middles - halves))
