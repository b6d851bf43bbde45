"""A measure: how far apart the hands are."""

from dataclasses import dataclass

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.runtime.term import Term


@dataclass(frozen=True)
class HandsApart(Term):
    """Distance between both hands in lengths of the child, |x_left - x_right| / length, shape (k,)."""

    hands: np.ndarray  # Whole numbers: where to look, the same for all infants of a batch.
    length_m: np.ndarray  # Real numbers: how much, a row for each infant.

    def __call__(self, worlds, *args):
        """Return it for k infants."""
        xp = worlds.xp
        hands_m = xp.take(worlds.xpos, self.hands, axis=1)
        return xp.sqrt(xp.sum((hands_m[:, 0, :] - hands_m[:, 1, :]) ** 2, axis=-1)) / self.length_m[:, 0]


def bind(model, manifest):
    """Return the term of one infant."""
    hands = np.array([model.body(f"{side}_hand").id for side in ("left", "right")])
    return HandsApart(hands, np.array([manifest.child.length_cm / 100]))


HANDS_APART = Quantity(
    name="hands_apart_lengths",
    label="Distance between the hands",
    unit="lengths",
    about="mean distance between both hands, in lengths of the child",
    term=bind,
)
