"""Vision, with a camera in each eye."""

from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import Discriminator, Field, Tag, model_validator

from mimoc.base.kinds import AgeTable, SenseKind
from mimoc.delays import AGES_MONTHS
from mimoc.schema.base import Model, omitting
from mimoc.schema.entries import Amount, Body, Camera
from mimoc.schema.quantities import CyclesPerDegree, Degrees, Direction, Distinct, Months, Pixels, Real, Whole

FoveationRadius = Literal["border", "corner", "edge"]
Shown = Literal["skin", "solids"]
ContrastLaw = Literal["linear", "mimo3"]


class AcuitySpec(Model):
    """A measured visual acuity."""

    cpd: Annotated[CyclesPerDegree, Field(ge=0.01, le=60)]
    """Spatial frequency of the finest grating that is resolved."""


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
    Field(json_schema_extra={"wanted": "an acuity; write off, age, a number of months or {cpd: 4.2}"}),
]
"""Visual acuity: not limited, that of the infant's age, that of another age in months, or as measured."""


class VisionSpec(Model):
    """Vision, with a camera in each eye."""

    width_px: Annotated[Pixels, Field(le=2048)] = 64
    """Width of an image."""
    height_px: Annotated[Pixels, Field(le=2048)] = 64
    """Height of an image."""
    fovy_deg: Annotated[Degrees, Field(ge=1, le=170)] = 60.0
    """Vertical field of view."""
    acuity: Acuity = "age"
    """Visual acuity: `off` (not limited), `age` (that of the infant's age), an age in months, or `{cpd: 4.2}`."""
    acuity_profile: Literal["tac2", "mayer1995", "mimo_v2"] = "tac2"
    """Source of acuity by age: Neijzen et al. 2025 on the scale of the Teller Acuity Cards (`tac2`: the paper's source,
    pooled again), Mayer et al. 1995 (`mayer1995`), or the figures of MIMo v2 (`mimo_v2`)."""
    contrast: ContrastLaw = "linear"
    """Contrast that is left of a grating of f cycles per degree, with acuity a: 1 - f / a, equation 2 of the paper
    (`linear`), or the power law of MIMo3's code, (10 f) to the power of -2 / log10(10 a), from .01 to .99 (`mimo3`)."""
    foveation: Annotated[Real, Field(ge=0, le=1000)] = 0.0
    """Strength of foveation, s in the mapping r = R log(1 + s r'/R) / log(1 + s); 0 is uniform resolution."""
    foveation_radius: FoveationRadius = "corner"
    """Meaning of R in that mapping: distance to the corners (`corner`; smooth, but the middles of the edges are cut
    off), to the border along each ray (`border`; nothing is cut off, but straight lines have kinks at the diagonals),
    or to the nearest edge (`edge`; black beyond it)."""
    supersample: Annotated[Whole, Field(ge=1, le=8)] = 1
    """Factor by which an image is rendered and blurred larger, in both directions, before it is averaged down: a
    grating of f cycles per degree requires more than 2 f x fovy_deg rendered pixels."""
    body: Shown = "solids"
    """What the eyes see of infants: their `solids`, which are drawn faster, or the `skin` over them (`body.skin`)."""


class VisionEntry(Model):
    """Vision."""

    kind: Literal["vision"] = "vision"
    """Name of the sense."""
    cameras: Annotated[tuple[Camera, ...], *Distinct]
    """Cameras of the eyes, which are also the names of their observations."""
    width_px: Annotated[int, Field(ge=1, le=2048)]
    """Width of an image."""
    height_px: Annotated[int, Field(ge=1, le=2048)]
    """Height of an image."""
    supersample: Annotated[int, Field(ge=1, le=8)]
    """Factor by which an image is rendered larger before it is averaged down."""
    acuity_cpd: Annotated[float, Field(gt=0, le=60)] | None
    """Spatial frequency of the finest grating that is resolved, in cycles per degree; None if nothing is blurred."""
    acuity_shares: tuple[Annotated[Amount, Field(gt=0, le=1)], ...] = ()
    """Share of that acuity that each camera's eye has, if it is not all of it."""
    field_deg: dict[Direction, Annotated[Amount, Field(le=90)]] = Field(default_factory=dict)
    """How far the eyes see to a side of their line of sight, beyond which pictures are black, if not as far as these
    reach."""
    contrast: ContrastLaw = "linear"
    """Law of the contrast that is left of coarser gratings."""
    foveation: Annotated[Amount, Field(le=1000)]
    """Strength s of the foveation; 0 is none."""
    foveation_radius: FoveationRadius
    """Meaning of R in the foveation mapping."""
    unseen: tuple[Body, ...]
    """Bodies that are hidden from the eyes: the infant's own head."""
    body: Shown = "solids"
    """What the eyes see of infants: their skins, or the solids under these."""

    @model_validator(mode="after")
    def _each_eye_has_its_share(self) -> Self:
        if len(self.acuity_shares) not in (0, len(self.cameras)):
            raise ValueError(f"acuity_shares: {len(self.acuity_shares)} numbers for {len(self.cameras)} cameras")
        return self

    _serialized = omitting("acuity_shares", "field_deg")


KIND = SenseKind(
    name="vision",
    spec=VisionSpec,
    entry=VisionEntry,
    build="mimoc.senses.vision.build",
    run="mimoc.senses.vision.run",
    device="mimoc.runtime.device.vision.reader",
    organs=("left_eye", "right_eye"),
    physiological_delay=AgeTable(AGES_MONTHS, (245, 205, 115, 105, 105, 105)),
)
