"""The facial expression of an infant."""

from collections.abc import Mapping

import mujoco
import numpy as np

from mimoc.base.errors import check_name
from mimoc.bundle.face import Face
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.runtime.model_fields import ModelField


def face_of(bundle: Bundle) -> Face | None:
    """Return the face of an infant, None if it has none."""
    return Face(bundle.manifest.face, lambda: bundle.arrays) if bundle.manifest.face else None


def set_expression(expression: str, face: Face | None, model: mujoco.MjModel) -> None:
    """Change the facial expression of an infant."""
    check_name("facial expression of this infant", expression, face.entry.materials if face else ())
    assert face
    face.show(model, expression)


def expression_of(manifest: Manifest, model: mujoco.MjModel) -> str | None:
    """Return the facial expression that an infant has now; None if it has no face, or another."""
    nothing: Mapping[str, np.ndarray] = {}
    return Face(manifest.face, lambda: nothing).shown(model) if manifest.face else None


def expression_fields(face: Face | None, model: mujoco.MjModel) -> tuple[ModelField, ...]:
    """Return what the expression changes in the model."""
    if face is None:
        return ()
    if face.entry.skin is None:
        return (ModelField("geom_matid", np.array([model.geom(face.entry.geom).id])),)
    return (ModelField("skin_matid", np.array([model.skin(face.entry.skin).id]), _Follower(face)),)


class _Follower:
    """Lets the vertices of a face follow its material, wherever that is written."""

    def __init__(self, face: Face):
        self._face = face

    def __call__(self, model: mujoco.MjModel, values: np.ndarray) -> None:
        """Write the material into a model, and move the vertices."""
        names = {model.material(material).id: name for name, material in self._face.entry.materials.items()}
        self._face.show(model, names[int(values[0])])
