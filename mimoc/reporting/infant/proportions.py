"""The measurements of an infant next to those of the average child of its age."""

from collections.abc import Iterator

import mujoco

from mimoc.compiler.validation.anthrokids import TOLERANCE
from mimoc.compiler.validation.measuring import measure_body
from mimoc.fits import load_tables, measure
from mimoc.quantities.columns import AVERAGE, DIFFERENCE, MEASURED
from mimoc.render.plots.drawing import Drawing, Path, box, line
from mimoc.reporting import words
from mimoc.reporting.infant.sources import Sources
from mimoc.reporting.page import Cell, Section, Text, number, table
from mimoc.units import m_to_cm

WIDTH, HEIGHT = 150.0, 14.0
MOST = 0.12
"""Largest deviation that a bar shows, relative to the average."""
FAR = "bar-far"

ABOUT = (
    "Taken on the body with tape and calipers, as on children, and compared with the growth curve of the average child "
    "of this age, which is fitted to the AnthroKids survey (Snyder et al. 1977). The shaded middle is ±{tolerance:g} %."
)


def proportions(model: mujoco.MjModel, age_months: float, sources: Sources) -> Section:
    """Return the section on an infant's measurements."""
    about = ABOUT.format(tolerance=100 * TOLERANCE)
    headings = ("measurement", MEASURED.heading, AVERAGE.heading, DIFFERENCE.heading, "")
    rows = list(_rows(model, age_months, sources))
    return Section("proportions", "Proportions", (Text(about), table(headings, rows)))


def _rows(model: mujoco.MjModel, age_months: float, sources: Sources) -> Iterator[tuple[Cell, ...]]:
    average, surveyed = measure(age_months), load_tables().anthrokids
    for name, value_m in sorted(measure_body(model).items()):
        deviation = value_m / average[name] - 1
        marked = "" if name in surveyed else "*"
        yield (
            Cell(words.sentence(words.name(name)) + marked, links=sources.links(f"measurements.{name}_cm")),
            number(f"{m_to_cm(value_m):.1f}"),
            number(f"{m_to_cm(average[name]):.1f}"),
            number(words.signed(100 * deviation)),
            Cell("", drawings=(_bar(words.name(name), deviation),)),
        )


def _bar(name: str, deviation: float) -> Drawing:
    """Return a bar from the middle to the deviation."""
    middle, scale = WIDTH / 2, WIDTH / 2 / MOST
    shown = scale * min(max(deviation, -MOST), MOST)
    kind = FAR if abs(deviation) > TOLERANCE else "bar"
    paths: list[Path] = [
        box(middle - scale * TOLERANCE, 0, 2 * scale * TOLERANCE, HEIGHT, "tolerance"),
        box(min(middle, middle + shown), 4, abs(shown), HEIGHT - 8, kind),
        line([(middle, 0), (middle, HEIGHT)], "axis"),
    ]
    title = f"{name}: {words.signed(100 * deviation)} % from the average child"
    return Drawing(title, (WIDTH, HEIGHT), paths, kind="small")
