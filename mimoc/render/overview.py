"""Pictures of a whole scene: an infant among its toys."""

from contextlib import closing

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_posed
from mimoc.render.body_camera import STILL, BodyCamera
from mimoc.render.camera import FROM_ABOVE, view_of_body
from mimoc.render.renderer import Picture


def overview(bundle: Bundle, width: int = 320, height: int = 240) -> Picture:
    """Return a picture of an infant and its toys, from within the room, shape (height, width, 3).

    Raises:
        ModelError: If MuJoCo rejects the model.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_posed(bundle)
    root, toys = bundle.manifest.root_body, bundle.manifest.toys
    shown = [root, *(toy.body for toy in toys)]
    view = view_of_body(FROM_ABOVE, data, root)
    with closing(BodyCamera(model, shown, width, height, view, supersample=STILL)) as camera:
        camera.turn(data)
        return camera.render(data)
