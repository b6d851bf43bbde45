"""Growth from birth to two years, compared with WHO's standards (López et al. 2025, figure 2 a-c)."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from mimoc.fits.who import Reference
from mimoc.render.plots.file import encode
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiments.notebook import Notebook, figures_of, table_rows
from mimoc.studies.growth.plot import growth_sheet
from mimoc.studies.growth.who import GrowthReport, grow_against_who

MONTHS: Sequence[float] = [half / 2 for half in range(49)]
QUICK_MONTHS: Sequence[float] = (0, 1, 2, 4, 6, 9, 12, 18, 24)

NAMES = {
    "length_cm": "length",
    "weight_kg": "weight",
    "head_circumference_cm": "head circumference",
    "arm_circumference_cm": "arm circumference",
}
SEXES: Mapping[str, Reference] = {"boys": "male", "girls": "female"}


def run(notebook: Notebook) -> Path:
    """Measure the growth of the average child, and return the path of the report."""
    months = QUICK_MONTHS if notebook.quick else MONTHS
    report = grow_against_who(next(infants(notebook.law)), months, notebook.progress)
    heading = "age_months,indicator,value,z_boys,z_girls,z_mean,percentile"
    references = ("male", "female", "mean")
    cells = (
        (row.age_months, row.indicator, row.value, *(row.z[name] for name in references), row.percentile["mean"])
        for row in report.rows
    )
    notebook.write_table("growth.csv", heading, cells)
    notebook.write_picture("growth.png", encode(growth_sheet(report.series)))
    farthest = max(report.worst.values(), key=lambda row: abs(row.z["mean"]))
    return notebook.write_page(
        dict(_measured(report)),
        count=len(months),
        holds="The same holds" if report.passed else "This does NOT always hold",
        farthest=f"{NAMES[farthest.indicator]} at {farthest.age_months:g} months, z = {farthest.z['mean']:+.2f}",
        table=table_rows(_worst(report)),
        within=", ".join(
            f"{NAMES[indicator]} at {sum(not row.outside_one_sd for row in rows)} of {len(rows)}"
            for indicator, rows in report.by_indicator.items()
        ),
    )


def infants(law: Development) -> Iterator[InfantSpec]:
    """Yield the average child at several ages."""
    for age_months in QUICK_MONTHS:
        yield InfantSpec(mimoc=1, name="average_child", age_months=age_months, development=law)


def _measured(report: GrowthReport) -> Iterator[tuple[str, float | str]]:
    for row in report.rows:
        what = f"{NAMES[row.indicator]} at {row.age_months:g} month{'s' * (row.age_months != 1)}"
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
