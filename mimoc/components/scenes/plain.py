"""Scenes without furniture: an endless floor, or nothing at all."""

from mimoc.compiler.looks.wallpaper import Wallpapers
from mimoc.compiler.mjcf.world import Ground, World
from mimoc.compiler.scenes import SUN, WEIGHTLESS, BuiltScene, Occupant
from mimoc.schema.scene import SceneSpec


def build_empty(spec: SceneSpec, occupant: Occupant, wallpapers: Wallpapers) -> BuiltScene:
    """Return a world without floor and gravity, in which the infant floats."""
    return BuiltScene(World(gravity_m_s2=WEIGHTLESS, lights=(SUN,)))


def build_flat(spec: SceneSpec, occupant: Occupant, wallpapers: Wallpapers) -> BuiltScene:
    """Return a floor at z = 0."""
    return BuiltScene(World(grounds=(Ground("floor", 0.0),), lights=(SUN,)))
