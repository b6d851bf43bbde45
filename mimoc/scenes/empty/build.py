"""Nothing at all: the infant floats."""

from mimoc.looks.wallpaper import Wallpapers
from mimoc.mjcf.world import World
from mimoc.scenes.built_scene import SUN, WEIGHTLESS, BuiltScene, Occupant
from mimoc.scenes.spec import SceneSpec


def build(spec: SceneSpec, occupant: Occupant, wallpapers: Wallpapers) -> BuiltScene:
    """Return a world without floor and gravity."""
    return BuiltScene(World(gravity_m_s2=WEIGHTLESS, lights=(SUN,)))
