"""Pairs: contacts of walls and ceiling with all that moves, listed one by one.

MuJoCo looks for contacts between two bodies in a tree of boxes as soon as one of them has several geoms. The world is
one body, the boxes of planes are infinite, and so the tree of a whole room costs 5 to 8 % of a physics step and finds
nothing. A listed pair bypasses the tree and costs a hundredth of a microsecond; contact bits of zero keep walls out.
"""

from collections.abc import Iterable, Iterator, Sequence

from mimoc.geometry.rotations import Vec3
from mimoc.mjcf.constraints import Pair
from mimoc.mjcf.furniture import SOLID, WorldGeom
from mimoc.mjcf.infant import Node, PrintedGeom
from mimoc.mjcf.objects import ObjectGeom
from mimoc.mjcf.world import World


def barrier_pairs(world: World, roots: Sequence[Node]) -> tuple[Pair, ...]:
    """Return the contacts that barriers have with an infant and with what else moves, as if contact bits allowed them.

    Args:
        world: What is around the infant.
        roots: The infant.
    """
    of_objects = (geom for item in world.objects for geom in item.geoms)
    moving = [geom for geom in (*_geoms(roots), *of_objects) if SOLID & (geom.contype | geom.conaffinity)]
    barriers = (geom for geom in world.furniture.geoms if geom.barrier)
    return tuple(_pair(barrier, geom) for barrier in barriers for geom in moving)


def _geoms(nodes: Iterable[Node]) -> Iterator[PrintedGeom]:
    for node in nodes:
        yield from node.geoms
        yield from _geoms(node.children)


def _pair(barrier: WorldGeom, geom: PrintedGeom | ObjectGeom) -> Pair:
    """Return a contact with what MuJoCo mixes of two geoms that are equally soft."""
    sliding, spinning, rolling = _larger(barrier.friction, geom.friction)
    return Pair(
        geom1=barrier.name,
        geom2=geom.name,
        condim=max(barrier.condim, geom.condim),
        friction=(sliding, sliding, spinning, rolling, rolling),
        solref=barrier.solref,
        solimp=barrier.solimp,
    )


def _larger(left: Vec3, right: Vec3) -> Vec3:
    x, y, z = map(max, left, right)
    return x, y, z
