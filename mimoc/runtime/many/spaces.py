"""Spaces of what many infants observe."""

from collections.abc import Sequence

import numpy as np
from gymnasium import Space
from gymnasium.spaces import Box, Dict
from gymnasium.vector.utils import batch_differing_spaces, batch_space


def covering(spaces: Sequence[Dict]) -> Dict:
    """Return the space that holds what any of some infants observes: bounds may depend on strength, and so on age."""
    if all(space == spaces[0] for space in spaces):
        return spaces[0]
    return Dict({name: _covering([space[name] for space in spaces]) for name in spaces[0]})


def batch_of(spaces: Sequence[Dict]) -> Space:
    """Return the space of the observations of all infants, each within its own bounds."""
    if all(space == spaces[0] for space in spaces):
        return batch_space(spaces[0], len(spaces))
    return batch_differing_spaces(list(spaces))


def _covering(spaces: Sequence[Space]) -> Space:
    first = spaces[0]
    if not isinstance(first, Box):
        return first
    boxes = [space for space in spaces if isinstance(space, Box)]
    low, high = np.min([each.low for each in boxes], axis=0), np.max([each.high for each in boxes], axis=0)
    return Box(low, high, dtype=first.dtype.type)
