"""Hearing on a body."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from mimoc.base.geometry.spherical_head import head_radius_m, interaural_time_s
from mimoc.base.rounding import rounded
from mimoc.body.kinematics import stature
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.scene import Placed
from mimoc.components.senses.hearing import HearingEntry, HearingSpec

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


ADULT_DB: Mapping[float, float] = dict(
    zip(
        (125, 250, 500, 1000, 1500, 2000, 3000, 4000, 6000, 8000, 12_500),
        (22.1, 11.4, 4.4, 2.4, 2.4, -1.3, -5.8, -5.4, 4.3, 12.6, 11.9),
        strict=True,
    )
)
"""Adults' thresholds in a free field, in dB re 20 µPa by frequency (ISO 389-7; from memory)."""
EXCESS_MONTHS = 0.0, 3.0, 6.0, 12.0, 24.0
EXCESS_HZ = 500.0, 1000.0, 4000.0, 8000.0
EXCESS_DB = (
    (40, 38, 33, 38),
    (22, 20, 18, 28),
    (15, 14, 9, 10),
    (13, 12, 6, 6),
    (10, 8, 4, 4),
)
"""How much higher infants' thresholds are, by age and frequency, in dB: derived from Olsho & Gillenwater 1989 (2 to 4
weeks), Olsho et al. 1988 (3 to 12 months) and Nozza & Wilson 1984 (6 and 12 months). That of 24 months is a guess."""


def excess_db(age_months: float, frequency_hz: float) -> float:
    """Return how much higher than adults' an infant's threshold is, interpolated by age and the logarithm of frequency.

    Below 500 Hz and above 8 kHz it is that there.
    """
    of_age = [np.interp(age_months, EXCESS_MONTHS, column) for column in zip(*EXCESS_DB, strict=True)]
    return float(np.interp(np.log(frequency_hz), np.log(EXCESS_HZ), of_age))


def threshold_table(thresholds: str, age_months: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return frequencies and what is just heard there [dB re 20 µPa]; nothing of both where everything is heard."""
    if thresholds == "off":
        return (), ()
    at_age = thresholds == "age"
    levels_db = (level + (excess_db(age_months, hz) if at_age else 0.0) for hz, level in ADULT_DB.items())
    return tuple(map(float, ADULT_DB)), tuple(levels_db)
