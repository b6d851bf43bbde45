"""A crib that fits the infant."""

from mimoc.schema.kinds import SceneKind

KIND = SceneKind(
    name="crib",
    about="A crib that fits the infant.",
    build="mimoc.components.scenes.crib.build",
    varies=False,
)
