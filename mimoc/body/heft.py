"""How hard it is to turn each joint, in whatever pose."""

from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import dist, hypot, sqrt

from mimoc.body.tree import Body, BodyTree, Geom, Vec3

ORIGIN = (0.0, 0.0, 0.0)

Children = Mapping[str | None, list[Body]]


def heaviest_inertias(tree: BodyTree) -> Mapping[str, float]:
    """Return an upper bound of the inertia about each joint over all poses, armature included, in [kg m²].

    All that hangs on a joint counts as if the limb were stretched out straight across its axis.
    """
    children: dict[str | None, list[Body]] = {}
    for body in tree.bodies:
        children.setdefault(body.parent, []).append(body)
    inertias: dict[str, float] = {}
    for body in tree.bodies:
        anchors = [joint.anchor_m for joint in body.joints]
        for index, joint in enumerate(body.joints):
            lumps = _lumps(body, anchors[index:], 0.0, children)
            inertias[joint.name] = joint.armature_kgm2 + sum(mass_kg * arm_m**2 for mass_kg, arm_m in lumps)
    return inertias


def _lumps(body: Body, way: list[Vec3], before_m: float, children: Children) -> Iterator[tuple[float, float]]:
    """Yield the masses of a body and of all that hangs on it, in [kg], and how far from a joint each can get, in [m].

    Args:
        body: Where to go on.
        way: Points of its frame that everything on it turns about, one after another.
        before_m: How far the first of them can be from the joint.
        children: Of each body.
    """
    before_m += sum(dist(here, there) for here, there in pairwise(way))
    for geom in body.geoms:
        yield geom.mass_kg, hypot(before_m + dist(way[-1], geom.pos_m), _gyration_m(geom))
    for child in children.get(body.name, ()):
        anchors = [ORIGIN, *(joint.anchor_m for joint in child.joints)]
        yield from _lumps(child, anchors, before_m + dist(way[-1], child.pos_m), children)


def _gyration_m(geom: Geom) -> float:
    """Return at least the radius of gyration about any axis through a geom's centre, from how far it reaches at most.

    A cube reaches x to each side and has x² 2/3; a disc has x² / 2, and all rounder or longer geoms have less.
    """
    if geom.type == "box":
        return max(geom.size_m) * sqrt(2 / 3)
    return sum(geom.size_m) * sqrt(1 / 2)
