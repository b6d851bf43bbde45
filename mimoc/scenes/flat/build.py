"""An endless floor."""

from mimoc.mjcf.tree import Ground, World
from mimoc.scenes.setting import SUN, Decor, Occupant, Setting
from mimoc.scenes.spec import SceneSpec


def build(spec: SceneSpec, occupant: Occupant, decor: Decor) -> Setting:
    """Return a floor at z = 0."""
    return Setting(World(grounds=(Ground("floor", 0.0),), lights=(SUN,)))
