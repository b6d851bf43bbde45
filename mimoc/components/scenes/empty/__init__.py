"""Nothing at all: no floor and no gravity."""

from mimoc.schema.kinds import SceneKind

KIND = SceneKind(
    name="empty",
    about="Nothing at all: no floor and no gravity.",
    build="mimoc.components.scenes.empty.build",
    has_floor=False,
    needs_footprint=False,
    varies=False,
)
