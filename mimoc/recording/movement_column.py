"""A movement column: one quantity of one infant at one time, with all that a stranger must know to use it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
WORLD = "world: x and y horizontal, z up; of the last physics step that was computed"
"""Frame and time of what follows from the positions of bodies; see `docs/movement_data.md`."""


@dataclass(frozen=True, slots=True)
class Column:
    """What a column says."""

    name: str  # Its name, which ends with its unit, such as `right_hand_speed_m_s`.
    unit: str  # Unit as people write it, such as `m/s`; empty for none.
    about: str  # What it is, in a few words.
    frame: str = WORLD  # In which axes, and of which moment.
    source: str = ""  # What defines it: a publication, a convention, or fields of MuJoCo's data.
    is_text: bool = False  # Whether it has names instead of numbers.

    @property
    def metadata(self) -> dict[str, str]:
        """What files say of it besides its name."""
        return {"unit": self.unit, "about": self.about, "frame": self.frame, "source": self.source}


class Values(NamedTuple):
    """The values of some columns at some times."""

    numbers: FloatArray  # Of the columns that have numbers, shape (times, columns).
    texts: Sequence[tuple[str, ...]] = ()
    """Of those that have names: for each time a tuple; none if there are no such columns."""


@dataclass(frozen=True, slots=True)
class Group:
    """Columns of one infant that are read together: copied at each time, computed for many times at once."""

    columns: tuple[Column, ...]  # Those of numbers first.
    values: Callable[[Sequence[FloatArray], Sequence[Any]], Values]
    """Computes them, given `fields` at all times, each with a leading axis of times, and what `moment` returned."""
    fields: tuple[FloatArray, ...] = ()  # Arrays of `MjData` that are copied at each time.
    moment: Callable[[], Any] | None = None  # Returns what else is kept of a time.


NO_COLUMNS = Group((), lambda fields, moments: Values(np.empty((0, 0))))  # What an infant has none of.
