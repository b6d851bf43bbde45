"""The points of hands, head and eyes that Lucignolo's controllers move."""

from dataclasses import replace

from mimoc.mjcf.infant import Node, Site

PREFIX = "eef:"
RADIUS_M = 0.01
"""Only for looking at."""
FORWARD = (1.0, 0.0, 0.0)
BETWEEN_THE_EYES = 5 / 7
"""How far forward the head's point is, by the eyes' place (Lucignolo)."""


def with_effectors(node: Node) -> Node:
    """Return a body and all that hangs on it with these points: their z axis leaves the face, the eye or the palm."""
    return replace(
        node,
        sites=(*node.sites, *(_site(node.name, *place) for place in _places(node))),
        children=tuple(map(with_effectors, node.children)),
    )


def _site(body: str, pos_m: tuple[float, float, float], z_axis: tuple[float, float, float]) -> Site:
    return Site(PREFIX + body, pos_m, RADIUS_M, (("zaxis", z_axis),))


def _places(node: Node) -> list[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """Return place and z axis of the point on a body, if it has one."""
    if node.name in ("left_eye", "right_eye"):
        return [((0.0, 0.0, 0.0), FORWARD)]
    if node.name == "head":
        eyes = [child.pos_m for child in node.children if child.name.endswith("_eye")]
        return [((BETWEEN_THE_EYES * x, 0.0, z), FORWARD) for x, _, z in eyes[:1]]
    if node.name in ("left_hand", "right_hand"):
        palm, inwards = node.geoms[0], 1.0 if node.name == "left_hand" else -1.0
        x, y, z = palm.pos_m
        return [((x, y + inwards * palm.size_m[1], z), (0.0, inwards, 0.0))]
    return []
