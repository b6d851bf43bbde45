"""What can be asked of the vestibular sense, and what the runtime must know of it."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.quantities import Distinct

VestibularQuantity = Literal["accelerometer", "gyro"]


class VestibularSpec(Model):
    """The sense of balance."""

    include: Annotated[tuple[VestibularQuantity, ...], Distinct, Field(min_length=1)] = ("accelerometer", "gyro")
    """What the inner ear measures: specific force (its otoliths), angular velocity (its canals), or both."""


class VestibularEntry(Model):
    """The sense of balance."""

    kind: Literal["vestibular"] = "vestibular"
    """Which sense this is."""
    accelerometer: str | None = None
    """Sensor of the head's specific force, m/s², if that is measured."""
    gyro: str | None = None
    """Sensor of the head's angular velocity, rad/s, if that is measured."""
