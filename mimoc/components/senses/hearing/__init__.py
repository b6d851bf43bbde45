"""Hearing: two ears on a head of the infant's size."""

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from mimoc.schema.base import Model
from mimoc.schema.entries import Amount, Body, Length, Number
from mimoc.schema.kinds import AGES_MONTHS, AgeTable, NoiseOption, SenseKind
from mimoc.schema.quantities import Whole

if TYPE_CHECKING:
    from mimoc.body.tree import BodyTree
    from mimoc.compiler.mjcf.scene import Placed


HearingOutput = Literal["cochleagram", "waveform", "levels"]
Thresholds = Literal["age", "adult", "off"]
Hertz = Annotated[Whole, Field(ge=8000, le=96_000, json_schema_extra={"unit": "hz"})]


class HearingSpec(Model):
    """Hearing, with two ears on a spherical head."""

    output: HearingOutput = "cochleagram"
    """What is observed of each ear: the level of each frequency band (`cochleagram`), the sound pressure of each sample
    since the last control step (`waveform`), or the level of the loudest band (`levels`)."""
    sample_rate_hz: Hertz = 24_000
    """Samples of sound per second; a control step must have a whole number of them. Sound has frequencies up to half of
    that."""
    channels: Annotated[Whole, Field(ge=4, le=128)] = 32
    """Number of frequency bands of each ear, from 100 Hz to 8 kHz, or to 0.9 of half the sample rate."""
    thresholds: Thresholds = "age"
    """What is not heard: sounds below the thresholds of the infant's age (`age`), of adults (`adult`), or none
    (`off`)."""


class HearingEntry(Model):
    """Hearing."""

    kind: Literal["hearing"] = "hearing"
    """Name of the sense."""
    head: Body
    """Body with the ears, whose x axis is forward and y axis to the left."""
    centre_m: tuple[Number, Number, Number]
    """Centre of the spherical head in the frame of that body, [m]."""
    radius_m: Length
    """Radius of the spherical head."""
    output: HearingOutput
    """What is observed of each ear."""
    sample_rate_hz: Annotated[int, Field(ge=8000, le=96_000)]
    """Samples of sound per second."""
    channels: Annotated[int, Field(ge=4, le=128)]
    """Number of frequency bands of each ear."""
    threshold_hz: tuple[Annotated[Amount, Field(gt=0)], ...] = ()
    """Frequencies at which thresholds are known, in rising order; empty if everything is heard."""
    threshold_db: tuple[Number, ...] = ()
    """Threshold at each of them, in dB re 20 µPa."""

    @model_validator(mode="after")
    def _each_frequency_has_its_threshold(self) -> Self:
        if len(self.threshold_hz) != len(self.threshold_db):
            raise ValueError(f"threshold_db: {len(self.threshold_db)} numbers for {len(self.threshold_hz)} frequencies")
        if list(self.threshold_hz) != sorted(set(self.threshold_hz)):
            raise ValueError("threshold_hz: frequencies do not rise")
        return self


RADIUS_RULE = ".964 x head circumference / 2 pi, as of adults (r = 8.75 cm; Woodworth 1938); derived"
RULES = {
    "age": "adults' (ISO 389-7) and what infants' are higher by, of Olsho & Gillenwater 1989, Olsho et al. 1988 and "
    "Nozza & Wilson 1984, interpolated by age and log frequency; derived",
    "adult": "adults' in a free field (ISO 389-7)",
}


def build(spec: HearingSpec, body: "BodyTree") -> "Placed":
    """Return the entry; nothing stands for the ears in the MJCF."""
    from mimoc.base.geometry.spherical_head import head_radius_m
    from mimoc.body.kinematics import stature
    from mimoc.compiler.mjcf.scene import Placed

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
    from mimoc.base.geometry.spherical_head import interaural_time_s
    from mimoc.base.rounding import rounded

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


KIND = SenseKind(
    name="hearing",
    spec=HearingSpec,
    entry=HearingEntry,
    build=build,
    run="mimoc.components.senses.hearing.run",
    organs=("head",),
    physiological_delay=AgeTable(AGES_MONTHS, (7.0, 6.8, 6.5, 6.2, 5.9, 5.7)),
    noise=NoiseOption(
        unit="db",
        about="Standard deviation of the level of each band that is heard, or of the whole sound at each ear as a "
        "waveform.",
        most=60.0,
        run="mimoc.components.senses.hearing.run:bind_noise",
    ),
    omit_if_absent=True,
)
"""Its delay is that of wave V of the auditory brainstem response at 60 to 70 dB (from memory)."""
