"""Where the measures of a child come from, and its place among WHO's children."""

from collections.abc import Iterator, Mapping

from mimoc import fits
from mimoc.body import BodyTree
from mimoc.body.origins import Entry
from mimoc.bundle.manifest import ChildEntry
from mimoc.fits.who import percentile

UNITS = {"length_cm": "cm", "weight_kg": "kg", "head_circumference_cm": "cm", "arm_circumference_cm": "cm"}
RULES = {
    "length_cm": "crown to sole: how far the geoms reach along the vertical, no joint turned",
    "weight_kg": "sum of all bodies",
    "head_circumference_cm": "perimeter of the head's level section",
    "arm_circumference_cm": "2 pi x radius of the upper arm",
}
AMONG = {"male": "boys", "female": "girls", None: "the mean of boys and girls"}


def trace_child(tree: BodyTree, child: ChildEntry, percentiles: Mapping[str, float]) -> dict[str, Entry]:
    """Return an entry for each measure of a child, and for each percentile.

    Args:
        tree: Its body.
        child: What it measures.
        percentiles: Among WHO's children, 0 to 100, by indicator.
    """
    return {**dict(_trace_measures(tree, child)), **dict(_trace_percentiles(child, percentiles))}


def who_percentiles(child: ChildEntry) -> dict[str, float]:
    """Return where a child stands among WHO's children of its age and sex, 0 to 100, by indicator.

    An indicator that WHO has no standard for at that age is left out.
    """
    measures = child.model_dump()
    return {
        indicator: percentile(standard.z_score(measures[indicator], child.age_months, child.sex or "mean"))
        for indicator, standard in fits.load_tables().who.items()
        if standard.covers(child.age_months) and measures[indicator] is not None
    }


def _trace_measures(tree: BodyTree, child: ChildEntry) -> Iterator[tuple[str, Entry]]:
    arms = [name for name in ("left_uarm1", "right_uarm1") if name in tree.geoms]
    sources = {
        "length_cm": ["measurements.crown_sole_length_cm"],
        "weight_kg": [f"body.{body.name}.mass" for body in tree.bodies],
        "head_circumference_cm": ["geom.head.size"],
        "arm_circumference_cm": [f"geom.{name}.size" for name in arms[:1]],
    }
    for name, unit in UNITS.items():
        value = getattr(child, name)
        if value is not None:
            yield f"child.{name}", {"value": value, "unit": unit, "rule": RULES[name], "from": sources[name]}


def _trace_percentiles(child: ChildEntry, percentiles: Mapping[str, float]) -> Iterator[tuple[str, Entry]]:
    rule = f"WHO Child Growth Standards: among {AMONG[child.sex]} of that age"
    for name, value in percentiles.items():
        sources = [f"child.{name}", "spec.age_months"]
        yield f"who.{name}.percentile", {"value": value, "unit": "%", "rule": rule, "from": sources}
