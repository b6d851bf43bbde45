"""From a body to everything that stands in the MJCF."""

from mimoc.scene.compose import compose
from mimoc.scene.furnish import Supplies, furnish, outline
from mimoc.scene.tree import SceneTree

__all__ = ["SceneTree", "Supplies", "compose", "furnish", "outline"]
