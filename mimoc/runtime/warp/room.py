"""How much room there is for contacts and constraints, when it grows, and how far."""

import math
from dataclasses import dataclass

from mimoc.runtime.warp.capacity import Capacity
from mimoc.runtime.warp.overflow import COUNTS, FLAGS, OWN, PAIRS, ROWS, SHARED
from mimoc.senses.sense import IntArray

FULL = 0.8
"""Share of the room from which on it grows, mostly before anything is lost."""
GROWTH = 1.5
"""Factor between what was needed, or what was there if that is more, and the new room."""
RARE = 0.01
"""Share of the infants that may lose contacts in a control step when the room cannot grow; they begin anew."""


@dataclass(slots=True)
class Room:
    """The room in each of some worlds."""

    present: Capacity
    largest: Capacity
    """How far it grows."""
    worlds: int

    def after(self, report: IntArray) -> Capacity:
        """Return the room for the next control step, from the report of one."""
        pairs = math.ceil(report[PAIRS] / self.worlds)
        return Capacity(
            _next(self.present.contacts, self.largest.contacts, pairs, _is_short(report, SHARED)),
            _next(self.present.constraints, self.largest.constraints, int(report[ROWS]), _is_short(report, OWN)),
        )


def _is_short(report: IntArray, flags: tuple[str, ...]) -> bool:
    """Return whether one of some flags was set."""
    return any(report[COUNTS + FLAGS[name]] for name in flags)


def _next(present: int, largest: int, needed: int, is_short: bool) -> int:
    if not is_short and needed <= FULL * present:
        return present
    return max(present, min(math.ceil(GROWTH * max(present, needed)), largest))
