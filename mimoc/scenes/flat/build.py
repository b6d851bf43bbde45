"""An endless floor."""

from mimoc.looks.wallpaper import Wallpapers
from mimoc.mjcf.world import Ground, World
from mimoc.scenes.built_scene import SUN, BuiltScene, Occupant
from mimoc.scenes.spec import SceneSpec


def build(spec: SceneSpec, occupant: Occupant, wallpapers: Wallpapers) -> BuiltScene:
    """Return a floor at z = 0."""
    return BuiltScene(World(grounds=(Ground("floor", 0.0),), lights=(SUN,)))
