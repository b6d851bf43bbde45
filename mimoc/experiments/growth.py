"""Growth from birth to two years, compared with WHO's standards (López et al. 2025, figure 2 a-c)."""

from collections.abc import Sequence
from pathlib import Path

from mimoc.compiler.validation import GrowthReport, Row, grow_against_who
from mimoc.experiments.notebook import Notebook, markdown_table
from mimoc.render.plots.file import encode
from mimoc.render.plots.growth import growth_sheet

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

ABOUT = """\
The average child is compiled at {count} ages from birth to two years, and each compiled model is measured as a child
is: length from crown to sole, circumference of the head and of the left upper arm, and mass of the whole body. The
measurements are compared with WHO's Child Growth Standards; the band reaches from the 5th to the 95th percentile of
boys and girls together.

![Length, weight, head and arm circumference of the compiled infant compared with WHO's standards](growth.png)

`growth.csv` has all values with their z-scores for boys, for girls and relative to the mean of both."""

COMPARED = """\
## Comparison with the paper

In the paper, height, mass and head circumference of the infant are inside WHO's band at every age, within one standard
deviation. {verdict} The last column gives the results of the rules published with the paper, compiled and measured at
whole months. These growth curves are fitted without data on newborns, and make a one-month-old longer than nearly all
girls of that age.

{table}"""


def run(notebook: Notebook) -> Path:
    """Measure the growth of the average child, and return the path of the report."""
    months = QUICK_MONTHS if notebook.quick else MONTHS
    report = grow_against_who(months=months, progress=notebook.progress)
    notebook.write_table(
        "growth.csv",
        ("age_months", "indicator", "value", "z_boys", "z_girls", "z_mean", "percentile"),
        (_cells(row) for row in report.rows),
    )
    notebook.write_picture("growth.png", encode(growth_sheet(report.series)))
    sections = (ABOUT.format(count=len(months)), COMPARED.format(verdict=_verdict(report), table=_table(report)))
    return notebook.write_page("Growth", sections, seeds="Nothing is random.", libraries=["matplotlib"])


def _cells(row: Row) -> tuple[float, str, float, float, float, float, float]:
    z = row.z
    return row.age_months, row.indicator, row.value, z["male"], z["female"], z["mean"], row.percentile["mean"]


def _verdict(report: GrowthReport) -> str:
    holds = "The same holds" if report.passed else "This does NOT always hold"
    largest = f"The largest deviation from the mean of boys and girls is that of the {_worst_name(report)}."
    return f"{holds} for mimoc, including arm circumference. {largest}"


def _worst_name(report: GrowthReport) -> str:
    row = max(report.worst.values(), key=lambda row: abs(row.z["mean"]))
    return f"{NAMES[row.indicator]} at {row.age_months:g} months, z = {row.z['mean']:+.2f}"


def _table(report: GrowthReport) -> str:
    headings = (
        "measure",
        "largest z",
        "at months",
        "largest z, boys",
        "largest z, girls",
        "largest z, published rules",
    )
    rows = []
    for indicator, worst in report.worst.items():
        measured = [row for row in report.rows if row.indicator == indicator]
        sexes = (max((row.z[sex] for row in measured), key=abs) for sex in ("male", "female"))
        shown = (f"{z:+.2f}" for z in sexes)
        published = PUBLISHED_WORST.get(indicator, "not known")
        rows.append((NAMES[indicator], f"{worst.z['mean']:+.2f}", f"{worst.age_months:g}", *shown, published))
    return markdown_table(headings, rows)
