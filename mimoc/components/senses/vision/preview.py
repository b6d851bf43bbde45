"""What an infant in a pose sees, with several kinds of vision, such as those of several ages side by side.

Those are: as drawn, blurred by acuity, foveated, and with all else that matures.
"""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_posed, prefixed
from mimoc.bundle.world import WorldBundle, load_world_model
from mimoc.compiler.mjcf.sensor_sites import UNSEEN
from mimoc.components.senses.vision import VisionEntry, VisionSpec
from mimoc.components.senses.vision.build import PROFILES, acuity_at, is_given, maturity_of
from mimoc.components.senses.vision.eyes import Eyes
from mimoc.components.senses.vision.run import perceive_view

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


FloatArray = npt.NDArray[np.float64]

OWN = ("right_hand", "left_hand", "right_foot", "left_foot")  # Bodies that the eye looks at if it sees no toys.
DOWN_DEG = 50.0  # How far it looks down if it sees none of these either.
AHEAD = 0.5  # Cosine of 60°, the largest angle from straight ahead at which it looks at something.
BLANK_RANGE = 26
"""Difference of the most and the least level of a channel, of 256: a view with no more is a plain square to the eye.

Measured on 888 unblurred views of infants of 0 to 18 months in all poses, on a flat floor, in empty space, in cribs and
in rooms with and without toys, gazes of 60 degrees up to 80 down, fields of view of 18 to 60 degrees. Sky, mat, and
their own skin from near by go over 0 to 16 levels, wallpapers and carpets from near by over up to 19; the least of all
others are 36 (the edge of a shadow), 43 (a horizon), 57 (a panelled ceiling), and hands, feet and toys 60 and more.
"""
SPLINTERS = 1.0  # Per cent of the pixels that do not count, such as a hair or the tip of a finger in a corner.


def preview(
    bundle: Bundle,
    entries: Sequence[Sequence[VisionEntry]],
    pose: str | None = None,
    down_deg: float | None = None,
    fovy_deg: float | None = None,
    world: WorldBundle | None = None,
) -> list[list[npt.NDArray[np.uint8]]]:
    """Return one and the same view through each of some kinds of vision, shape (height, width, 3) each.

    Args:
        bundle: The infant, perhaps one of a world; it need not have a sense of vision.
        entries: Kinds of vision, in rows; all of one eye, size and supersampling.
        pose: Another than the bundle's own.
        down_deg: Angle of the gaze below straight ahead; without it, the eye looks at the toy that it sees best, or if
            it sees none at another infant's face, or at a hand or a foot.
        fovy_deg: Vertical field of view, if it is not the eye's own.
        world: The world that it is in, as all start there.

    Raises:
        UnknownNameError: If the infant has no such pose or no such eye.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_posed(bundle, pose) if world is None else _posed_world(world)
    entries = [[prefixed(entry, bundle.manifest.prefix) for entry in row] for row in entries]
    first = entries[0][0]
    (name,) = first.cameras
    cameras = [model.camera(index).name for index in range(model.ncam)]
    if name not in cameras:
        raise UnknownNameError("camera of this infant", name, cameras)
    camera = data.camera(name)
    world_from_eye = camera.xmat.reshape(3, 3).copy()
    # The rotation of an eye that has turned to a gaze, nine numbers; its horizontal stays level.
    gaze = _gaze(bundle, world, data, camera.xpos, world_from_eye, down_deg)
    back = -gaze / np.linalg.norm(gaze)
    across = world_from_eye[:, 0] - world_from_eye[:, 0] @ back * back
    across /= np.linalg.norm(across)
    camera.xmat = np.stack([across, np.cross(back, across), back], axis=1).ravel()
    if fovy_deg is not None:
        model.camera(name).fovy = fovy_deg
    size_px = first.supersample * first.width_px, first.supersample * first.height_px
    with closing(Eyes(model, first.cameras, *size_px, first.unseen, first.body or "skin")) as eyes:
        view = eyes.view(data)
    return [[perceive_view(view, entry, eyes.fovy_deg)[0] for entry in row] for row in entries]


def _posed_world(world: WorldBundle) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = load_world_model(world)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(world.manifest.pose).id)
    mujoco.mj_forward(model, data)
    return model, data


def is_blank(picture: npt.NDArray[np.uint8]) -> bool:
    """Return whether a view shows nothing: but for SPLINTERS, no channel of it goes over more than BLANK_RANGE."""
    least, most = np.percentile(picture, (SPLINTERS / 2, 100 - SPLINTERS / 2), axis=(0, 1))
    return bool((most - least).max() <= BLANK_RANGE)


def _gaze(
    bundle: Bundle,
    world: WorldBundle | None,
    data: mujoco.MjData,
    eye_m: FloatArray,
    world_from_eye: FloatArray,
    down_deg: float | None,
) -> FloatArray:
    _, up, back = world_from_eye.T
    toys = {toy.body: toy.size_m for toy in (world or bundle).manifest.toys}
    others = (
        [infant.manifest.anatomy.head for infant in world.infants.values() if infant is not bundle] if world else []
    )
    faces = dict.fromkeys((head for head in others if head), 1.0)
    own = [bundle.manifest.prefix + body for body in OWN]
    limbs = [body for body in own if mujoco.mj_name2id(data.model, mujoco.mjtObj.mjOBJ_BODY, body) >= 0]
    for sizes_m in () if down_deg is not None else (toys, faces, dict.fromkeys(limbs, 1.0)):
        offsets_m = {body: data.body(body).xipos - eye_m for body in sizes_m}
        angles = {body: sizes_m[body] / float(np.linalg.norm(offset_m)) for body, offset_m in offsets_m.items()}
        seen = [body for body, offset_m in offsets_m.items() if -(offset_m @ back) > AHEAD * np.linalg.norm(offset_m)]
        if seen:
            return offsets_m[max(seen, key=angles.__getitem__)]
    angle = np.radians(DOWN_DEG if down_deg is None else down_deg)
    return -np.cos(angle) * back - np.sin(angle) * up
