"""Nothing at all: the infant floats."""

from mimoc.mjcf.tree import World
from mimoc.scenes.setting import SUN, WEIGHTLESS, Decor, Occupant, Setting
from mimoc.scenes.spec import SceneSpec


def build(spec: SceneSpec, occupant: Occupant, decor: Decor) -> Setting:
    """Return a world without floor and gravity."""
    return Setting(World(gravity_m_s2=WEIGHTLESS, lights=(SUN,)))
