"""Quantities: one record for each thing that is measured, with its only name, label and unit."""

from collections.abc import Mapping

from mimoc.base.kinds import Registry
from mimoc.base.quantities import child, milestones, motion, movement, movement_details as details, outcome, reaching
from mimoc.base.quantities.quantity import Quantity

__all__ = ["QUANTITIES", "Quantity", "measured_in", "measures", "quantity_of"]

_OWN = (
    *(*child.CHILD, *milestones.MILESTONE_AGES.values(), motion.STABLE, motion.ENERGY, motion.BEYOND_LIMITS),
    *(outcome.RETURN, outcome.SUCCESS, outcome.TIME_TO_SUCCESS, outcome.EPISODES, motion.CONTACTS_SELF),
    *(motion.HIP_PATH, motion.HEAD_HEIGHT, motion.HEAD_LOWEST, motion.JOINT_SPEED, motion.UNSTABLE),
    *(motion.HAND_ERROR, motion.HAND_TARGETS, *motion.OF_EACH_HAND, motion.FELL_AFTER, *motion.BEHAVING),
    *(child.AGE, *outcome.CURVE),
    *(*movement.CORE, *details.DETAILS, *details.JOINTS),
    *reaching.OF_MOVEMENT,
)
"""In the order in which tables show them."""
QUANTITIES = Registry(Quantity, "quantity", _OWN)


def measures() -> Mapping[str, Quantity]:
    """Return the quantities that a cohort can measure, by name."""
    return {name: quantity for name, quantity in QUANTITIES.items() if quantity.steps}


def measured_in(step: str) -> list[Quantity]:
    """Return the quantities that are measured somewhere, such as in the step `run` of a cohort."""
    return [quantity for quantity in QUANTITIES.values() if step in quantity.steps]


UNITS = {"deg": "°", "m": "m", "n": "N", "nm": "N m", "s": "s", "weights": "body weights"}
"""Units of numbers that are no quantities of mimoc's, by the last word of their names."""


def quantity_of(name: str) -> Quantity:
    """Return a quantity; for the name of anything else, one that is called by this name's words, the last its unit."""
    if name in QUANTITIES:
        return QUANTITIES[name]
    words, _, unit = name.rpartition("_")
    label = words if words and unit in UNITS else name
    return Quantity(name, (label[:1].upper() + label[1:]).replace("_", " "), UNITS.get(unit, "") if words else "")
