"""The skin of an infant as markers for a picture of it."""

import mujoco
import numpy as np

from mimoc.base.errors import RenderingError
from mimoc.bundle.io import Bundle
from mimoc.render.markers import Markers, force_markers
from mimoc.senses.binding import bind_sense


def skin_markers(bundle: Bundle, model: mujoco.MjModel, data: mujoco.MjData) -> Markers:
    """Return a marker for each point of an infant's skin, in the colour of the force on it.

    Raises:
        RenderingError: If the infant has no sense of touch.
    """
    entry = bundle.manifest.senses.touch
    if entry is None:
        raise RenderingError(
            f"'{bundle.manifest.name}' has no sense of touch, so no skin to show; "
            "add `senses: {touch: {}}` to its spec, and build it again"
        )
    state = bind_sense("touch", bundle, model).skin_state(data)
    by_body_m = {part.body: part.spacing_m for part in entry.skin}
    spacings_m = np.array([by_body_m[body] for body in state.bodies])
    return force_markers(state.positions, np.linalg.norm(state.forces, axis=1), spacings_m)
