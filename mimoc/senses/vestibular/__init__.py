"""Balance."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.base.kinds import AgeTable, SenseKind
from mimoc.delays import AGES_MONTHS
from mimoc.schema.base import Model
from mimoc.schema.entries import Sensor
from mimoc.schema.quantities import Distinct

VestibularQuantity = Literal["accelerometer", "gyro"]


class VestibularSpec(Model):
    """The vestibular sense: linear and angular motion of the head."""

    include: Annotated[tuple[VestibularQuantity, ...], *Distinct, Field(min_length=1)] = ("accelerometer", "gyro")
    """Measured quantities: specific force (`accelerometer`, the otoliths), angular velocity (`gyro`, the semicircular
    canals), or both."""


class VestibularEntry(Model):
    """The vestibular sense."""

    kind: Literal["vestibular"] = "vestibular"
    """Name of the sense."""
    accelerometer: Sensor | None = None
    """Sensor of the head's specific force, [m/s²], if it is measured."""
    gyro: Sensor | None = None
    """Sensor of the head's angular velocity, [rad/s], if it is measured."""


KIND = SenseKind(
    name="vestibular",
    spec=VestibularSpec,
    entry=VestibularEntry,
    build="mimoc.senses.vestibular.build",
    run="mimoc.senses.vestibular.run",
    physiological_delay=AgeTable(AGES_MONTHS, (10, 10, 10, 10, 10, 10)),
)
