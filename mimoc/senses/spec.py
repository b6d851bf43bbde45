"""What an infant perceives of itself and the world."""

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Discriminator, Field, Tag

from mimoc.actuation.spec import Groups
from mimoc.schema.base import Model
from mimoc.schema.quantities import CyclesPerDegree, Degrees, Distinct, Months, Pixels, Real, Whole

ProprioceptiveQuantity = Literal["velocity", "torque", "limits", "actuation"]
VestibularQuantity = Literal["accelerometer", "gyro"]
TouchQuantity = Literal["force_vector", "force_vector_global", "normal"]
TouchResponse = Literal["linear", "nearest"]
FoveationRadius = Literal["border", "corner", "edge"]


class ProprioceptionSpec(Model):
    """The sense of posture; joint angles are always in it."""

    include: Annotated[tuple[ProprioceptiveQuantity, ...], Distinct] = ("velocity", "torque", "limits", "actuation")
    """What is felt besides joint angles."""


class VestibularSpec(Model):
    """The sense of balance."""

    include: Annotated[tuple[VestibularQuantity, ...], Distinct, Field(min_length=1)] = ("accelerometer", "gyro")
    """What the inner ear feels: specific force (its otoliths), angular velocity (its canals), or both."""


class TouchSpec(Model):
    """The sense of touch, all over the skin."""

    density: Annotated[Real, Field(ge=0.1, le=10)] = 1.0
    """Skin points for each that an infant's two-point discrimination asks for."""
    quantity: TouchQuantity = "force_vector"
    """Force in the part's own frame, in the world's, or only the pressure."""
    response: TouchResponse = "linear"
    """Whether a contact is felt by the skin points around it, or by the nearest."""
    regions: Annotated[Groups, Field(min_length=1)] | None = None
    """Groups of muscles whose parts have skin, the head's under `neck`; left out, all of the body has."""


class AcuitySpec(Model):
    """Acuity as measured."""

    cpd: Annotated[CyclesPerDegree, Field(le=60)]
    """The finest grating seen."""


def _kind_of_acuity(value: Any) -> str | None:
    if isinstance(value, bool):
        return None
    kinds = ((str, "word"), (int, "months"), (float, "months"), (dict, "measured"), (AcuitySpec, "measured"))
    return next((kind for types, kind in kinds if isinstance(value, types)), None)


Acuity: TypeAlias = Annotated[
    Annotated[Literal["off", "age"], Tag("word")]
    | Annotated[Annotated[Months, Field(le=36)], Tag("months")]
    | Annotated[AcuitySpec, Tag("measured")],
    Discriminator(_kind_of_acuity),
]
"""Not blurred, as at the body's age, as at another age in months, or as measured."""


class VisionSpec(Model):
    """The sense of sight: a camera in each eye."""

    width_px: Annotated[Pixels, Field(le=2048)] = 64
    """Width of the picture."""
    height_px: Annotated[Pixels, Field(le=2048)] = 64
    """Height of the picture."""
    fovy_deg: Annotated[Degrees, Field(ge=1, le=170)] = 60.0
    """Vertical field of view."""
    acuity: Acuity = "age"
    """How fine the eyes see: `off`, `age` (that of the body), an age in months, or `{cpd: 4.2}`."""
    acuity_profile: Literal["tac2", "mayer1995", "mimo_v2"] = "tac2"
    """Whose measurements say how fine an age sees: Neijzen et al. 2025 on the Teller Acuity Cards' scale (the paper's
    source, pooled anew), Mayer et al. 1995, or the figures of MIMo v2."""
    foveation: Annotated[Real, Field(ge=0, le=1000)] = 0.0
    """How much finer the centre is than the rim, as s of the mapping r = R log(1 + s r'/R) / log(1 + s); 0 is even."""
    foveation_radius: FoveationRadius = "corner"
    """What the R of that mapping reaches to: the picture's corners (it is smooth, but the middles of the edges are cut
    off), its border along each ray (nothing is lost, but straight lines break at the diagonals), or the nearest edge
    (beyond it nothing is seen)."""
    supersample: Annotated[Whole, Field(ge=1, le=8)] = 1
    """How many times larger, in both directions, the picture is drawn and blurred before it is averaged down: a
    grating of f cycles a degree only shows in a picture of more than 2 f x fovy_deg pixels."""


class SensesSpec(Model):
    """The senses an infant has; one that is not named is off."""

    proprioception: ProprioceptionSpec | None = None
    """Posture."""
    vestibular: VestibularSpec | None = None
    """Balance."""
    touch: TouchSpec | None = None
    """Touch."""
    vision: VisionSpec | None = None
    """Sight."""
