"""An endless floor."""

from mimoc.schema.kinds import SceneKind

KIND = SceneKind(
    name="flat",
    about="An endless floor.",
    build="mimoc.components.scenes.flat.build",
    needs_footprint=False,
    varies=False,
)
