"""The body: from measurements to a body tree with masses, joints and strengths."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mimoc.body.assembly import Anatomy, assemble
    from mimoc.body.child import grow_child, measure_child
    from mimoc.body.figures import MotorFigures
    from mimoc.body.growth import grow, grow_reference
    from mimoc.body.tree import FREE_JOINT, Body, BodyTree, Geom, Joint, Motor, Tendon

_HOMES = {
    "Anatomy": "mimoc.body.assembly",
    "Body": "mimoc.body.tree",
    "BodyTree": "mimoc.body.tree",
    "FREE_JOINT": "mimoc.body.tree",
    "Geom": "mimoc.body.tree",
    "Joint": "mimoc.body.tree",
    "Motor": "mimoc.body.tree",
    "MotorFigures": "mimoc.body.figures",
    "Tendon": "mimoc.body.tree",
    "assemble": "mimoc.body.assembly",
    "grow": "mimoc.body.growth",
    "grow_child": "mimoc.body.child",
    "grow_reference": "mimoc.body.growth",
    "measure_child": "mimoc.body.child",
}
"""Imported when first used: the spec language reads the tables of parts, and grows no body."""

__all__ = [
    "FREE_JOINT",
    "Body",
    "Anatomy",
    "BodyTree",
    "Geom",
    "Joint",
    "Motor",
    "MotorFigures",
    "Tendon",
    "assemble",
    "grow",
    "grow_child",
    "grow_reference",
    "measure_child",
]


def __getattr__(name: str) -> Any:
    """Import a name from its home."""
    if name not in _HOMES:
        raise AttributeError(f"module 'mimoc.body' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)
