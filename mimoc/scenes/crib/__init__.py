"""A crib that fits the infant."""

from mimoc.base.kinds import SceneKind

KIND = SceneKind(
    name="crib",
    about="A crib that fits the infant.",
    build="mimoc.scenes.crib.build",
    varies=False,
)
