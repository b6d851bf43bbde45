"""The compiled model of an infant, and the solids of its body, for measuring it as a child is measured."""

from collections.abc import Callable, Mapping

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation.setup import build_actuation
from mimoc.compiler.child import child_of
from mimoc.compiler.compose import compose
from mimoc.compiler.furnish import furnish
from mimoc.compiler.model_check import compile_model
from mimoc.compiler.scene_assets import SceneAssets
from mimoc.geometry.primitives import Extents, Kind, extents
from mimoc.mjcf import printing
from mimoc.mujoco_layout import BODY_GROUP, SOLIDS_GROUP
from mimoc.scenes.spec import SceneSpec
from mimoc.schema.infant import InfantSpec
from mimoc.units import ms_to_s

Progress = Callable[[int, int], None]
"""Called with the number of infants measured and their total number."""

ROOT = "hip"
"""The root body of the infant."""

IntArray = npt.NDArray[np.intp]

PRIMITIVES: Mapping[int, Kind] = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): "ellipsoid",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
}
"""Kinds of primitives by MuJoCo's geom type."""


def compile_infant(spec: InfantSpec) -> mujoco.MjModel:
    """Return the model of a spec, on a flat floor, as MuJoCo compiles it from the files of a bundle.

    Raises:
        SpecError: If there is no such child.
        ModelError: If MuJoCo rejects it.
    """
    tree = child_of(spec).tree
    plain = spec.model_copy(update={"scene": SceneSpec(pose=spec.scene.pose), "task": None})
    actuation = build_actuation(spec.actuation, tree, ms_to_s(spec.control.timestep_ms))
    infant = furnish(compose(plain, tree, actuation, {}), plain, tree, SceneAssets()).scene
    return compile_model(printing.render_scene(infant))


def own_solids(model: mujoco.MjModel) -> IntArray:
    """Return the indices of the solids of an infant's body, shape (n,): no clothes, toys or floor."""
    is_infants = model.body_rootid[model.geom_bodyid] == model.body(ROOT).id
    return np.flatnonzero(is_infants & np.isin(model.geom_group, (BODY_GROUP, SOLIDS_GROUP)))


def solid_extents(model: mujoco.MjModel, geoms: IntArray) -> Extents:
    """Return how far some geoms reach from their centres, from their indices, shape (n,)."""
    return extents((PRIMITIVES[model.geom_type[geom]], model.geom_size[geom]) for geom in geoms)
