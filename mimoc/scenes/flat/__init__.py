"""An endless floor."""

from mimoc.base.kinds import SceneKind

KIND = SceneKind(
    name="flat",
    about="An endless floor.",
    build="mimoc.scenes.flat.build",
    needs_footprint=False,
    varies=False,
)
