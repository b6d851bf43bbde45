"""How full a body is at each age: heights above its solids, as smooth functions on the skin. Lengths are mm."""

from collections.abc import Mapping

import numpy as np
from fields import Array
from figure import Figure

from mimoc.body.kinematics import Frame

AGES_MONTHS = (0.0, 3.0, 6.0, 12.0, 24.0)


def arrays(verts: Array, figure: Figure, frames: Mapping[str, Frame]) -> dict[str, np.ndarray]:
    """Return what ships of fullness."""
    return {
        "ages_months": np.array(AGES_MONTHS),
        "fullness_100um": np.zeros((len(AGES_MONTHS), len(verts)), np.int8),
    }
