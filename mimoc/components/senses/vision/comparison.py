"""Vision at several ages side by side: as drawn, blurred by acuity, foveated, and with all else that matures."""

from collections.abc import Sequence
from dataclasses import dataclass

from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.compiler.mjcf.sensor_sites import UNSEEN
from mimoc.components.senses.vision import VisionEntry, VisionSpec
from mimoc.components.senses.vision.build import PROFILES, acuity_at, is_given, maturity_of

SIDES = ("left", "right")
LAST_MONTH = 36.0  # Last age with known acuity.
ROWS = ("acuity", "acuity and foveation")  # What is compared, as in the paper (López et al. 2025, figure 3).
COMPARED = ("contrast", "colour", "field", "focus", "fovea")
"""What else of a sense can be seen in still pictures, if the sense has it."""
MATURED = "all that matures"
AS_DRAWN = "not blurred"
DEFAULT_FOVEATION = 5.0  # Foveation to show where the infant's own eyes have none.
SUPERSAMPLE = 2  # Draws edges smoothly, without another blur than that of acuity.


@dataclass(frozen=True, slots=True)
class Comparison:
    """Kinds of vision in rows and columns, with their captions."""

    entries: tuple[tuple[VisionEntry, ...], ...]
    rows: tuple[str, ...]
    columns: tuple[str, ...]


def compare_ages(
    vision: VisionSpec,
    side: str,
    ages_months: Sequence[float],
    size_px: int,
    *,
    profile: str | None = None,
    foveation: float | None = None,
) -> Comparison:
    """Return the vision of one eye, with a column for each age and one that is not blurred.

    Where the sense has contrast, colour, field, focus or fovea of an age, a row shows all of them together.

    Args:
        vision: Gives the profile of acuity and the foveation, unless others are given.
        side: left or right.
        ages_months: Ages of the eyes; the body stays the same.
        size_px: Width and height of each picture.
        profile: Source of acuity by age.
        foveation: Strength of the foveation.

    Raises:
        UnknownNameError: If there is no such side or profile.
    """
    profile = profile or vision.acuity_profile
    foveation = vision.foveation or DEFAULT_FOVEATION if foveation is None else foveation
    for kind, name, known in (("side", side, SIDES), ("profile of acuity", profile, PROFILES)):
        if name not in known:
            raise UnknownNameError(kind, name, known)
    sharp = _sharp(vision, side, size_px)
    acuities_cpd = [acuity_at(age_months, profile) for age_months in ages_months]
    captions = [
        f"{age_months:g} month{'s' * (age_months != 1)}: {acuity_cpd:.2g} cycles/degree"
        for age_months, acuity_cpd in zip(ages_months, acuities_cpd, strict=True)
    ]
    rows = {
        name: tuple(
            sharp.model_copy(update={"acuity_cpd": acuity_cpd, "foveation": float(strength)})
            for acuity_cpd in (*acuities_cpd, None)
        )
        for name, strength in zip(ROWS, (0, foveation), strict=True)
    }
    if any(is_given(vision, key) for key in COMPARED):
        wanted = vision.model_copy(update={"acuity": "age", "acuity_profile": profile})
        matured = [
            {"acuity_cpd": acuity_cpd, "foveation": vision.foveation, **maturity_of(wanted, age_months)}
            for acuity_cpd, age_months in zip(acuities_cpd, ages_months, strict=True)
        ]
        rows[MATURED] = (*(sharp.model_copy(update=fields) for fields in matured), sharp)
    return Comparison(tuple(rows.values()), tuple(rows), (*captions, AS_DRAWN))


def _sharp(vision: VisionSpec, side: str, size_px: int) -> VisionEntry:
    """Return an eye that sees all that is drawn."""
    return VisionEntry(
        cameras=(f"eye_{side}",),
        width_px=size_px,
        height_px=size_px,
        supersample=SUPERSAMPLE,
        acuity_cpd=None,
        foveation=0.0,
        foveation_radius=vision.foveation_radius,
        unseen=UNSEEN,
        body=vision.body,
    )


def read_ages(text: str) -> tuple[float, ...]:
    """Return the ages, in months, that a list such as `1,2.5,12` names.

    Raises:
        MimocError: If it names none, or one that acuity is not known for.
    """
    try:
        ages_months = tuple(map(float, text.split(",")))
    except ValueError:
        ages_months = ()
    if not ages_months or not all(0 <= age_months <= LAST_MONTH for age_months in ages_months):
        raise MimocError(f"'{text}' is not a list of ages; give months from 0 to {LAST_MONTH:g}, as in 1,2.5,12")
    return ages_months
