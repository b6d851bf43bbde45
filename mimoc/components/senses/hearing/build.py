"""Hearing on a body."""

import math
from collections.abc import Iterator
from typing import Any

from mimoc.base.geometry.spherical_head import head_radius_m, interaural_time_s
from mimoc.base.rounding import rounded
from mimoc.body.kinematics import stature
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.scene import Placed
from mimoc.components.senses.hearing import HearingEntry, HearingSpec
from mimoc.components.senses.hearing.build_thresholds import threshold_table

RADIUS_RULE = ".964 x head circumference / 2 pi, as of adults (r = 8.75 cm; Woodworth 1938); derived"
RULES = {
    "age": "adults' (ISO 389-7) and what infants' are higher by, of Olsho & Gillenwater 1989, Olsho et al. 1988 and "
    "Nozza & Wilson 1984, interpolated by age and log frequency; derived",
    "adult": "adults' in a free field (ISO 389-7)",
}


def build(spec: HearingSpec, body: BodyTree) -> Placed:
    """Return the entry; nothing stands for the ears in the MJCF."""
    circumference_m = stature(body)["head_circumference_cm"] / 100
    frequencies_hz, levels_db = threshold_table(spec.thresholds, body.age_months)
    entry = HearingEntry(
        head="head",
        centre_m=body.geoms["head"].pos_m,
        radius_m=head_radius_m(circumference_m),
        output=spec.output,
        sample_rate_hz=spec.sample_rate_hz,
        channels=spec.channels,
        threshold_hz=frequencies_hz,
        threshold_db=levels_db,
    )
    return Placed(entry, origins=dict(_origins(spec, entry)))


def _origins(spec: HearingSpec, entry: HearingEntry) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield where the size of the head, its interaural time and the thresholds come from."""
    radius = {"value": entry.radius_m, "unit": "m", "rule": RADIUS_RULE, "from": ["child.head_circumference_cm"]}
    yield "hearing.radius_m", radius
    largest_us = 1e6 * interaural_time_s(math.pi / 2, entry.radius_m)
    rule = "r / c (90 deg + sin 90 deg) with c = 343 m/s (Woodworth 1938): of a source straight to the side"
    largest = {"value": rounded(float(largest_us)), "unit": "us", "rule": rule, "from": ["hearing.radius_m"]}
    yield "hearing.largest_time_difference_us", largest
    if spec.thresholds != "off":
        sources = ["spec.senses.hearing.thresholds"] + ["spec.age_months"] * (spec.thresholds == "age")
        for hz, level_db in zip(entry.threshold_hz, entry.threshold_db, strict=True):
            value = {"value": level_db, "unit": "dB", "rule": RULES[spec.thresholds], "from": sources}
            yield f"hearing.threshold_db.{hz:g}_hz", value
