"""The head's skin of a child of any age: between the ages that it was sculpted at, its vertices move evenly."""

import numpy as np

from mimoc.body.head_surface import half_axes
from mimoc.body.tree import BodyTree, Geom
from mimoc.geometry.rotations import FloatArray
from mimoc.looks.skin.template_mesh import SculptedHead

AT_EYE, BESIDE_EYE = 1.35, 3.0
"""Within so many radii of an eye the skin goes with the eyeball, and beyond so many it goes with the head."""
SIDES = (("right", 1.0), ("left", -1.0))


def shape_at(sculpted: SculptedHead, age_months: float) -> FloatArray:
    """Return the vertices of a head of an age on the solid that it was sculpted on, shape (n, 3), [m]."""
    ages = sculpted.ages_months
    later = int(np.clip(np.searchsorted(ages, age_months), 1, len(ages) - 1))
    share = float(np.clip((age_months - ages[later - 1]) / (ages[later] - ages[later - 1]), 0, 1))
    return (1 - share) * sculpted.at_ages_m[later - 1] + share * sculpted.at_ages_m[later]


def deform_head(sculpted: SculptedHead, tree: BodyTree) -> FloatArray:
    """Return the vertices of a child's head in the frame of its body, shape (n, 3), [m]."""
    geoms = tree.geoms
    head = geoms["head"]
    shape_m = shape_at(sculpted, tree.age_months)
    verts_m = shape_m * (np.array(half_axes(head)) / sculpted.half_axes_m)
    eyes = {body.name: np.array(body.pos_m) for body in tree.bodies}
    for side, sign in SIDES:
        place = eyes.get(f"{side}_eye")
        if place is None:
            verts_m = verts_m + sculpted.closing_m[side] * (np.array(half_axes(head)) / sculpted.half_axes_m)
        else:
            verts_m = _around_eye(verts_m, shape_m, sculpted, head, sign, place, geoms[f"{side}_eye1"].size_m[0])
    return verts_m + np.array(head.pos_m)


def _around_eye(
    verts_m: FloatArray,
    shape_m: FloatArray,
    sculpted: SculptedHead,
    head: Geom,
    sign: float,
    place: FloatArray,
    radius_m: float,
) -> FloatArray:
    """Return vertices of which those near an eye are as far from its middle as they were sculpted, by its size."""
    middle_m = sculpted.eye_m * (1, sign, 1)
    from_eye = shape_m - middle_m
    t = (BESIDE_EYE - np.linalg.norm(from_eye, axis=1) / sculpted.eye_radius_m) / (BESIDE_EYE - AT_EYE)
    near = _smooth_step(t)[:, None]
    on_ball = place - np.array(head.pos_m) + from_eye * (radius_m / sculpted.eye_radius_m)
    return verts_m + near * (on_ball - verts_m)


def _smooth_step(t: FloatArray | float) -> FloatArray:
    """Return 0 for what is below 0, 1 for what is above 1, and what rises smoothly between."""
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)
