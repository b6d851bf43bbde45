"""The arrays of a face: how far expressions move the vertices of the head's skin."""

import numpy as np

from mimoc.bundle.arrays import Array
from mimoc.bundle.face import MOVING, array_of
from mimoc.compiler.mjcf.skin import Skin


def face_arrays(skin: Skin | None) -> dict[str, Array]:
    """Return the arrays of a face by name: what any expression moves, and how far each moves it, in steps."""
    if skin is None or not skin.moves:
        return {}
    is_moved = np.any([steps.any(axis=1) for steps in skin.moves.values()], axis=0)
    arrays = {MOVING: np.flatnonzero(is_moved).astype(np.uint16)}
    arrays |= {array_of(name): steps[is_moved] for name, steps in skin.moves.items()}
    for array in arrays.values():
        array.flags.writeable = False
    return arrays
