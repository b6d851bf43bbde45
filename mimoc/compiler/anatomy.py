"""The anatomy in the manifest: names of the parts that the runtime and controllers use."""

from collections.abc import Iterator

from mimoc.body import BodyTree
from mimoc.body.regions import ARM, EYE, EYE_SIDES, HEAD, LEG, LIMB_SIDES, Ends
from mimoc.bundle.manifest import AnatomyEntry, EyeEntry, LimbEntry


def describe_anatomy(tree: BodyTree) -> AnatomyEntry:
    """Return the anatomy of a body for the manifest."""
    here = {body.name for body in tree.bodies}
    groups: dict[str, list[str]] = {}
    for joint, group in tree.muscle_groups.items():
        groups.setdefault(group, []).append(joint)
    return AnatomyEntry(
        head=HEAD if HEAD in here else None,
        trunk=tuple(body.name for body in tree.bodies if body.region == "trunk"),
        arms=tuple(_limbs(ARM, here)),
        legs=tuple(_limbs(LEG, here)),
        eyes=tuple(_eyes(here)),
        groups={group: tuple(joints) for group, joints in sorted(groups.items())},
    )


def _limbs(ends: Ends, here: set[str]) -> Iterator[LimbEntry]:
    for side in LIMB_SIDES:
        root, end = (name.format(side=side) for name in ends)
        if root in here:
            yield LimbEntry(side=side, root=root, end=end if end in here else None)


def _eyes(here: set[str]) -> Iterator[EyeEntry]:
    for side in EYE_SIDES:
        body, camera = (name.format(side=side) for name in EYE)
        if body in here:
            yield EyeEntry(side=side, body=body, camera=camera)
