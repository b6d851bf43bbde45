"""What can be asked of vision, and what the runtime must know of it."""

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Discriminator, Field, Tag

from mimoc.schema.base import Model
from mimoc.schema.quantities import CyclesPerDegree, Degrees, Months, Pixels, Real, Whole

FoveationRadius = Literal["border", "corner", "edge"]


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
    """Vision, with a camera in each eye."""

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


class VisionEntry(Model):
    """Vision."""

    kind: Literal["vision"] = "vision"
    """Which sense this is."""
    cameras: tuple[str, ...]
    """One for each eye; the pictures are observed under these names."""
    width_px: int
    """Width of a picture."""
    height_px: int
    """Height of a picture."""
    supersample: int
    """How many times larger it is drawn before it is averaged down."""
    acuity_cpd: float | None
    """Cycles per degree of the finest grating seen; None where nothing is blurred."""
    foveation: float
    """Strength s of the foveation; 0 is none."""
    foveation_radius: FoveationRadius
    """What its R reaches to."""
    unseen: tuple[str, ...]
    """Bodies that the eyes do not see: the infant's own head."""
