"""An endless floor."""

from mimoc.compiler.looks.wallpaper import Wallpapers
from mimoc.compiler.mjcf.world import Ground, World
from mimoc.compiler.scenes.built_scene import SUN, BuiltScene, Occupant
from mimoc.schema.scene import SceneSpec


def build(spec: SceneSpec, occupant: Occupant, wallpapers: Wallpapers) -> BuiltScene:
    """Return a floor at z = 0."""
    return BuiltScene(World(grounds=(Ground("floor", 0.0),), lights=(SUN,)))
