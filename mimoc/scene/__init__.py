"""From a body to everything that stands in the MJCF."""

from mimoc.scene.compose import compose
from mimoc.scene.tree import SceneTree

__all__ = ["SceneTree", "compose"]
