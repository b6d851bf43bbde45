"""A crib that fits the infant."""

from mimoc.kinds import SceneKind

CRIB = SceneKind(
    name="crib",
    about="A crib that fits the infant.",
    build="mimoc.scenes.crib.build",
    varies=False,
)
