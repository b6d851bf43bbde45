"""The anatomy in the manifest: names of the parts that the runtime and controllers use."""

from collections.abc import Iterator
from typing import Literal

from mimoc.body import BodyTree
from mimoc.bundle.manifest import AnatomyEntry, EyeEntry, LimbEntry

Side = Literal["left", "right"]
Ends = tuple[str, str]
"""Names of two things, with `{side}`."""

HEAD = "head"
ARM: Ends = ("{side}_upper_arm", "{side}_hand")
"""First and last body; fingers are parts of the hand."""
LEG: Ends = ("{side}_upper_leg", "{side}_foot")
"""First and last body; toes are parts of the foot."""
EYE: Ends = ("{side}_eye", "eye_{side}")
"""Body and camera."""

LIMB_SIDES: tuple[Side, Side] = ("right", "left")
EYE_SIDES: tuple[Side, Side] = ("left", "right")
"""Sides in MIMo's order."""


def describe_anatomy(tree: BodyTree) -> AnatomyEntry:
    """Return the anatomy of a body for the manifest."""
    bodies = {body.name for body in tree.bodies}
    groups: dict[str, list[str]] = {}
    for joint, group in tree.muscle_groups.items():
        groups.setdefault(group, []).append(joint)
    return AnatomyEntry(
        head=HEAD if HEAD in bodies else None,
        trunk=tuple(body.name for body in tree.bodies if body.region == "trunk"),
        arms=tuple(_limbs(ARM, bodies)),
        legs=tuple(_limbs(LEG, bodies)),
        eyes=tuple(_eyes(bodies)),
        groups={group: tuple(joints) for group, joints in sorted(groups.items())},
    )


def _limbs(ends: Ends, bodies: set[str]) -> Iterator[LimbEntry]:
    for side in LIMB_SIDES:
        root, end = (name.format(side=side) for name in ends)
        if root in bodies:
            yield LimbEntry(side=side, root=root, end=end if end in bodies else None)


def _eyes(bodies: set[str]) -> Iterator[EyeEntry]:
    for side in EYE_SIDES:
        body, camera = (name.format(side=side) for name in EYE)
        if body in bodies:
            yield EyeEntry(side=side, body=body, camera=camera)
