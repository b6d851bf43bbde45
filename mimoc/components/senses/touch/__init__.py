"""Touch, all over the skin."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mimoc.schema.base import Model, omitting
from mimoc.schema.body import PartName
from mimoc.schema.entries import Body, Length
from mimoc.schema.kinds import AGES_MONTHS, AgeTable, NoiseOption, SenseKind
from mimoc.schema.names import Groups
from mimoc.schema.quantities import Centimetres, Distinct, Real

TouchQuantity = Literal["force_vector", "force_vector_global", "normal"]
TouchResponse = Literal["linear", "nearest"]
Channel = Literal["sa1", "ra", "pc", "ct"]

POINTS = "touch/points_m"
"""Array of the bundle: the skin points of all bodies, one body after the other, shape (n, 3), in the frames of their
bodies."""


class TouchSpec(Model):
    """Touch, at points all over the skin."""

    density: Annotated[Real, Field(ge=0.1, le=10)] = 1.0
    """Density of skin points, relative to that derived from infants' two-point discrimination thresholds."""
    quantity: TouchQuantity = "force_vector"
    """Measured quantity: force in the frame of the body part (`force_vector`), force in the world frame
    (`force_vector_global`), or the normal component of the force (`normal`)."""
    response: TouchResponse = "linear"
    """Whether the force of a contact is distributed over the skin points around it (`linear`) or assigned to the
    nearest one (`nearest`)."""
    channels: Annotated[tuple[Channel, ...], *Distinct, Field(min_length=1)] | None = None
    """What adapting receptors make of the pressure at each point, in place of `quantity`: slowly adapting ones (`sa1`),
    rapidly adapting ones (`ra`), onsets of contact (`pc`) and slow stroking of hairy skin (`ct`)."""
    spacing_cm: (
        Annotated[
            Mapping[PartName, Annotated[Centimetres, Field(ge=0.1, le=1000)]],
            Field(min_length=1, json_schema_extra={"unit": "cm"}),
        ]
        | None
    ) = None
    """Distances between neighbouring skin points at 18 months, by part of the body, in place of `density`; parts that
    are not named have no skin points then."""
    regions: Annotated[Groups, Field(min_length=1)] | None = None
    """Muscle groups whose body parts have skin points; `neck` includes the head. By default, the whole body."""


class SkinEntry(Model):
    """The skin points of one body."""

    body: Body
    """The body."""
    points: Annotated[int, Field(ge=0, le=10**7)]
    """Number of points."""
    spacing_m: Annotated[Length, Field(ge=1e-5)]
    """Distance between neighbouring points."""


class TouchEntry(Model):
    """Touch."""

    kind: Literal["touch"] = "touch"
    """Name of the sense."""
    quantity: TouchQuantity
    """Measured quantity: force in the frame of the body, force in the world frame, or its normal component."""
    response: TouchResponse
    """Whether the force of a contact is distributed over the skin points around it or assigned to the nearest one."""
    skin: tuple[SkinEntry, ...]
    """Bodies that have skin points, in the order of the model and of the array `touch/points_m`."""
    channels: Annotated[tuple[Channel, ...], *Distinct] = ()
    """Channels of adapting receptors at each point, which measure its pressure; none is the quantity itself."""
    hairless: Annotated[tuple[Body, ...], *Distinct] = ()
    """Bodies with skin on which stroking is not felt."""

    _serialized = omitting("channels", "hairless")

    @model_validator(mode="after")
    def _channels_measure_pressure(self) -> Self:
        if self.channels and self.quantity != "normal":
            raise ValueError("channels: they measure the pressure, which is the quantity 'normal'")
        return self


KIND = SenseKind(
    name="touch",
    spec=TouchSpec,
    entry=TouchEntry,
    build="mimoc.components.senses.touch.build",
    run="mimoc.components.senses.touch.run",
    many="mimoc.components.senses.touch.run",
    device="mimoc.components.senses.touch.device",
    physiological_delay=AgeTable(AGES_MONTHS, (40, 35, 25, 20, 20, 20), (40, 40, 35, 35, 30, 30)),
    noise=NoiseOption(
        unit="n",
        about="Standard deviation of the force at each skin point that is touched, in newtons.",
        most=100.0,
        run="mimoc.components.senses.touch.run:bind_noise",
    ),
)
