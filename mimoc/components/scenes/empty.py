"""Nothing at all: the infant floats."""

from mimoc.compiler.looks.wallpaper import Wallpapers
from mimoc.compiler.mjcf.world import World
from mimoc.compiler.scenes.built_scene import SUN, WEIGHTLESS, BuiltScene, Occupant
from mimoc.schema.scene import SceneSpec


def build(spec: SceneSpec, occupant: Occupant, wallpapers: Wallpapers) -> BuiltScene:
    """Return a world without floor and gravity."""
    return BuiltScene(World(gravity_m_s2=WEIGHTLESS, lights=(SUN,)))
