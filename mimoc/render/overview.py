"""Pictures of a whole scene: an infant among its toys."""

from contextlib import closing

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.render.camera import FROM_ABOVE, towards
from mimoc.render.portrait import STILL, Painter, Picture


def overview(bundle: Bundle, width: int = 320, height: int = 240) -> Picture:
    """Return a picture of an infant and its toys, from within the room, shape (height, width, 3).

    Raises:
        ModelError: If MuJoCo refuses the model.
        RenderingError: If there is no OpenGL here.
    """
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(bundle.manifest.pose).id)
    mujoco.mj_forward(model, data)
    root, toys = bundle.manifest.root_body, bundle.manifest.toys
    view = towards(FROM_ABOVE, data, root)
    with closing(Painter(model, [root, *(toy.body for toy in toys)], width, height, view, finer=STILL)) as painter:
        painter.turn(data)
        return painter.paint(data)
