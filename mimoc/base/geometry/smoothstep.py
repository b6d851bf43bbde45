"""A step whose corners are rounded."""

import numpy as np

from mimoc.base.geometry.rotations import FloatArray


def smoothstep(t: FloatArray) -> FloatArray:
    """Return 0 where *t* is below 0, 1 where it is above 1, and t² (3 - 2 t) between.

    Example:
        >>> import numpy as np
        >>> from mimoc.base.geometry.smoothstep import smoothstep
        >>> smoothstep(np.array([-1.0, 0.25, 0.5, 2.0])).tolist()
        [0.0, 0.15625, 0.5, 1.0]
    """
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)
