"""Hearing: two ears on a head of the infant's size."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mimoc.schema.base import Model
from mimoc.schema.entries import Amount, Body, Length, Number
from mimoc.schema.kinds import AGES_MONTHS, AgeTable, NoiseOption, SenseKind
from mimoc.schema.quantities import Whole

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


KIND = SenseKind(
    name="hearing",
    spec=HearingSpec,
    entry=HearingEntry,
    build="mimoc.components.senses.hearing.build",
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
