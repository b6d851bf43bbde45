"""The compiled model of an infant and its solids, and what its spec asks of the measures that WHO has standards for."""

import math
from collections.abc import Callable, Mapping

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation.build_setup import build_actuation
from mimoc.base.mujoco_layout import BODY_GROUP, SOLIDS_GROUP
from mimoc.base.units import m_to_cm, ms_to_s
from mimoc.body.kinematics import Stature, stature
from mimoc.body.measurements import targets
from mimoc.compiler.assembling import assemble_infant
from mimoc.compiler.child import child_of
from mimoc.compiler.model_check import compile_model
from mimoc.compiler.placing import SceneAssets, place_in_scene
from mimoc.geometry.primitives import Extents, Kind, extents
from mimoc.mjcf import printing
from mimoc.scenes.spec import SceneSpec
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import unsided
from mimoc.schema.sizes import MEASUREMENT_OF

SAME = 1e-6
"""Relative difference from which on a key is said to change a measure; files hold nine digits."""
MEASUREMENTS: Mapping[str, str] = {**MEASUREMENT_OF, "arm_circumference_cm": "upper_arm_circumference"}
"""The measurement that is the same as a measure, by indicator."""

Requests = Mapping[str, float | None]
"""Requested value by indicator, in cm or kg; None if it follows from other keys; of average children, there is none."""


def requests_of(spec: InfantSpec, measures: Stature) -> Requests:
    """Return what a spec asks of each measure.

    What an individual does not name follows from what it names, and what single measurements, factors of parts and
    missing parts change is not asked for by anything else.

    Args:
        spec: The spec.
        measures: The measures of its compiled child.
    """
    requests: dict[str, float | None] = {}
    if spec.body.individual:
        wanted = targets(spec.body.individual, spec.age_months)
        requests = {
            "length_cm": wanted.length_m and m_to_cm(wanted.length_m),
            "weight_kg": wanted.weight_kg,
            "head_circumference_cm": wanted.head_m and m_to_cm(wanted.head_m),
            "arm_circumference_cm": None,
        }
    for indicator, value in measures.items():
        own_cm = _replaced_cm(spec, indicator)
        if own_cm is not None:
            requests[indicator] = own_cm
        if isinstance(value, float) and _is_changed(spec, indicator, value):
            requests[indicator] = None
    return requests


def _replaced_cm(spec: InfantSpec, indicator: str) -> float | None:
    """Return the measurement that replaces a measure, of the left side if it has sides, or None."""
    name, given = MEASUREMENTS.get(indicator), spec.body.measurements
    return given.get(f"left_{name}_cm", given.get(f"{name}_cm"))


def _is_changed(spec: InfantSpec, indicator: str, value: float) -> bool:
    """Return whether a measure differs from that of the same child without other single measurements and factors."""
    body, name = spec.body, MEASUREMENTS.get(indicator)
    alone = {key: value_cm for key, value_cm in body.measurements.items() if unsided(key) == name}
    if len(alone) == len(body.measurements) and not body.parts and not body.remove:
        return False
    plain = body.model_copy(update={"measurements": alone, "parts": {}, "remove": ()})
    tree = child_of(spec.model_copy(update={"body": plain})).tree
    before = dict(stature(tree))[indicator]
    return not (isinstance(before, float) and math.isclose(value, before, rel_tol=SAME))


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
    infant = place_in_scene(assemble_infant(plain, tree, actuation, {}), plain, tree, SceneAssets()).scene
    return compile_model(printing.render_scene(infant))


def own_solids(model: mujoco.MjModel) -> IntArray:
    """Return the indices of the solids of an infant's body, shape (n,): no clothes, toys or floor."""
    is_infants = model.body_rootid[model.geom_bodyid] == model.body(ROOT).id
    return np.flatnonzero(is_infants & np.isin(model.geom_group, (BODY_GROUP, SOLIDS_GROUP)))


def solid_extents(model: mujoco.MjModel, geoms: IntArray) -> Extents:
    """Return how far some geoms reach from their centres, from their indices, shape (n,)."""
    return extents((PRIMITIVES[model.geom_type[geom]], model.geom_size[geom]) for geom in geoms)
