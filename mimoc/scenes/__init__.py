"""The world around an infant: the kinds of scenes, a folder each."""

from mimoc.base.kinds import Kinds, SceneKind

SCENES: Kinds[SceneKind] = Kinds(
    "kind of scene",
    {
        "empty": "mimoc.scenes.empty",
        "flat": "mimoc.scenes.flat",
        "crib": "mimoc.scenes.crib",
        "room": "mimoc.scenes.room",
    },
)
