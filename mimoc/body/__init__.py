"""The body: from measurements to a body tree with masses, joints and strengths."""

from mimoc.body.assembly import Anatomy, assemble
from mimoc.body.child import grow_child, measure_child
from mimoc.body.grow import grow, grow_reference
from mimoc.body.tree import FREE_JOINT, Body, BodyTree, Geom, Joint, Motor, Tendon

__all__ = [
    "FREE_JOINT",
    "Body",
    "Anatomy",
    "BodyTree",
    "Geom",
    "Joint",
    "Motor",
    "Tendon",
    "assemble",
    "grow",
    "grow_child",
    "grow_reference",
    "measure_child",
]
