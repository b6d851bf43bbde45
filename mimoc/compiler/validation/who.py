"""Comparison of the compiled infant with WHO's growth standards, by age."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import mujoco
import numpy as np

from mimoc import fits
from mimoc.body.stature import Stature
from mimoc.compiler.availability import refuse_unavailable
from mimoc.compiler.validation.compiled import PRIMITIVES, ROOT, Progress, compile_infant, own_solids, solid_extents
from mimoc.fits.who import REFERENCES, Reference, percentile
from mimoc.geometry.primitives import girth
from mimoc.rounding import rounded
from mimoc.schema.infant import InfantSpec, validated
from mimoc.units import m_to_cm

MONTHS = range(25)
"""Ages of the comparison, in whole months."""


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

    @property
    def percentile(self) -> Mapping[Reference, float]:
        """Percentiles, 0 to 100, by reference."""
        return {reference: percentile(z) for reference, z in self.z.items()}

    @property
    def outside_one_sd(self) -> bool:
        """Whether it is more than one standard deviation from the mean of boys and girls."""
        return abs(self.z["mean"]) > 1


@dataclass(frozen=True, slots=True)
class GrowthReport:
    """Comparison of an infant with WHO's standards at several ages."""

    rows: tuple[Row, ...]
    """Rows by age, youngest first; at each age length, weight, head and, from three months on, arm."""

    @property
    def within_one_sd(self) -> bool:
        """Whether every row lies within one standard deviation of the mean of boys and girls."""
        return not any(row.outside_one_sd for row in self.rows)

    @property
    def worst(self) -> Mapping[str, Row]:
        """The row furthest from the mean of boys and girls, by indicator."""
        return {
            indicator: max(rows, key=lambda row: abs(row.z["mean"])) for indicator, rows in self._by_indicator.items()
        }

    @property
    def series(self) -> Mapping[str, Sequence[tuple[float, float]]]:
        """Age in months and value, by indicator."""
        return {
            indicator: [(row.age_months, row.value) for row in rows] for indicator, rows in self._by_indicator.items()
        }

    def by_age(self) -> Iterator[tuple[float, Mapping[str, Row]]]:
        """Yield each age in months with its rows by indicator."""
        for age_months, rows in groupby(self.rows, key=lambda row: row.age_months):
            yield age_months, {row.indicator: row for row in rows}

    def to_data(self) -> dict[str, Any]:
        """Return the report as plain data, numbers rounded as in files.

        `rows` are as in `Row`; `worst` holds one of them for each indicator; `z` and `percentile` have the keys
        `male`, `female` and `mean`.
        """
        return rounded(
            {
                "standard": "WHO Child Growth Standards",
                "within_one_sd": self.within_one_sd,
                "worst": {indicator: _row_data(row) for indicator, row in self.worst.items()},
                "rows": [_row_data(row) for row in self.rows],
            }
        )

    @property
    def _by_indicator(self) -> Mapping[str, list[Row]]:
        indicators = dict.fromkeys(row.indicator for row in self.rows)
        return {indicator: [row for row in self.rows if row.indicator == indicator] for indicator in indicators}


def grow_against_who(
    spec: InfantSpec | None = None, months: Iterable[float] | None = None, progress: Progress | None = None
) -> GrowthReport:
    """Return the comparison of an infant, compiled at several ages, with WHO's standards.

    Args:
        spec: The infant, which is measured at its own age too; None means the average child.
        months: Ages in months, 0 to 24; None means every whole month, or only the spec's age if it gives measurements.
        progress: Called after each age.

    Raises:
        SpecError: If the spec asks for what this version cannot build.
    """
    infant = validated(spec) if spec else InfantSpec(mimoc=1, name="average_child", age_months=0)
    refuse_unavailable(infant)
    if months is None:
        months = () if is_of_one_age(infant) else MONTHS
    ages = sorted({*map(float, months), *([infant.age_months] if spec else ())})
    rows: list[Row] = []
    for done, age_months in enumerate(ages, start=1):
        model = compile_infant(infant.model_copy(update={"age_months": age_months}))
        rows += compare_with_who(age_months, measure_compiled(model))
        if progress:
            progress(done, len(ages))
    return GrowthReport(tuple(rows))


def is_of_one_age(spec: InfantSpec) -> bool:
    """Return whether a spec gives lengths or weights, which are valid only for its age, unlike percentiles."""
    individual = spec.body.individual
    measured = individual and (individual.length_cm, individual.weight_kg, individual.head_circumference_cm)
    return bool(spec.body.measurements) or any(value is not None for value in measured or ())


def measure_compiled(model: mujoco.MjModel) -> Stature:
    """Return length, weight and circumferences of a compiled infant with all joints at zero, of the left arm."""
    return Stature(
        length_cm=m_to_cm(_standing_height_m(model)),
        weight_kg=float(model.body_subtreemass[model.body(ROOT).id]),
        head_circumference_cm=m_to_cm(_girth_m(model, "head")),
        arm_circumference_cm=_arm_circumference_cm(model),
    )


def compare_with_who(age_months: float, measures: Stature) -> list[Row]:
    """Return the rows of one age: one for each indicator that WHO has a standard for at that age."""
    return [
        Row(age_months, indicator, value, {to: standard.z_score(value, age_months, to) for to in REFERENCES})
        for indicator, standard in fits.load_tables().who.items()
        if standard.covers(age_months) and (value := measures[indicator]) is not None
    ]


def _row_data(row: Row) -> dict[str, Any]:
    return {
        "age_months": row.age_months,
        "indicator": row.indicator,
        "value": row.value,
        "z": row.z,
        "percentile": row.percentile,
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
