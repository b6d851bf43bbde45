"""An endless floor."""

from mimoc.kinds import SceneKind

KIND = SceneKind(
    name="flat",
    about="An endless floor.",
    build="mimoc.scenes.flat.build",
    needs_footprint=False,
    varies=False,
)
