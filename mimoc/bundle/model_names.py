"""What a manifest names, looked up in the model."""

from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from typing import Any, get_args

import mujoco

from mimoc.errors import BundleError
from mimoc.schema.base import Model
from mimoc.schema.composition import on_recompose
from mimoc.schema.entries import NameKind, NameOf

_SHOWN = 5
"""Most problems that an error tells of."""


def check_names(manifest: Model, model: mujoco.MjModel) -> None:
    """Check that a model has everything that a manifest names, and that it is what it should be.

    Raises:
        BundleError: If it does not; the message says which names, and where they stand.
    """
    missing = [
        f"{where}: the model has no {kind} {name[:60]!r}"
        for where, kind, name in names_in(manifest)
        if not _has(model, kind, name)
    ]
    if missing:
        rest = [f"and {len(missing) - _SHOWN} more"] if len(missing) > _SHOWN else []
        raise BundleError(f"its manifest does not fit its model: {'; '.join([*missing[:_SHOWN], *rest])}")


def names_in(entry: Model, where: str = "") -> Iterator[tuple[str, NameKind, str]]:
    """Yield where each name in a manifest stands, what it is the name of, and the name."""
    for field, kind in _fields(type(entry)):
        value = getattr(entry, field)
        if value is not None:
            yield from _names(value, kind, f"{where}{field}")


def _names(value: Any, kind: NameKind | None, where: str) -> Iterator[tuple[str, NameKind, str]]:
    if isinstance(value, str):
        if kind:
            yield where, kind, value
    elif isinstance(value, Model):
        yield from names_in(value, f"{where}.")
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _names(inner, kind, f"{where}.{key}")
    elif isinstance(value, tuple):
        for index, inner in enumerate(value):
            yield from _names(inner, kind, f"{where}[{index}]")


@lru_cache(maxsize=256)
def _fields(section: type[Model]) -> tuple[tuple[str, NameKind | None], ...]:
    """Return the fields of a section that may hold names, themselves or within, and what these name."""
    fields = section.model_fields.items()
    kinds: list[tuple[str, NameKind | None]] = [(name, _kind(info.annotation, info.metadata)) for name, info in fields]
    return tuple((name, kind) for name, kind in kinds if kind or _has_sections(section.model_fields[name].annotation))


on_recompose(_fields.cache_clear)


def _kind(annotation: Any, metadata: Any = ()) -> NameKind | None:
    """Return what the texts in a field name, by the mark in its annotation."""
    marks = [each for each in (*metadata, *getattr(annotation, "__metadata__", ())) if isinstance(each, NameOf)]
    if marks:
        return marks[0].kind
    return next((kind for inner in get_args(annotation) if (kind := _kind(inner))), None)


def _has_sections(annotation: Any) -> bool:
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return True
    return any(map(_has_sections, get_args(annotation)))


def _has(model: mujoco.MjModel, kind: NameKind, name: str) -> bool:
    object_type, fits = _LOOK_UPS[kind]
    index = -1 if "\0" in name else mujoco.mj_name2id(model, object_type, name)
    return index >= 0 and (fits is None or bool(fits(model, index)))


def _is_joint(kind: mujoco.mjtJoint) -> Callable[[mujoco.MjModel, int], bool]:
    return lambda model, joint: model.jnt_type[joint] == kind


def _is_vector_at_a_site(model: mujoco.MjModel, sensor: int) -> bool:
    return model.sensor_dim[sensor] == 3 and model.sensor_objtype[sensor] == mujoco.mjtObj.mjOBJ_SITE


def _is_equality(kind: mujoco.mjtEq) -> Callable[[mujoco.MjModel, int], bool]:
    return lambda model, equality: model.eq_type[equality] == kind


_LOOK_UPS: Mapping[NameKind, tuple[mujoco.mjtObj, Callable[[mujoco.MjModel, int], bool] | None]] = {
    "body": (mujoco.mjtObj.mjOBJ_BODY, None),
    "hinge": (mujoco.mjtObj.mjOBJ_JOINT, _is_joint(mujoco.mjtJoint.mjJNT_HINGE)),
    "free joint": (mujoco.mjtObj.mjOBJ_JOINT, _is_joint(mujoco.mjtJoint.mjJNT_FREE)),
    "geom": (mujoco.mjtObj.mjOBJ_GEOM, None),
    "sensor of three numbers": (mujoco.mjtObj.mjOBJ_SENSOR, _is_vector_at_a_site),
    "actuator": (mujoco.mjtObj.mjOBJ_ACTUATOR, None),
    "camera": (mujoco.mjtObj.mjOBJ_CAMERA, None),
    "keyframe": (mujoco.mjtObj.mjOBJ_KEY, None),
    "material": (mujoco.mjtObj.mjOBJ_MATERIAL, None),
    "skin": (mujoco.mjtObj.mjOBJ_SKIN, None),
    "lock": (mujoco.mjtObj.mjOBJ_EQUALITY, _is_equality(mujoco.mjtEq.mjEQ_JOINT)),
    "weld": (mujoco.mjtObj.mjOBJ_EQUALITY, _is_equality(mujoco.mjtEq.mjEQ_WELD)),
}
"""Where things are looked up by name, and whether what is found will do."""
