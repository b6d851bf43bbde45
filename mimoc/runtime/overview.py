"""Pictures of a whole scene: an infant among its toys."""

from contextlib import closing

import mujoco
import numpy as np

from mimoc.bundle import Bundle
from mimoc.runtime.model import load_model
from mimoc.runtime.portrait import Painter, Picture, View, towards

FROM_ABOVE: View = (160.0, -28.0)
"""From before the infant, if the room leaves that much space."""
TURNS_DEG = (0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180)
"""From where else, the best first."""


def overview(bundle: Bundle, width: int = 320, height: int = 240) -> Picture:
    """Return a picture of an infant and its toys, from within the room if it can be, shape (height, width, 3).

    Raises:
        ModelError: If MuJoCo refuses the model.
        RenderingError: If there is no OpenGL here.
    """
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(bundle.manifest.pose).id)
    mujoco.mj_forward(model, data)
    root = bundle.manifest.root_body
    azimuth, elevation = towards(FROM_ABOVE, data, root)
    with closing(Painter(model, [root, *(toy.body for toy in bundle.manifest.toys)], width, height)) as painter:

        def hidden_m(turn_deg: float) -> float:
            painter.view = azimuth + turn_deg, elevation
            return behind_walls_m(model, data, painter.place(data))

        painter.view = azimuth + min(TURNS_DEG, key=hidden_m), elevation
        return painter.paint(data)


def behind_walls_m(model: mujoco.MjModel, data: mujoco.MjData, place: np.ndarray) -> float:
    """Return how far behind the farthest plane a place is, rounded to decimetres; 0 if it is before all of them."""
    planes = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
    normals = data.geom_xmat[planes].reshape(-1, 3, 3)[:, :, 2]
    heights_m = ((place - data.geom_xpos[planes]) * normals).sum(axis=1)
    return round(float(np.maximum(-heights_m, 0.0).max(initial=0.0)), 1)
