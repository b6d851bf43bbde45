"""Growth from birth to two years, compared with WHO's standards (López et al. 2025, figure 2 a-c)."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from mimoc.compiler.validation.who import GrowthReport, Row, grow_against_who
from mimoc.render.plots.file import encode
from mimoc.render.plots.growth import growth_sheet
from mimoc.studies.experiments.notebook import Notebook, table_rows

MONTHS: Sequence[float] = [half / 2 for half in range(49)]
QUICK_MONTHS: Sequence[float] = (0, 3, 6, 9, 12, 18, 24)

NAMES = {
    "length_cm": "length",
    "weight_kg": "weight",
    "head_circumference_cm": "head circumference",
    "arm_circumference_cm": "arm circumference",
}
PUBLISHED_WORST = {"length_cm": "+2.4", "weight_kg": "+1.3", "head_circumference_cm": "+1.3"}
"""Largest z-score, among boys or girls of 0, 1, 2, 4, 6, 9, 12, 18 and 24 months, of models that follow MIMo v2's
published rules, compiled and measured in the same way; each is that of girls of one month."""


def run(notebook: Notebook) -> Path:
    """Measure the growth of the average child, and return the path of the report."""
    months = QUICK_MONTHS if notebook.quick else MONTHS
    report = grow_against_who(months=months, progress=notebook.progress)
    heading = "age_months,indicator,value,z_boys,z_girls,z_mean,percentile"
    notebook.write_table("growth.csv", heading, map(_cells, report.rows))
    notebook.write_picture("growth.png", encode(growth_sheet(report.series)))
    farthest = max(report.worst.values(), key=lambda row: abs(row.z["mean"]))
    return notebook.write_page(
        count=len(months),
        holds="The same holds" if report.passed else "This does NOT always hold",
        farthest=f"{NAMES[farthest.indicator]} at {farthest.age_months:g} months, z = {farthest.z['mean']:+.2f}",
        table=table_rows(_worst(report)),
    )


def _cells(row: Row) -> tuple[float, str, float, float, float, float, float]:
    z = row.z
    return row.age_months, row.indicator, row.value, z["male"], z["female"], z["mean"], row.percentile["mean"]


def _worst(report: GrowthReport) -> Iterator[tuple[str, ...]]:
    for indicator, worst in report.worst.items():
        measured = [row for row in report.rows if row.indicator == indicator]
        sexes = (max((row.z[sex] for row in measured), key=abs) for sex in ("male", "female"))
        published = PUBLISHED_WORST.get(indicator, "not known")
        z = (f"{z:+.2f}" for z in sexes)
        yield NAMES[indicator], f"{worst.z['mean']:+.2f}", f"{worst.age_months:g}", *z, published
