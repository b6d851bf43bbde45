"""A body with the parts of MIMo's, in MIMo's order: chest and upper body of one piece, the head before the arms."""

from collections.abc import Iterator
from dataclasses import replace

from mimoc.body import Body, BodyTree

CHEST, UPPER_BODY, HEAD = "chest", "upper_body", "head"


def as_mimos(tree: BodyTree) -> BodyTree:
    """Return a body whose joints come in MIMo's order; a chest that has no joints is part of the upper body.

    It is the same body: every geom and joint is where it was, and weighs what it did.
    """
    return _head_first(_merge_chest(tree))


def _merge_chest(tree: BodyTree) -> BodyTree:
    chest = next(body for body in tree.bodies if body.name == CHEST)
    if chest.joints:
        return tree
    return replace(
        tree,
        bodies=tuple(_with_chest(body, chest) for body in tree.bodies if body is not chest),
        excluded=tuple(dict.fromkeys(_pairs_without_chest(tree))),
        merged=((CHEST, UPPER_BODY),),
    )


def _with_chest(body: Body, chest: Body) -> Body:
    """Return the upper body with the chest's geoms, what hangs on the chest hung on it, and others as they are."""
    if body.name == UPPER_BODY:
        geoms = (replace(geom, pos_m=_moved(geom.pos_m, chest)) for geom in chest.geoms)
        return replace(body, geoms=(*body.geoms, *geoms))
    if body.parent == CHEST:
        return replace(body, parent=UPPER_BODY, pos_m=_moved(body.pos_m, chest))
    return body


def _moved(pos_m: tuple[float, float, float], chest: Body) -> tuple[float, float, float]:
    """Return a place in the frame of the chest in that of the upper body; the chest is not turned."""
    x, y, z = (inner + outer for inner, outer in zip(pos_m, chest.pos_m, strict=True))
    return x, y, z


def _pairs_without_chest(tree: BodyTree) -> Iterator[tuple[str, str]]:
    for pair in tree.excluded:
        first, second = (UPPER_BODY if name == CHEST else name for name in pair)
        if first != second:
            yield first, second


def _head_first(tree: BodyTree) -> BodyTree:
    """Return the body with head and eyes right after the upper body."""
    heads = [body for body in tree.bodies if HEAD in (body.name, body.parent)]
    others = [body for body in tree.bodies if body not in heads]
    place = 1 + next(number for number, body in enumerate(others) if body.name == UPPER_BODY)
    return replace(tree, bodies=(*others[:place], *heads, *others[place:]))
