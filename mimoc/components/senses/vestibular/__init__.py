"""Balance."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mimoc.schema.base import Model, omitting
from mimoc.schema.entries import Sensor
from mimoc.schema.kinds import AGES_MONTHS, AgeTable, NoiseOption, SenseKind
from mimoc.schema.quantities import Distinct

VestibularQuantity = Literal["accelerometer", "gyro"]
Canals = Literal["off", "age", "adult", "afferent"]
Seconds = Annotated[float, Field(ge=0, le=1000, allow_inf_nan=False)]


class VestibularSpec(Model):
    """The vestibular sense: linear and angular motion of the head."""

    include: Annotated[tuple[VestibularQuantity, ...], *Distinct, Field(min_length=1)] = ("accelerometer", "gyro")
    """Measured quantities: specific force (`accelerometer`, the otoliths), angular velocity (`gyro`, the semicircular
    canals), or both."""
    canals: Canals | None = None
    """Rotation that is felt: as fast as the head turns (`off`, the default), with slow rotations lost as at the
    infant's age (`age`) or in adults (`adult`), or what the nerve alone says of it (`afferent`)."""


class CanalsEntry(Model):
    """Dynamics of the semicircular canals: what is felt of a rotation over time."""

    time_constant_s: Annotated[Seconds, Field(gt=0)]
    """Within which a constant rotation is no longer felt."""
    adaptation_s: Annotated[Seconds, Field(gt=0)]
    """Time constant of adaptation."""
    lead_s: Seconds = 0.0
    """Time constant by which fast changes are felt more; 0 is none."""
    lag_s: Seconds = 0.0
    """Time constant up to which they are; 0 is none."""

    @model_validator(mode="after")
    def _is_a_filter(self) -> Self:
        poles_s = [self.time_constant_s, self.adaptation_s, *([self.lag_s] if self.lag_s else [])]
        if len(set(poles_s)) < len(poles_s) or (self.lead_s and not self.lag_s):
            raise ValueError("time constants must differ, and a lead needs a lag")
        return self


class VestibularEntry(Model):
    """The vestibular sense."""

    kind: Literal["vestibular"] = "vestibular"
    """Name of the sense."""
    accelerometer: Sensor | None = None
    """Sensor of the head's specific force, [m/s²], if it is measured."""
    gyro: Sensor | None = None
    """Sensor of the head's angular velocity, [rad/s], if it is measured."""
    canals: CanalsEntry | None = None
    """Dynamics of the canals; None where rotation is felt as it is."""

    _serialized = omitting("canals")


KIND = SenseKind(
    name="vestibular",
    spec=VestibularSpec,
    entry=VestibularEntry,
    build="mimoc.components.senses.vestibular.build",
    run="mimoc.components.senses.vestibular.run",
    physiological_delay=AgeTable(AGES_MONTHS, (10, 10, 10, 10, 10, 10)),
    noise=NoiseOption(
        unit="thresholds",
        about="Standard deviation of felt rotation and acceleration, in thresholds of adults (1 deg/s, .03 m/s²), or "
        "that of the infant's age (`age`) or of adults (`adult`).",
        most=1000.0,
        run="mimoc.components.senses.vestibular.run:bind_noise",
        by_age=((0.0, 1.0), (24.0, 0.5)),
        adult=0.5,
        source="half the threshold in adults, twice as much in newborns: a guess, as no infant was measured (D)",
        omit_if_absent=True,
    ),
)
