"""The facial expression of an infant: the material of its head."""

import mujoco
import numpy as np

from mimoc.base.errors import check_name
from mimoc.base.model_fields import ModelField
from mimoc.bundle.manifest import Manifest


def set_expression(expression: str, manifest: Manifest, model: mujoco.MjModel) -> None:
    """Change the facial expression of an infant.

    Raises:
        UnknownNameError: If there is no such expression.
    """
    face = manifest.face
    check_name("facial expression of this infant", expression, face.materials if face else ())
    assert face
    material = model.material(face.materials[expression]).id
    if face.skin is None:
        model.geom(face.geom).matid = material
    else:
        model.skin(face.skin).matid = material


def expression_of(manifest: Manifest, model: mujoco.MjModel) -> str | None:
    """Return the facial expression that an infant has now; None if it has no face, or another."""
    face = manifest.face
    if face is None:
        return None
    head = model.geom(face.geom) if face.skin is None else model.skin(face.skin)
    shown = model.mat_texid[int(head.matid.item())]  # A head without a skin begins with a material of its own.
    alike = (
        name
        for name, material in face.materials.items()
        if (model.mat_texid[model.material(material).id] == shown).all()
    )
    return next(alike, None)


def expression_fields(manifest: Manifest, model: mujoco.MjModel) -> tuple[ModelField, ...]:
    """Return what the expression changes in the model."""
    face = manifest.face
    if face is None:
        return ()
    if face.skin is None:
        return (ModelField("geom_matid", np.array([model.geom(face.geom).id])),)
    return (ModelField("skin_matid", np.array([model.skin(face.skin).id])),)
