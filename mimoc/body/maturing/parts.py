"""What the law `maturing` changes in the tables of the body: head, neck and feet."""

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

from mimoc.body.assembly import Anatomy
from mimoc.body.figures import GeomFigures, Part

HEAD_MEASURES = ("head_circumference", "head_length", "head_breadth")
"""What the head's shape follows."""

HEAD_RULE = (
    "ellipsoid, half as long as head_length and half as broad as head_breadth, both x one factor, such that its level "
    "section has head_circumference; half as high as 1.15 x head_circumference / 2 pi, the crown as high as a round "
    "head's (D)"
)
EYE_RULE = "in the surface of the head"
NECK_RULE = "capsule from the shoulders up into the head, as thick in proportion to the head as MIMo's"
FOOT_RULE = (
    "; higher than MIMo's by the factor at which the average child's foot of that age weighs .062 + .0075 kg x age in "
    "months (mean of Sun & Jensen 1994 and Schneider & Zernicke 1992; M)"
)


@lru_cache(maxsize=16)
def matured(anatomy: Anatomy) -> Anatomy:
    """Return the anatomy by the law `maturing`.

    The head is an ellipsoid. The neck is a part of the head: published masses of segments count it with the head, and
    the joint between trunk and head, at its lower end, carries both. Feet are higher.
    """
    neck = next(geom for _, part in anatomy.parts for geom in part.geoms if geom.name == "neck")
    excluded = (*anatomy.excluded, *_ankles(anatomy))
    return replace(
        anatomy, parts=tuple((side, _matured(part, neck)) for side, part in anatomy.parts), excluded=excluded
    )


def _ankles(anatomy: Anatomy) -> Iterator[tuple[str, str]]:
    """Yield the pairs of bodies that higher feet bring together: the toes of stout newborns are below their shanks."""
    for side, part in anatomy.parts:
        if part.lies and part.parent == "{side}_foot":
            yield f"{side}_lower_leg", part.name.format(side=side)


def _matured(part: Part, neck: GeomFigures) -> Part:
    if part.lies:
        return replace(part, geoms=tuple(replace(geom, rule=geom.rule + FOOT_RULE) for geom in part.geoms))
    if part.name == "head":
        (head,) = part.geoms
        ellipsoid = replace(head, type="ellipsoid", follows=HEAD_MEASURES, rule=HEAD_RULE)
        return replace(part, geoms=(ellipsoid, replace(neck, rule=NECK_RULE)))
    if part.parent == "head":
        return replace(part, follows=HEAD_MEASURES, rule=EYE_RULE)
    return replace(part, geoms=tuple(geom for geom in part.geoms if geom.name != neck.name))
