"""The head's skin of a child of any age and expression: between the ages that it was sculpted at, it changes evenly."""

from typing import NamedTuple

import numpy as np

from mimoc.base.geometry.meshes import normals_of
from mimoc.base.geometry.rotations import FloatArray
from mimoc.base.geometry.solvers import smoothstep
from mimoc.body.tree import BodyTree, half_axes
from mimoc.compiler.looks.sculpture import SculptedHair, SculptedHead

AT_EYE, BESIDE_EYE = 1.35, 3.0
"""Within so many radii of an eye the skin goes with the eyeball, and beyond so many it goes with the head."""
SIDES = (("right", 1.0), ("left", -1.0))
UPPER_LID_DEG, LOWER_LID_DEG = 40.0, -32.0
"""Elevation of the lids at the middle of an open eye, seen from the middle of the eyeball."""
CORNER_DEG = 63.0  # The corners of an eye to the side of its middle.
SHUT = (-0.30, 0.24)  # How far the lids of a missing eye are open, upper and lower, as shares of these.
OUTWARD = 0.45  # How much the eye's opening follows the slope of the head, from 0, straight ahead, to 1.
FADE_DEG = 48.0  # How far beyond the rims lids turn less and less.


def deform_head(sculpted: SculptedHead, tree: BodyTree, expression: str = "neutral") -> FloatArray:
    """Return the vertices of a child's head in the frame of its body, shape (n, 3), [m]."""
    geoms = tree.geoms
    head = geoms["head"]
    shape_m = _between_ages(sculpted, sculpted.at_ages_m, tree.age_months)
    upper, lower = _between_ages(sculpted, sculpted.lids, tree.age_months)
    moves_m = sculpted.moves_m.get(expression, 0.0)
    wide = sculpted.lids_by_expression.get(expression, np.ones(2))
    eyes = {body.name: np.array(body.pos_m) for body in tree.bodies}
    turned_m = shape_m + moves_m
    for side, sign in SIDES:
        shares = SHUT if f"{side}_eye" not in eyes else (upper * wide[0], lower * wide[1])
        eye_m = sculpted.eye_m * (1, sign, 1)
        outward = outward_of(eye_m, sculpted.half_axes_m)
        turned_m = turned_m + turned_lids(shape_m, eye_m, sculpted.eye_radius_m, outward, *shares)
    verts_m = turned_m * (np.array(half_axes(head)) / sculpted.half_axes_m)
    for side, sign in SIDES:
        if (place := eyes.get(f"{side}_eye")) is not None:
            # Vertices of which those near an eye are as far from its middle as they were sculpted, by its size.
            middle_m = sculpted.eye_m * (1, sign, 1)
            from_eye = turned_m - middle_m
            t = (BESIDE_EYE - np.linalg.norm(from_eye, axis=1) / sculpted.eye_radius_m) / (BESIDE_EYE - AT_EYE)
            near = smoothstep(t)[:, None]
            on_ball = (
                place - np.array(head.pos_m) + from_eye * (geoms[f"{side}_eye1"].size_m[0] / sculpted.eye_radius_m)
            )
            verts_m = verts_m + near * (on_ball - verts_m)
    return verts_m + np.array(head.pos_m)


def turned_lids(
    verts: FloatArray, middle: FloatArray, radius: float, outward: FloatArray, upper: float, lower: float
) -> FloatArray:
    """Return how vertices move with lids that are turned about an eyeball, shape (n, 3).

    Args:
        verts: With open lids, shape (n, 3).
        middle: Of the eyeball, shape (3,).
        radius: Of the eyeball, in the same unit.
        outward: See `outward_of`.
        upper: Elevation of the upper lid by that of an open one; below 0 it is turned below the middle.
        lower: The same of the lower lid.
    """
    from_eye = verts - middle
    far = np.linalg.norm(from_eye, axis=1)
    azimuth, elevation = seen_from_eye(from_eye, outward)
    above, below = rims_deg(azimuth)
    is_upper = elevation > 0
    rim = np.where(is_upper, above, -below)
    beyond = np.clip((np.abs(elevation) - rim) / FADE_DEG, 0, 1)
    turned = np.minimum(np.abs(elevation), rim) * (1 - smoothstep(beyond)) * np.where(is_upper, 1, -1)
    reach = smoothstep((1.95 - far / radius) / 0.75) * (from_eye[:, 0] > -0.2 * radius)
    turn = np.radians(turned * (np.where(is_upper, upper, lower) - 1) * reach)
    level = np.hypot(from_eye[:, 0], from_eye[:, 1])
    angle = np.arctan2(from_eye[:, 2], level) + turn
    along = far * np.cos(angle) / np.maximum(level, 1e-9)
    return np.column_stack((from_eye[:, :2] * along[:, None], far * np.sin(angle))) - from_eye


def rims_deg(azimuth_deg: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the elevations of the rims of open lids, upper and lower, by how far to the side of an eye's middle."""
    t = np.clip(np.abs(azimuth_deg) / CORNER_DEG, 0, 1)
    return UPPER_LID_DEG * (1 - t**2.4), LOWER_LID_DEG * (1 - t**2.0)


def seen_from_eye(from_eye: FloatArray, outward: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return azimuth and elevation of places as seen from an eye that looks *outward*, [deg], shape (n,)."""
    ahead = from_eye @ outward
    aside = from_eye @ np.array((-outward[1], outward[0], 0.0))
    return np.degrees(np.arctan2(aside, ahead)), np.degrees(np.arctan2(from_eye[:, 2], np.hypot(ahead, aside)))


def outward_of(eye: FloatArray, half_axes_of_head: FloatArray) -> FloatArray:
    """Return the level direction of the middle between the lids, (3,): a little less to the side than the head's slope.

    Args:
        eye: Its middle in the frame of the head's solid, shape (3,).
        half_axes_of_head: Half axes of the solid, shape (3,).
    """
    slope = np.array((eye[0] / half_axes_of_head[0] ** 2, eye[1] / half_axes_of_head[1] ** 2, 0))
    outward = OUTWARD * slope / np.linalg.norm(slope) + (1 - OUTWARD) * np.array((1.0, 0, 0))
    return outward / np.linalg.norm(outward)


def _between_ages(sculpted: SculptedHead, values: FloatArray, age_months: float) -> FloatArray:
    ages = sculpted.ages_months
    later = int(np.clip(np.searchsorted(ages, age_months), 1, len(ages) - 1))
    share = float(np.clip((age_months - ages[later - 1]) / (ages[later] - ages[later - 1]), 0, 1))
    return (1 - share) * values[later - 1] + share * values[later]


class Growth(NamedTuple):
    """The hair of one age; all figures are chosen by eye (D)."""

    months: float
    cover: float  # How much of the scalp it covers, 0 to 1.
    thick_mm: float  # How thick it lies, on a head of nine months.
    edge_deg: float  # Within how much of the hairline it becomes as dense as that.
    fringe: float  # How much of a fringe there is, 0 to 1.
    worn: float  # How much of it is rubbed off at the back of the head, 0 to 1.


GROWTH = (
    Growth(0, 0.22, 0.6, 12, 0.0, 0.0),
    Growth(3, 0.29, 0.7, 12, 0.0, 0.65),
    Growth(6, 0.42, 1.0, 12, 0.1, 0.50),
    Growth(9, 0.63, 1.7, 12, 0.25, 0.15),
    Growth(12, 0.82, 2.6, 12, 0.45, 0.0),
    Growth(18, 0.95, 4.6, 12, 0.8, 0.0),
    Growth(24, 1.0, 6.5, 12, 1.0, 0.0),
)
BARE, CLEAR = 0.05, 0.11
"""Shares of hair: up to the first, the layer is under the skin, and from the second on above it; up to there, its
picture is skin."""
SUNK_MM, MIN_MM = 0.9, 0.4  # How deep and how high it is there.
MARGIN = 0.06
"""Margin of the picture, as a share of its side: the picture is repeated beyond its borders, so that what is far away
looks a little like both."""


def hair_over(
    sculpted: SculptedHair, verts_m: FloatArray, age_months: float, size: float
) -> tuple[FloatArray, FloatArray]:
    """Return the vertices of the hair and their places in its picture, shapes (n, 2 or 3), [m].

    The vertices of the head can be in any frame; *size* is that of the head, by that of nine months.

    """
    share = density(sculpted, age_months)
    growth = growth_at(age_months)
    full = smoothstep(share / max(growth.cover, 1e-9))
    height_mm = MIN_MM + (growth.thick_mm - MIN_MM) * full
    above = smoothstep((share - BARE) / (CLEAR - BARE))
    height_m = size * (above * height_mm - (1 - above) * SUNK_MM) / 1000
    scalp_m = verts_m[sculpted.verts]
    outward = normals_of(scalp_m, sculpted.faces)
    places = MARGIN + (1 - 2 * MARGIN) * np.column_stack((sculpted.around, share))
    return scalp_m + height_m[:, None] * outward, places


def density(sculpted: SculptedHair, age_months: float) -> FloatArray:
    """Return how much hair there is at each vertex of the scalp, 0 to 1, shape (n,)."""
    growth = growth_at(age_months)
    within = sculpted.inside_deg[:, 0] + growth.fringe * sculpted.inside_deg[:, 1]
    return growth.cover * smoothstep(within / growth.edge_deg) * (1 - growth.worn * sculpted.worn)


def growth_at(age_months: float) -> Growth:
    """Return the hair of an age, between those of `GROWTH`.

    Example:
        >>> from mimoc.compiler.looks.head import growth_at
        >>> growth_at(24).cover
        1.0
    """
    table = np.array(GROWTH)
    return Growth(*(float(np.interp(age_months, table[:, 0], column)) for column in table.T))
