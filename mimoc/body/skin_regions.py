"""The regions of the skin, by which pain is felt and receptors differ: head, trunk, arms, hands, legs, feet."""

from collections.abc import Mapping

from mimoc.body.tree import BodyTree
from mimoc.schema.names import SIDES

BEGINS: Mapping[str, str] = {
    part.format(side=side): region.format(side=side)
    for side in SIDES
    for part, region in (
        ("{side}_upper_arm", "{side}_arm"),
        ("{side}_hand", "{side}_hand"),
        ("{side}_upper_leg", "{side}_leg"),
        ("{side}_foot", "{side}_foot"),
    )
}
"""The region that begins with a body, and ends where another begins."""
PALMS_AND_SOLES = frozenset(region for body, region in BEGINS.items() if body.endswith(("hand", "foot")))
"""Regions that count as smooth skin, without hair."""


def region_of_bodies(body: BodyTree) -> dict[str, str]:
    """Return the region of each body by name; parts that no child has are regions of their own names."""
    regions: dict[str, str] = {}
    for part in body.bodies:
        former = regions.get(part.parent or "", "trunk")
        if part.region != "limb":
            regions[part.name] = part.region
        else:
            regions[part.name] = BEGINS.get(part.name, part.name if former == "trunk" else former)
    return regions
