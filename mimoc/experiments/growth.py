"""Growth from birth to two years among WHO's children (López et al. 2025, figure 2 a-c)."""

from collections.abc import Sequence
from pathlib import Path

from mimoc.compiler.validation import GrowthReport, Row, grow_against_who
from mimoc.experiments.notebook import Notebook, markdown_table
from mimoc.render.plots import draw_growth
from mimoc.render.plots.figure import png

MONTHS: Sequence[float] = [half / 2 for half in range(49)]
QUICK_MONTHS: Sequence[float] = (0, 3, 6, 9, 12, 18, 24)

NAMES = {
    "length_cm": "length",
    "weight_kg": "weight",
    "head_circumference_cm": "head circumference",
    "arm_circumference_cm": "arm circumference",
}
PUBLISHED_WORST = {"length_cm": "+2.4", "weight_kg": "+1.3", "head_circumference_cm": "+1.3"}
"""The z-score furthest from zero, among boys or girls of 0, 1, 2, 4, 6, 9, 12, 18 and 24 months, of what MIMo v2's
published rules give when compiled and measured; each is among girls of one month."""

ABOUT = """\
The average child is compiled at {count} ages from birth to two years, and each compiled model is measured as with a
tape and a scale: the length crown to sole, the girths of head and left upper arm, the mass of the whole body. All
of it is set against WHO's Child Growth Standards, whose band runs from the 5th to the 95th percentile of boys and
girls together.

![Length, weight, head and arm circumference of the compiled infant among WHO's children](growth.png)

`growth.csv` has every value with its z-score among boys, among girls and against the mean of both."""

COMPARED = """\
## Next to the paper

The paper shows height, mass and head circumference of its infant inside WHO's band at every age, within one
standard deviation. {verdict} The last column is what the rules published with the paper give when they are compiled
and measured at whole months. Those curves have no newborn to start from, and a one-month-old comes out longer than
nearly all girls of its age.

{table}"""


def run(notebook: Notebook) -> Path:
    """Grow the average child, and return the page."""
    months = QUICK_MONTHS if notebook.quick else MONTHS
    report = grow_against_who(months=months, progress=notebook.progress)
    notebook.write_table(
        "growth.csv",
        ("age_months", "indicator", "value", "z_boys", "z_girls", "z_mean", "percentile"),
        (_cells(row) for row in report.rows),
    )
    notebook.write_picture("growth.png", png(draw_growth(report.series)))
    sections = (ABOUT.format(count=len(months)), COMPARED.format(verdict=_verdict(report), table=_table(report)))
    return notebook.write_page("Growth", sections, seeds="Nothing is drawn by chance.", libraries=["matplotlib"])


def _cells(row: Row) -> tuple[float, str, float, float, float, float, float]:
    z = row.z
    return row.age_months, row.indicator, row.value, z["male"], z["female"], z["mean"], row.percentile["mean"]


def _verdict(report: GrowthReport) -> str:
    inside = "So is mimoc's, arm circumference included." if report.within_one_sd else "mimoc's is not always."
    return f"{inside} The largest deviation from the mean of boys and girls is that of its {_worst_name(report)}."


def _worst_name(report: GrowthReport) -> str:
    row = max(report.worst.values(), key=lambda row: abs(row.z["mean"]))
    return f"{NAMES[row.indicator]} at {row.age_months:g} months, z = {row.z['mean']:+.2f}"


def _table(report: GrowthReport) -> str:
    headings = ("indicator", "worst z", "at months", "worst z among boys", "among girls", "worst z, published rules")
    rows = []
    for indicator, worst in report.worst.items():
        measured = [row for row in report.rows if row.indicator == indicator]
        sexes = (max((row.z[sex] for row in measured), key=abs) for sex in ("male", "female"))
        shown = (f"{z:+.2f}" for z in sexes)
        published = PUBLISHED_WORST.get(indicator, "not known")
        rows.append((NAMES[indicator], f"{worst.z['mean']:+.2f}", f"{worst.age_months:g}", *shown, published))
    return markdown_table(headings, rows)
