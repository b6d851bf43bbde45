"""The world around an infant: the kinds of scenes, a folder each."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import SceneKind

SCENES: Kinds[SceneKind] = Kinds(
    "kind of scene",
    {
        "empty": "mimoc.components.scenes.empty",
        "flat": "mimoc.components.scenes.flat",
        "crib": "mimoc.components.scenes.crib",
        "room": "mimoc.components.scenes.room",
    },
)
