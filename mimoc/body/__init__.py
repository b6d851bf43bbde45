"""From measurements to a body tree with masses and strengths."""

from mimoc.body.grow import grow
from mimoc.body.tree import FREE_JOINT, Body, BodyTree, Geom, Joint, Motor, Tendon

__all__ = ["FREE_JOINT", "Body", "BodyTree", "Geom", "Joint", "Motor", "Tendon", "grow"]
