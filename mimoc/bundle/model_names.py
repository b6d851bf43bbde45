"""What a manifest names, looked up in the model."""

from collections.abc import Iterable, Iterator, Mapping
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
    fitting, known = _fitting(model), dict[tuple[NameKind, str], bool]()
    missing = []
    for where, kind, name in names_in(manifest):
        if (kind, name) not in known:
            index = _found(model, kind, name)
            known[kind, name] = index >= 0 and (kind not in fitting or index in fitting[kind])
        if not known[kind, name]:
            missing.append(f"{where}: the model has no {kind} {name[:60]!r}")
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
    marks = [mark for mark in (*metadata, *getattr(annotation, "__metadata__", ())) if isinstance(mark, NameOf)]
    if marks:
        return marks[0].kind
    return next((kind for inner in get_args(annotation) if (kind := _kind(inner))), None)


def _has_sections(annotation: Any) -> bool:
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return True
    return any(map(_has_sections, get_args(annotation)))


def _found(model: mujoco.MjModel, kind: NameKind, name: str) -> int:
    return -1 if "\0" in name else mujoco.mj_name2id(model, _OBJECTS[kind], name)


def _fitting(model: mujoco.MjModel) -> dict[NameKind, set[int]]:
    """Return, for kinds of names that not every object of a type will do for, those that do."""
    joints, equalities = (kinds.tolist() for kinds in (model.jnt_type, model.eq_type))
    sensors = zip(model.sensor_dim.tolist(), model.sensor_objtype.tolist(), strict=True)
    return {
        "hinge": _indices(joints, mujoco.mjtJoint.mjJNT_HINGE),
        "free joint": _indices(joints, mujoco.mjtJoint.mjJNT_FREE),
        "sensor of three numbers": _indices(sensors, (3, int(mujoco.mjtObj.mjOBJ_SITE))),
        "lock": _indices(equalities, mujoco.mjtEq.mjEQ_JOINT),
        "weld": _indices(equalities, mujoco.mjtEq.mjEQ_WELD),
    }


def _indices(kinds: Iterable[Any], wanted: Any) -> set[int]:
    wanted = wanted if isinstance(wanted, tuple) else int(wanted)
    return {index for index, kind in enumerate(kinds) if kind == wanted}


_OBJECTS: Mapping[NameKind, mujoco.mjtObj] = {
    "body": mujoco.mjtObj.mjOBJ_BODY,
    "hinge": mujoco.mjtObj.mjOBJ_JOINT,
    "free joint": mujoco.mjtObj.mjOBJ_JOINT,
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
