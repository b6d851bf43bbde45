"""The parts that bodies are assembled from: MIMo's, and others' by the entry points `mimoc.parts`."""

from mimoc.anatomy.part import PartKind
from mimoc.anatomy.parts import arm, feet, five_finger, head, leg, mitten, trunk
from mimoc.base.kinds import Kinds

PARTS: Kinds[PartKind] = Kinds("body part", {kind.name: kind for kind in (mitten.KIND, five_finger.KIND)})
"""What a spec can choose or add."""

TRUNK, ARM, HEAD, EYES, LEG = trunk.KIND, arm.KIND, head.KIND, head.EYES, leg.KIND
FLAT_FEET, TWO_TOED_FEET = (feet.FLAT, feet.FLAT), (feet.RIGHT_TWO_TOED, feet.LEFT_TWO_TOED)


def kinds_of_hands() -> tuple[str, ...]:
    """Return the hands that an infant can have, MIMo's first."""
    return tuple(name for name, kind in PARTS.items() if kind.replaces == "hands")


def extra_kinds() -> tuple[str, ...]:
    """Return the parts that an infant can have besides MIMo's."""
    return tuple(name for name, kind in PARTS.items() if kind.replaces is None)


def feet_of(hands: str) -> tuple[PartKind, PartKind]:
    """Return the right and the left foot of an infant with hands of some kind."""
    return TWO_TOED_FEET if hands == five_finger.KIND.name else FLAT_FEET
