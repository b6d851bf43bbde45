"""What is around the infant."""

from collections.abc import Callable, Mapping

from mimoc.scene.tree import Ground, Light, World

GRAVITY_M_S2 = (0.0, 0.0, -9.81)

_SUN = Light("sun", (1.2, -0.6, 3.0), (-0.4, 0.2, -1.0), (0.55, 0.55, 0.55), castshadow=True)


def empty_world() -> World:
    """Return nothing at all: the infant floats."""
    return World((0.0, 0.0, 0.0), (), (_SUN,))


def flat_world() -> World:
    """Return a floor at z = 0."""
    return World(GRAVITY_M_S2, (Ground("floor", 0.0),), (_SUN,))


WORLDS: Mapping[str, Callable[[], World]] = {"empty": empty_world, "flat": flat_world}
"""By kind of scene."""
