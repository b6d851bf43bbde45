"""The world around an infant: the kinds of scenes; one with options of its own is a folder."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import SceneKind

_IN = "mimoc.components.scenes"
SCENES: Kinds[SceneKind] = Kinds(
    "kind of scene",
    {
        "empty": SceneKind(
            name="empty",
            about="Nothing at all: no floor and no gravity.",
            build=f"{_IN}.empty",
            has_floor=False,
            needs_footprint=False,
            varies=False,
        ),
        "flat": SceneKind("flat", "An endless floor.", f"{_IN}.flat", needs_footprint=False, varies=False),
        "crib": SceneKind("crib", "A crib that fits the infant.", f"{_IN}.crib", varies=False),
        "room": f"{_IN}.room",
    },
)
