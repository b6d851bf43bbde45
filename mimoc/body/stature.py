"""Length, weight, head and arm circumference of a body, for comparison with growth standards."""

from typing import TypedDict

import numpy as np

from mimoc.body.kinematics import pose
from mimoc.body.tree import BodyTree, Geom
from mimoc.geometry.primitives import girth
from mimoc.units import m_to_cm


class Stature(TypedDict):
    """Measures for which there are WHO standards, with the names of `fits.tables.WHO_FILES`."""

    length_cm: float
    weight_kg: float
    head_circumference_cm: float
    arm_circumference_cm: float | None
    """None for a child without upper arms."""


def stature(tree: BodyTree) -> Stature:
    """Return the measures of a body: length is crown to sole, and the left arm is preferred, as WHO does."""
    arm_cm = _arm_circumference_cm(tree)
    return Stature(
        length_cm=m_to_cm(length_m(tree)),
        weight_kg=tree.mass_kg,
        head_circumference_cm=m_to_cm(_girth_m(tree.geoms["head"])),
        arm_circumference_cm=arm_cm,
    )


def length_m(tree: BodyTree) -> float:
    """Return the length of a body from crown to sole, in [m]."""
    posed, up = pose(tree, {}), np.array([0.0, 0.0, 1.0])
    return posed.extent(up) + posed.extent(-up)


def _arm_circumference_cm(tree: BodyTree) -> float | None:
    arms = [tree.geoms[name] for name in ("left_uarm1", "right_uarm1") if name in tree.geoms]
    return m_to_cm(_girth_m(arms[0])) if arms else None


def _girth_m(geom: Geom) -> float:
    return girth(geom.type, geom.size_m)
