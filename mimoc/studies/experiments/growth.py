"""Growth from birth to two years, compared with WHO's standards (López et al. 2025, figure 2 a-c)."""

from collections.abc import Iterator, Mapping, Sequence

from mimoc.fits.standards import Reference
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiment import Experiment, Table, figures_of
from mimoc.studies.growth import GrowthReport, grow_against_who
from mimoc.studies.growth_plots import growth_sheet
from mimoc.studies.notebook import PAGES, Notebook, months_text, table_rows

MONTHS: Sequence[float] = [half / 2 for half in range(49)]
QUICK_MONTHS: Sequence[float] = (0, 1, 2, 4, 6, 9, 12, 18, 24)

NAMES = {
    "length_cm": "length",
    "weight_kg": "weight",
    "head_circumference_cm": "head circumference",
    "arm_circumference_cm": "arm circumference",
}
SEXES: Mapping[str, Reference] = {"boys": "male", "girls": "female"}


def measure(notebook: Notebook) -> GrowthReport:
    """Measure the growth of the average child."""
    months = QUICK_MONTHS if notebook.quick else MONTHS
    return grow_against_who(next(infants(notebook.law)), months, notebook.progress)


def infants(law: Development) -> Iterator[InfantSpec]:
    """Yield the average child at several ages."""
    for age_months in QUICK_MONTHS:
        yield InfantSpec(mimoc=1, name="average_child", age_months=age_months, development=law)


def _table(report: GrowthReport) -> Table:
    references = ("male", "female", "mean")
    return "age_months,indicator,value,z_boys,z_girls,z_mean,percentile", (
        (row.age_months, row.indicator, row.value, *(row.z[name] for name in references), row.percentile["mean"])
        for row in report.rows
    )


def _numbers(report: GrowthReport) -> dict[str, object]:
    farthest = max(report.worst.values(), key=lambda row: abs(row.z["mean"]))
    return {
        "count": len({row.age_months for row in report.rows}),
        "holds": "The same holds" if report.passed else "This does NOT always hold",
        "farthest": f"{NAMES[farthest.indicator]} at {farthest.age_months:g} months, z = {farthest.z['mean']:+.2f}",
        "table": table_rows(_worst(report)),
        "within": ", ".join(
            f"{NAMES[indicator]} at {sum(not row.outside_one_sd for row in rows)} of {len(rows)}"
            for indicator, rows in report.by_indicator.items()
        ),
    }


def _measured(report: GrowthReport) -> Iterator[tuple[str, float | str]]:
    for row in report.rows:
        what = f"{NAMES[row.indicator]} at {months_text(row.age_months)}"
        yield f"{what} [{row.indicator.rpartition('_')[2]}]", row.value
        for sex, reference in SEXES.items():
            yield f"{what}, z among {sex}", row.z[reference]
    for indicator, rows in report.by_indicator.items():
        outside = [row for row in rows if row.outside_one_sd]
        where = f"no: z = {max((row.z['mean'] for row in outside), key=abs):+.2f}" if outside else "yes"
        yield f"{NAMES[indicator]}: within one SD of WHO's mean of boys and girls at all ages", where


def _worst(report: GrowthReport) -> Iterator[tuple[str, ...]]:
    for indicator, worst in report.worst.items():
        measured = [row for row in report.rows if row.indicator == indicator]
        sexes = (max((row.z[sex] for row in measured), key=abs) for sex in ("male", "female"))
        ours = (f"{z:+.2f}" for z in sexes)
        known = [item.paper for item in figures_of("growth") if item.quantity.startswith(f"{NAMES[indicator]} at ")]
        of_mimo = max((z for z in known if z[0] in "+-"), key=lambda z: abs(float(z)), default="not known")
        yield NAMES[indicator], f"{worst.z['mean']:+.2f}", f"{worst.age_months:g}", *ours, of_mimo


EXPERIMENT = Experiment(
    name="growth",
    measure=measure,
    files={"growth.csv": _table, "growth.png": lambda report: growth_sheet(report.series)},
    page=PAGES / "growth.md",
    numbers=_numbers,
    measured=lambda report: dict(_measured(report)),
    infants=infants,
    development="maturing",
)
