"""The body: from measurements to a body tree with masses, joints and strengths."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mimoc.body.anatomy import assemble
    from mimoc.body.grow import GrownBody, grow_average, grow_body, grow_tree
    from mimoc.body.tree import FREE_JOINT, Body, BodyTree, Geom, Joint, Motor, Tendon

_HOMES = {
    **dict.fromkeys(("assemble",), "mimoc.body.anatomy"),
    **dict.fromkeys(("GrownBody", "grow_average", "grow_body", "grow_tree"), "mimoc.body.grow"),
    **dict.fromkeys(("FREE_JOINT", "Body", "BodyTree", "Geom", "Joint", "Motor", "Tendon"), "mimoc.body.tree"),
}
"""Imported when first used: the spec language reads the tables of parts, and grows no body."""

__all__ = [
    "FREE_JOINT",
    "Body",
    "BodyTree",
    "Geom",
    "GrownBody",
    "Joint",
    "Motor",
    "Tendon",
    "assemble",
    "grow_average",
    "grow_body",
    "grow_tree",
]


def __getattr__(name: str) -> Any:
    """Import a name from its home."""
    if name not in _HOMES:
        raise AttributeError(f"module 'mimoc.body' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)
