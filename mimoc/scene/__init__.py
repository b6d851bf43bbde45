"""From a body to everything that stands in the MJCF."""

from mimoc.scene.compose import compose
from mimoc.scene.furnish import Supplies, furnish, outline, set_stage
from mimoc.scene.stages import Stage
from mimoc.scene.tree import SceneTree

__all__ = ["SceneTree", "Stage", "Supplies", "compose", "furnish", "outline", "set_stage"]
