"""Vision, with a camera in each eye."""

from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import Discriminator, Field, Tag, model_validator

from mimoc.schema.base import Model, omitting
from mimoc.schema.entries import Amount, Body, Camera
from mimoc.schema.kinds import AGES_MONTHS, AgeTable, SenseKind
from mimoc.schema.quantities import CyclesPerDegree, Degrees, Direction, Distinct, Months, Pixels, Real, Whole

FoveationRadius = Literal["border", "corner", "edge"]
Shown = Literal["skin", "solids"]
ContrastLaw = Literal["linear", "mimo3", "threshold"]
MaturityWord = Literal["off", "age", "adult"]


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

CSF_EXPONENT = 0.82
"""p of the template of contrast sensitivity, S (x e^(1-x))^p with x = f / peak: derived such that adults, who see best
250 at 4 cycles per degree, see up to 40."""
OLDEST_MONTHS = 36.0  # Last age that what follows age can be given.


def _kind_of_maturity(value: Any) -> str | None:
    if isinstance(value, str):
        return "word"
    return "months" if isinstance(value, int | float) and not isinstance(value, bool) else None


MaturityMonths: TypeAlias = Annotated[Annotated[Months, Field(le=OLDEST_MONTHS)], Tag("months")]
Maturity: TypeAlias = Annotated[
    Annotated[MaturityWord, Tag("word")] | MaturityMonths,
    Discriminator(_kind_of_maturity),
    Field(json_schema_extra={"wanted": "how mature it is; write off, age, adult or a number of months"}),
]
"""How mature something is: not limited at all, as at the infant's age, as an adult's, or as at an age in months."""
Contrast: TypeAlias = Annotated[
    Annotated[Literal["linear", "mimo3", "off", "age", "adult"], Tag("word")] | MaturityMonths,
    Discriminator(_kind_of_maturity),
    Field(
        json_schema_extra={"wanted": "a law of contrast; write linear, mimo3, off, age, adult or a number of months"}
    ),
]
"""What is lost of contrast: a share of it (`linear`, `mimo3`), or what is below the threshold of an age or an adult."""


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
    contrast: Contrast = "linear"
    """Contrast that is left of a grating of f cycles per degree, with acuity a: 1 - f / a, equation 2 of the paper
    (`linear`), or the power law of MIMo3's code, (10 f) to the power of -2 / log10(10 a), from .01 to .99 (`mimo3`);
    or contrast is lost below the threshold of the infant's age (`age`), of an age in months, or of an `adult`, and
    nothing finer than the acuity is seen. `off` has no threshold: it is `linear`."""
    colour: Maturity | None = None
    """Colour vision: `off`, `age` (the infant's), `adult`, or that of an age in months: colours below the threshold of
    purity are grey, others paler, and finer than half of the acuity there are none."""
    field: Maturity | None = None
    """Field within which things are noticed: `off` (all of the picture), `age`, `adult`, or that of an age in months;
    beyond it, pictures fade to their mean."""
    focus: Maturity | None = None
    """Accommodation: `off` (all is in focus), `age`, `adult`, or that of an age in months. Until four months, what is
    nearer or farther than 25 cm is out of focus."""
    vergence: Maturity | None = None
    """How far the policy `look_at` turns both eyes to one point: `off` and `adult` (wholly), `age`, or an age in
    months; until three months not at all: they stay parallel."""
    fovea: Maturity | None = None
    """Maturity of the fovea, which lessens `foveation`: `off` and `adult` (all of it), `age`, or an age in months."""
    flicker: Maturity | None = None
    """How fast changes can be seen: `off`, `age`, `adult`, or that of an age in months: a low-pass filter over time."""
    foveation: Annotated[Real, Field(ge=0, le=1000)] = 0.0
    """Strength of foveation, s in the mapping r = R log(1 + s r'/R) / log(1 + s); 0 is uniform resolution."""
    foveation_radius: FoveationRadius = "corner"
    """Meaning of R in that mapping: distance to the corners (`corner`; smooth, but the middles of the edges are cut
    off), to the border along each ray (`border`; nothing is cut off, but straight lines have kinks at the diagonals),
    or to the nearest edge (`edge`; black beyond it)."""
    supersample: Annotated[Whole, Field(ge=1, le=8)] = 1
    """Factor by which an image is rendered and blurred larger, in both directions, before it is averaged down: a
    grating of f cycles per degree requires more than 2 f x fovy_deg rendered pixels."""
    body: Shown | None = None
    """What the eyes see of infants: the `skin`, or the `solids` under it. By default the skin of those that have one
    (`body.skin`), but solids on a device, which draws no skins, and by the law `published`, as in MIMo."""


MATURING = (
    *("sensitivity", "sensitivity_peak_cpd", "purity_threshold", "chroma_gain", "noticed_deg"),
    *("unfocused", "focus_depth_dioptres", "vergence", "flicker_hz"),
)
"""Fields of an entry that say how mature an eye is, but for its acuity; left out where nothing is limited."""


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
    sensitivity: Annotated[Amount, Field(gt=0)] | None = None
    """Largest contrast sensitivity, of the law `threshold`: 1 over the least contrast that is seen."""
    sensitivity_peak_cpd: Annotated[Amount, Field(gt=0, le=60)] | None = None
    """Spatial frequency of that, in cycles per degree, of an eye with all of the acuity."""
    purity_threshold: Annotated[Amount, Field(le=1)] | None = None
    """Purity below which colours are grey; None if colours are limited by acuity only."""
    chroma_gain: Annotated[Amount, Field(le=1)] = 1.0
    """Share that is left of the chroma of other colours."""
    noticed_deg: Annotated[Amount, Field(gt=0, le=90)] | None = None
    """Angle from the line of sight up to which things are noticed; None if all of the picture is."""
    unfocused: Annotated[Amount, Field(le=1)] = 0.0
    """Share of the distance in dioptres from what is at 25 cm by which eyes are out of focus."""
    focus_depth_dioptres: Annotated[Amount, Field(le=10)] = 0.0
    """Defocus that blurs nothing, taken off all others."""
    vergence: Annotated[Amount, Field(le=1)] = 1.0
    """How far both eyes turn to one point: 0 is not at all, so that they stay parallel."""
    flicker_hz: Annotated[Amount, Field(gt=0)] | None = None
    """Frequency from which on changes are lost, of a low-pass filter of first order; None if none are."""
    foveation: Annotated[Amount, Field(le=1000)]
    """Strength s of the foveation; 0 is none."""
    foveation_radius: FoveationRadius
    """Meaning of R in the foveation mapping."""
    unseen: tuple[Body, ...]
    """Bodies that are hidden from the eyes: the infant's own head."""
    body: Shown | None = "solids"
    """What the eyes see of infants: their skins, or the solids under these. None is the skins of those that have some,
    where skins can be drawn; a device draws solids then. Bundles from before there were skins do not say."""

    @model_validator(mode="after")
    def _each_eye_has_its_share(self) -> Self:
        if len(self.acuity_shares) not in (0, len(self.cameras)):
            raise ValueError(f"acuity_shares: {len(self.acuity_shares)} numbers for {len(self.cameras)} cameras")
        if (self.contrast == "threshold") != bool(self.sensitivity and self.sensitivity_peak_cpd):
            raise ValueError("sensitivity, sensitivity_peak_cpd: they belong to the contrast law 'threshold'")
        return self

    _serialized = omitting("acuity_shares", "field_deg", *MATURING)


KIND = SenseKind(
    name="vision",
    spec=VisionSpec,
    entry=VisionEntry,
    build="mimoc.components.senses.vision.build",
    run="mimoc.components.senses.vision.run",
    device="mimoc.components.senses.vision.device",
    organs=("left_eye", "right_eye"),
    physiological_delay=AgeTable(AGES_MONTHS, (245, 205, 115, 105, 105, 105)),
)
