"""The body: from measurements to a body tree with masses, joints and strengths."""

from mimoc.body.tree import FREE_JOINT, Body, BodyTree, Geom, Joint, Motor, Tendon

__all__ = ["FREE_JOINT", "Body", "BodyTree", "Geom", "Joint", "Motor", "Tendon"]
