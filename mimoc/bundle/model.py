"""From a bundle to a compiled MuJoCo model, if it is one that mimoc could have written and its manifest fits it."""

import logging
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar, get_args

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import BundleError, ModelError, UnknownNameError
from mimoc.base.geometry.primitives import Extents, Kind, extents
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.mjcf_check import check_assets, read_mjcf
from mimoc.bundle.regular_files import first_of
from mimoc.schema.base import Model, on_recompose
from mimoc.schema.entries import NameOf

Named = TypeVar("Named", bound=Model)
FAULTY_SPARSE_SOLVER = "4.0.0"
"""MuJoCo release whose Newton solver gives wrong results in rare states when the Jacobian is sparse."""

MAX_CONTACTS = 1500  # At the start of an episode; an infant with ten fingers and fifty toys in a room have 150.
TOUCH_M = 1.5e-4
"""How deep in each other things are that only touch: MuJoCo's contacts are soft, and poses are made with 1e-4 m."""
NOT_MJCF = (".json", ".yaml", ".md", ".npz")  # Endings of the files of a bundle that are not MuJoCo's.
_WARNINGS = mujoco.mjtWarning
BREAKDOWNS = tuple(map(int, (_WARNINGS.mjWARN_BADQPOS, _WARNINGS.mjWARN_BADQVEL, _WARNINGS.mjWARN_BADQACC)))
"""MuJoCo's warnings that mean the simulation has become unstable."""


def load_model(bundle: Bundle) -> mujoco.MjModel:
    """Return the compiled scene of a bundle; BundleError if it is none of mimoc's, ModelError if MuJoCo rejects it."""
    check_files(bundle)
    model = read_model(bundle.files, bundle.manifest.scene)
    check_model(bundle, model)
    prepare(model)
    return model


def load_plain_model(bundle: Bundle) -> mujoco.MjModel:
    """Return what `load_model` does, with one pixel of the mean colour for each texture: most of its memory."""
    model = load_model(bundle)
    if not model.ntex:
        return model
    xml, files = mjcf_of(bundle.files, bundle.manifest.scene)
    included = {name: files.pop(name) for name in list(files) if name.endswith(".xml")}
    spec = mujoco.MjSpec.from_string(xml, include=included, assets=files)
    for index, texture in enumerate(spec.textures):
        is_flat = texture.type == mujoco.mjtTexture.mjTEXTURE_2D
        start, channels = int(model.tex_adr[index]), int(model.tex_nchannel[index])
        size = int(model.tex_height[index]) * int(model.tex_width[index]) * channels
        mean = model.tex_data[start : start + size].reshape(-1, channels).mean(axis=0) / 255.0
        texture.rgb1 = np.resize(mean, 3).tolist() if channels < 3 else mean[:3].tolist()
        texture.file = ""
        texture.cubefiles = [""] * 6
        texture.gridsize = [1, 1]
        texture.builtin, texture.mark = mujoco.mjtBuiltin.mjBUILTIN_FLAT, mujoco.mjtMark.mjMARK_NONE
        texture.width, texture.height = 1, 1 if is_flat else 6
    plain = spec.compile()
    prepare(plain)
    return plain


def read_model(files: Mapping[str, bytes], scene: str) -> mujoco.MjModel:
    """Return what MuJoCo makes of files that were checked; a ModelError says why it rejects them."""
    try:
        return mujoco.MjModel.from_xml_string(*mjcf_of(files, scene))
    except (ValueError, mujoco.FatalError) as error:
        raise ModelError(f"MuJoCo {mujoco.__version__} rejects the bundle: {' '.join(str(error).split())}") from None


def mjcf_of(files: Mapping[str, bytes], scene: str) -> tuple[str, dict[str, bytes]]:
    """Return the MJCF of a scene and the files that it can refer to; of others, MuJoCo would take sums all the same."""
    return files[scene].decode(), {name: files[name] for name in files if not name.endswith(NOT_MJCF)}


def prepare(model: mujoco.MjModel) -> None:
    """Prepare a compiled model for simulation with this release of MuJoCo."""
    if mujoco.__version__ == FAULTY_SPARSE_SOLVER:
        warnings.warn(
            f"the sparse solver of MuJoCo {FAULTY_SPARSE_SOLVER} gives wrong contact forces in rare states; mimoc uses "
            "the slower dense solver instead. Other releases from 3.5 on do not need this: pip install 'mujoco!=4.0.0'",
            stacklevel=2,
        )
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    if model.ntree == 1:  # Faster, and the same to the bit; if other things move, neither (benchmarks/resting.py).
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ISLAND
    # MuJoCo's warnings go to Python's log; by default it prints them and writes MUJOCO_LOG.TXT. None is lost: each is
    # counted in its `MjData`, and `info["unstable"]` reports the serious ones.
    if mujoco.get_mju_user_warning() is None:
        mujoco.set_mju_user_warning(logging.getLogger(__name__).info)


@contextmanager
def bounded() -> Iterator[None]:
    """Turn MuJoCo's lack of memory, for contacts that no infant has, into a ModelError."""
    try:
        yield
    except mujoco.FatalError as error:
        raise out_of_memory(error) from None


def out_of_memory(error: Exception) -> ModelError:
    """Return the error that says that MuJoCo cannot go on, as a rule because of too many contacts."""
    reason = str(error).split("\n")[0].split(",")[0]
    return ModelError(f"MuJoCo {mujoco.__version__} cannot go on with this model ({reason})")


def begin(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Derive all of a state in which an episode begins; ModelError if there are more contacts than in any scene."""
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    check_contacts(data)
    mujoco.mj_forward(model, data)


def check_contacts(data: mujoco.MjData) -> None:
    """Raise a ModelError if, at the start of an episode, there are more contacts than in any scene."""
    if data.ncon > MAX_CONTACTS:
        raise ModelError(f"the model has {data.ncon:,} contacts at the start, which no scene of mimoc's has")


def load_posed(bundle: Bundle, pose: str | None = None) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Return the compiled scene of a bundle, and its state in a pose, by default its own; see `load_model`."""
    pose = pose_of(bundle.manifest, pose)
    model = load_model(bundle)
    with bounded():
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
        begin(model, data)
    return model, data


def is_unstable(data: mujoco.MjData) -> bool:
    """Return whether a simulation has become unstable since its reset; MuJoCo then resets it automatically."""
    counts = data.warning.number
    return any(counts[kind] for kind in BREAKDOWNS)


def simulation_warnings(data: mujoco.MjData) -> tuple[str, ...]:
    """Return the kinds of warnings that MuJoCo has raised in a simulation."""
    return tuple(
        mujoco.mjtWarning(kind).name.removeprefix("mjWARN_")
        for kind in range(mujoco.mjtWarning.mjNWARNING)
        if data.warning[kind].number
    )


def in_subtrees(model: mujoco.MjModel, roots: Sequence[int]) -> npt.NDArray[np.bool_]:
    """Return a mask of the root bodies and all their descendants, shape (nbody,)."""
    is_inside = np.zeros(model.nbody, bool)
    is_inside[list(roots)] = True
    for body in range(1, model.nbody):  # Parents come before children.
        is_inside[body] |= is_inside[model.body_parentid[body]]
    return is_inside


_MAX_LISTED = 5  # Most problems that an error tells of.
INFANT, SCENE = "infant.xml", "scene.xml"
"""The MJCF of a bundle; the second includes the first, or is complete by itself."""


def check_files(bundle: Bundle) -> None:
    """Raise a BundleError unless mimoc writes such files, or wrote them here; see `check_mjcf`."""
    if bundle.path is not None:
        check_mjcf(bundle.path, bundle.files, (INFANT, SCENE))


def check_mjcf(path: Path, files: Mapping[str, bytes], names: Sequence[str], infants: int = 1) -> None:
    """Check MJCF of a folder, the entry point last, which anyone may have written, and what it refers to.

    A lock says that nothing has changed since it was written, but not who wrote it. So the MJCF may consist of nothing
    but what mimoc writes and refer to files of the bundle alone, all of a bounded size, before MuJoCo reads any of it;
    and what the manifest says must fit the model.

    Raises:
        BundleError: If mimoc does not write such files, or not of this size.
    """
    missing = [name for name in names if name not in files]
    if missing:
        raise BundleError(f"{path}: {' and '.join(missing)} are missing; build it again")
    try:
        read = [read_mjcf(name, files[name], infants) for name in names]
        if any(elements["include"] for elements, _ in (read[:-1] if INFANT in names else read)):
            raise BundleError(f"only {SCENE} may include {INFANT}")
        check_assets(files, {file: element for _, references in read for file, element in references.items()})
    except BundleError as error:
        raise BundleError(f"{path}: {error}; do not use it") from None


def check_model(bundle: Bundle, model: mujoco.MjModel) -> None:
    """Raise a BundleError unless a model fits the manifest of its bundle, see `check_fits`, or was built here."""
    if bundle.path is not None:
        check_fits(bundle.path, bundle.manifest, bundle.manifest.timestep_ms, model)


def check_fits(path: Path, manifest: Model, timestep_ms: float, model: mujoco.MjModel) -> None:
    """Raise a BundleError unless a model has a time step and all that a manifest names: which, and where."""
    if not abs(model.opt.timestep - ms_to_s(timestep_ms)) < 1e-9:
        reason = f"timestep_ms: the physics step of the model is {1000 * model.opt.timestep:g} ms"
        raise BundleError(f"{path}: {reason}; build it again")
    # For kinds of names that not every object of a type will do for, those that do.
    masks: dict[str, npt.NDArray[np.bool_]] = {
        "hinge": model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE,
        "free joint": model.jnt_type == mujoco.mjtJoint.mjJNT_FREE,
        "sensor of three numbers": (model.sensor_dim == 3) & (model.sensor_objtype == mujoco.mjtObj.mjOBJ_SITE),
        "lock": model.eq_type == mujoco.mjtEq.mjEQ_JOINT,
        "weld": model.eq_type == mujoco.mjtEq.mjEQ_WELD,
    }
    fitting = {kind: set(np.flatnonzero(mask).tolist()) for kind, mask in masks.items()}
    missing = []
    for where, kind, name in _names(manifest, None, ""):
        index = -1 if "\0" in name else mujoco.mj_name2id(model, _OBJECTS[kind], name)
        if index < 0 or index not in fitting.get(kind, (index,)):
            missing.append(f"{where}: the model has no {kind} {name[:60]!r}")
    if missing:
        reason = f"its manifest does not fit its model: {first_of(missing, _MAX_LISTED)}"
        raise BundleError(f"{path}: {reason}; build it again")


def prefixed(section: Named, prefix: str) -> Named:
    """Return a section of a manifest in which the names of all things in the model begin with a prefix."""
    changes = {field: _prefixed(getattr(section, field), kind, prefix) for field, kind in _fields(type(section))}
    return section.model_copy(update=changes)


def _prefixed(value: Any, kind: str | None, prefix: str) -> Any:
    if isinstance(value, str):
        return prefix + value if kind else value
    if isinstance(value, Model):
        return prefixed(value, prefix)
    if isinstance(value, Mapping):
        return {key: _prefixed(inner, kind, prefix) for key, inner in value.items()}
    return tuple(_prefixed(inner, kind, prefix) for inner in value) if isinstance(value, tuple) else value


def _names(value: Any, kind: str | None, where: str) -> Iterator[tuple[str, str, str]]:
    """Yield where each name in a manifest stands, what it is the name of, and the name."""
    if isinstance(value, str):
        if kind:
            yield where, kind, value
    elif isinstance(value, Model):
        for field, named in _fields(type(value)):
            yield from _names(getattr(value, field), named, f"{where}.{field}".removeprefix("."))
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _names(inner, kind, f"{where}.{key}")
    elif isinstance(value, tuple):
        for index, inner in enumerate(value):
            yield from _names(inner, kind, f"{where}[{index}]")


@lru_cache(maxsize=256)
def _fields(section: type[Model]) -> tuple[tuple[str, str | None], ...]:
    """Return the fields of a section that may hold names, themselves or within, and what these name."""
    kinds = {name: _kind((*info.metadata, info.annotation)) for name, info in section.model_fields.items()}
    fields = section.model_fields
    return tuple((name, kind) for name, kind in kinds.items() if kind or _has_sections(fields[name].annotation))


on_recompose(_fields.cache_clear)


def _kind(annotations: Iterable[Any]) -> str | None:
    """Return what texts with some annotations name, by the first mark among these or within them."""
    kinds = (part.kind if isinstance(part, NameOf) else _kind(get_args(part)) for part in annotations)
    return next(filter(None, kinds), None)


def _has_sections(annotation: Any) -> bool:
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return True
    return any(map(_has_sections, get_args(annotation)))


_OBJECTS: Mapping[str, mujoco.mjtObj] = {
    "body": mujoco.mjtObj.mjOBJ_BODY,
    "hinge": mujoco.mjtObj.mjOBJ_JOINT,
    "free joint": mujoco.mjtObj.mjOBJ_JOINT,
    "joint": mujoco.mjtObj.mjOBJ_JOINT,
    "tendon": mujoco.mjtObj.mjOBJ_TENDON,
    "geom": mujoco.mjtObj.mjOBJ_GEOM,
    "sensor of three numbers": mujoco.mjtObj.mjOBJ_SENSOR,
    "actuator": mujoco.mjtObj.mjOBJ_ACTUATOR,
    "camera": mujoco.mjtObj.mjOBJ_CAMERA,
    "keyframe": mujoco.mjtObj.mjOBJ_KEY,
    "material": mujoco.mjtObj.mjOBJ_MATERIAL,
    "skin": mujoco.mjtObj.mjOBJ_SKIN,
    "lock": mujoco.mjtObj.mjOBJ_EQUALITY,
    "weld": mujoco.mjtObj.mjOBJ_EQUALITY,
}
"""Types of objects that names are looked up among."""


def pose_of(manifest: Manifest, pose: str | None) -> str:
    """Return the name of a pose, by default the bundle's, or raise an UnknownNameError."""
    if pose is None or pose in manifest.poses:
        return pose or manifest.pose
    kept = manifest.constraints.locks or manifest.constraints.welds
    what = "pose for an infant with held bodies or locked joints" if kept else "pose"
    what = "pose that is free of this infant's objects" if manifest.objects and not kept else what
    raise UnknownNameError(what, str(pose), manifest.poses)


PRIMITIVES: Mapping[int, Kind] = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): "ellipsoid",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
}
"""Kinds of primitives by MuJoCo's geom type."""


def solid_extents(model: mujoco.MjModel, geoms: npt.NDArray[np.intp]) -> Extents:
    """Return how far some geoms reach from their centres, from their indices, shape (n,)."""
    return extents((PRIMITIVES[model.geom_type[geom]], model.geom_size[geom]) for geom in geoms)


FloatArray = npt.NDArray[np.float64]

STATE = mujoco.mjtState.mjSTATE_INTEGRATION  # What of a simulation it contains.


def physics_of(model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
    """Return the state of a simulation, shape (n,)."""
    physics = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, physics, STATE)
    return physics


def time_of(physics: FloatArray) -> float:
    """Return the time of a state [s], which MuJoCo writes first."""
    return float(physics[0])


def check_physics(physics: FloatArray, model: mujoco.MjModel) -> None:
    """Check that a state has the size of those of a model; raise a ValueError if it has not."""
    if np.shape(physics) != (mujoco.mj_stateSize(model, STATE),):
        raise ValueError("state does not fit this infant: the size of its model's state is different")


def set_physics(model: mujoco.MjModel, data: mujoco.MjData, physics: FloatArray) -> None:
    """Restore a state, with all that is derived from it."""
    mujoco.mj_resetData(model, data)
    mujoco.mj_setState(model, data, physics, STATE)
    mujoco.mj_forward(model, data)
    mujoco.mj_setState(model, data, physics, STATE)  # The solver's warm start, as it was.
