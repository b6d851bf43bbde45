"""WHO's growth curves and where a child is on them, for a page."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from mimoc import fits
from mimoc.bundle.manifest import ChildEntry
from mimoc.fits.who import percentile
from mimoc.render.plots.growth import PERCENTILES, who_chart
from mimoc.render.plots.plot import Line
from mimoc.viewer.packing import Packed

SHOWN = ("length_cm", "weight_kg", "head_circumference_cm")


def describe_standards(packed: Packed, children: Sequence[ChildEntry]) -> dict[str, Any]:
    """Return WHO's percentiles by age for children of this sex, and the child's own measures at its ages.

    Args:
        packed: Where the arrays go.
        children: The child at each age.
    """
    reference = children[0].sex or "mean"
    ages_months = [child.age_months for child in children]
    charts = {}
    for name in SHOWN:
        values, standard = [getattr(child, name) for child in children], fits.load_tables().who[name]
        scores = [standard.z_score(value, age, reference) for value, age in zip(values, ages_months, strict=True)]
        chart = who_chart(name, reference)
        charts[name] = {
            "plot": replace(chart, lines=(*chart.lines, Line(ages_months, values, "", "own"))).to_data(packed.put),
            "percentile": packed.put([percentile(score) for score in scores]),
        }
    return {"reference": reference, "percentiles": PERCENTILES, "charts": charts}
