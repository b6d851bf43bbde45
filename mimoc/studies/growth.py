"""Comparison of the compiled infant with WHO's growth standards and with AnthroKids' measurements, by age."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import mujoco

from mimoc import fits
from mimoc.base.geometry.primitives import Solids, girth
from mimoc.base.rounding import rounded
from mimoc.base.units import m_to_cm
from mimoc.body.grow import usual_measures
from mimoc.body.kinematics import Stature, stature
from mimoc.bundle.model import PRIMITIVES, solid_extents
from mimoc.compiler.child import checked_or_average, child_of
from mimoc.compiler.measuring import ROOT, SAME, UP, Progress, compare_at_ages, compile_infant, measure_body, own_solids
from mimoc.fits.curves import LAST_MONTH
from mimoc.fits.growth import group_age
from mimoc.fits.standards import REFERENCES, Reference, percentile
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import unsided
from mimoc.schema.sizes import MEASUREMENT_OF

MONTHS = range(25)  # Ages of the comparison, in whole months.
AVERAGE_SD = 1.0  # How far the average child may be from WHO's mean of boys and girls, in standard deviations.
REQUESTED_SD = 0.01
"""How far a measure may be from what the spec asks for, in standard deviations of WHO's children: at the 3rd percentile
that is 0.07 percentiles, at the 50th 0.4. Bodies are solved to 1e-7."""
MEASUREMENTS: Mapping[str, str] = {**MEASUREMENT_OF, "arm_circumference_cm": "upper_arm_circumference"}
"""The measurement that is the same as a measure, by indicator."""

Requests = Mapping[str, float | None]
"""Requested value by indicator, in cm or kg; None if it follows from other keys; of average children, there is none."""


@dataclass(frozen=True, slots=True)
class GrowthRow:
    """One measure of the infant at one age, with its scores in WHO's standards."""

    age_months: float
    indicator: str  # `length_cm`, `weight_kg`, `head_circumference_cm` or `arm_circumference_cm`.
    value: float  # Value, in the unit of the indicator's name.
    z: Mapping[Reference, float]  # Standard deviations above the median of boys, of girls and of their mean.
    reference: Reference = "mean"
    """The children it is judged by: those of its sex, or the mean of both if the spec gives none."""
    requested_z: float | None = None  # The z-score that the spec asks for; None if it asks for none.
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
    def requested_percentile(self) -> float | None:
        """The percentile of `requested_z`, by `reference`."""
        return None if self.requested_z is None else percentile(self.requested_z)

    @property
    def outside_one_sd(self) -> bool:
        """Whether it is more than one standard deviation from the median, whatever the spec asks for."""
        return abs(self.z[self.reference]) > 1

    @property
    def missed(self) -> bool:
        """Whether it is not what the spec asks for, or of the average child, too far from the mean of both sexes."""
        limit = AVERAGE_SD if self.requested_z is None else REQUESTED_SD
        return self.is_judged and abs(self.deviation) > limit

    def to_data(self) -> dict[str, Any]:
        """Return the row as plain data, not rounded."""
        return {name: getattr(self, name) for name in GROWTH_COLUMNS}


GROWTH_COLUMNS = (
    *("age_months", "indicator", "value", "z", "percentile", "requested_z", "requested_percentile"),
    *("is_judged", "missed", "outside_one_sd"),
)


@dataclass(frozen=True, slots=True)
class GrowthReport:
    """Comparison of an infant with WHO's standards at several ages."""

    rows: tuple[GrowthRow, ...]
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
        """The children that the infant is judged by."""
        return self.rows[0].reference

    @property
    def worst(self) -> Mapping[str, GrowthRow]:
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

    def by_age(self) -> Iterator[tuple[float, Mapping[str, GrowthRow]]]:
        """Yield each age in months with its rows by indicator."""
        for age_months, rows in groupby(self.rows, key=lambda row: row.age_months):
            yield age_months, {row.indicator: row for row in rows}

    def to_data(self) -> dict[str, Any]:
        """Return the report as plain data, numbers rounded as in files.

        `rows` are as in `GrowthRow`; `worst` holds one of them for each indicator; `z` and `percentile` have the keys
        `male`, `female` and `mean`; `requested_percentile` is that of `requested_z`, both by `reference`.
        """
        return rounded(
            {
                "standard": "WHO Child Growth Standards",
                "reference": self.reference,
                "tolerance_sd": {"average": AVERAGE_SD, "requested": REQUESTED_SD},
                "passed": self.passed,
                "within_one_sd": self.within_one_sd,
                "worst": {indicator: row.to_data() for indicator, row in self.worst.items()},
                "rows": [row.to_data() for row in self.rows],
            }
        )

    @property
    def by_indicator(self) -> Mapping[str, Sequence[GrowthRow]]:
        """Rows by indicator, youngest first."""
        indicators = dict.fromkeys(row.indicator for row in self.rows)
        return {indicator: [row for row in self.rows if row.indicator == indicator] for indicator in indicators}


def grow_against_who(
    spec: InfantSpec | None = None, months: Iterable[float] | None = None, progress: Progress | None = None
) -> GrowthReport:
    """Return the comparison of an infant, compiled at several ages, with WHO's standards.

    Args:
        spec: The infant, which is measured at its own age too; None means the average child.
        months: Ages in months, 0 to 24; None means every whole month from term on.
        progress: Called after each age.

    Raises:
        SpecError: If the spec asks for what this version cannot build, or for a child that there is not at some age.
    """
    infant = checked_or_average(spec)
    usual = (month for month in MONTHS if month >= infant.months_early)
    ages = sorted({*map(float, usual if months is None else months), *([infant.age_months] if spec else ())})
    return GrowthReport(compare_at_ages(infant, ages, _rows, progress))


def _rows(child: InfantSpec) -> list[GrowthRow]:
    measures = measure_compiled(compile_infant(child))
    individual = child.body.individual
    reference: Reference = (individual and individual.sex) or "mean"
    return compare_with_who(rounded(child.corrected_age_months), measures, reference, requests_of(child, measures))


def measure_compiled(model: mujoco.MjModel) -> Stature:
    """Return length, weight and girths of a compiled infant, all joints at zero, of the left arm if it has one."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    geoms = own_solids(model)
    solids = Solids(solid_extents(model, geoms), data.geom_xpos[geoms], data.geom_xmat[geoms].reshape(-1, 3, 3))
    low_m, high_m = solids.span(UP)
    names = {model.geom(geom).name for geom in geoms}
    arms_cm = [m_to_cm(_girth_m(model, arm)) for arm in ("left_uarm1", "right_uarm1") if arm in names]
    return Stature(
        length_cm=m_to_cm(high_m - low_m),
        weight_kg=float(model.body_subtreemass[model.body(ROOT).id]),
        head_circumference_cm=m_to_cm(_girth_m(model, "head")),
        arm_circumference_cm=arms_cm[0] if arms_cm else None,
    )


def compare_with_who(
    age_months: float, measures: Stature, reference: Reference = "mean", requests: Requests | None = None
) -> list[GrowthRow]:
    """Return the rows of one age: one for each indicator that WHO has a standard for at that age.

    Without requests, the infant is judged as the average child.
    """
    rows = []
    for indicator, standard in fits.load_tables().who.items():
        value = measures[indicator]
        if value is None or not standard.covers(age_months):
            continue
        z: dict[Reference, float] = {to: standard.z_score(value, age_months, to) for to in REFERENCES}
        wanted = (requests or {}).get(indicator)
        is_judged = indicator not in (requests or {})
        wanted_z = None if wanted is None else standard.z_score(wanted, age_months, reference)
        rows.append(GrowthRow(age_months, indicator, value, z, reference, wanted_z, is_judged or wanted is not None))
    return rows


def _girth_m(model: mujoco.MjModel, geom: str) -> float:
    shape = model.geom(geom)
    return float(girth(PRIMITIVES[shape.type[0]], shape.size))


def requests_of(spec: InfantSpec, measures: Stature) -> Requests:
    """Return what a spec asks of each measure of its compiled child.

    What an individual does not name follows from what it names, and what single measurements, factors of parts and
    missing parts change is not asked for by anything else.
    """
    requests: dict[str, float | None] = {}
    wanted = usual_measures(spec) if spec.body.individual or spec.months_early else None
    if wanted:
        requests = {
            "length_cm": wanted.length_m and m_to_cm(wanted.length_m),
            "weight_kg": wanted.weight_kg,
            "head_circumference_cm": wanted.head_m and m_to_cm(wanted.head_m),
            "arm_circumference_cm": None,
        }
    for indicator, value in measures.items():
        name = MEASUREMENTS.get(indicator)
        given_cm = spec.body.measurements.get(f"left_{name}_cm", spec.body.measurements.get(f"{name}_cm"))
        if given_cm is not None:
            requests[indicator] = given_cm
        if isinstance(value, float) and _is_changed(spec, indicator, value):
            requests[indicator] = None
    return requests


def _is_changed(spec: InfantSpec, indicator: str, value: float) -> bool:
    """Return whether a measure differs from that of the same child without other single measurements and factors."""
    body, name = spec.body, MEASUREMENTS.get(indicator)
    alone = {key: value_cm for key, value_cm in body.measurements.items() if unsided(key) == name}
    if len(alone) == len(body.measurements) and not body.parts and not body.remove:
        return False
    plain = body.model_copy(update={"measurements": alone, "parts": {}, "remove": ()})
    tree = child_of(spec.model_copy(update={"body": plain})).tree
    before = dict(stature(tree))[indicator]
    return not (isinstance(before, float) and math.isclose(value, before, rel_tol=SAME))


TOLERANCE = 0.04  # Largest deviation from the mean of a group, relative to it.


@dataclass(frozen=True, slots=True)
class MeasurementRow:
    """One measurement of the infant at one age, and the survey's."""

    age_months: float
    measurement: str  # AnthroKids' name.
    value_cm: float
    mean_cm: float  # Mean of the age group; for fingers, which have no means, MIMo v2's curve.
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
        return {name: getattr(self, name) for name in MEASUREMENT_COLUMNS}


MEASUREMENT_COLUMNS = (
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
    tables = fits.load_tables()
    age_months = child.age_months
    average = fits.measure(child.age_months)
    wanted = child_of(child).measurements
    wanted_m = wanted.of_side("left")
    measured_m = measure_body(compile_infant(child))
    whole = child.model_copy(update={"body": child.body.model_copy(update={"parts": {}, "measurements": {}})})
    unchanged_m = measured_m if whole == child else measure_body(compile_infant(whole))
    named = {unsided(key) for key in child.body.measurements if not key.startswith("right_")}
    for name, value_m in sorted(measured_m.items()):
        if name in tables.anthrokids:
            mean = next(mean for mean in tables.anthrokids[name] if group_age(mean) == age_months)
            mean_cm, origin = mean.mean_cm, f"anthrokids.csv:{mean.line}"
        else:
            mean_cm = tables.published[name](age_months)
            origin = f"anthrokids_published_fits.csv: {name}"
        requested = wanted_m[name] / average[name]
        is_judged = name in named or math.isclose(value_m, unchanged_m[name], rel_tol=SAME)
        yield MeasurementRow(age_months, name, m_to_cm(value_m), mean_cm, origin, requested, is_judged)
