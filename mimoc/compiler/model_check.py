"""Compilation of a bundle's files by MuJoCo: errors traced to lines of the spec, and objects inside of something."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from mimoc.base.errors import ModelError, ObjectError
from mimoc.bundle.model import TOUCH_M, mjcf_of
from mimoc.compiler.mjcf import printing
from mimoc.compiler.mjcf.scene import Keyframe, SceneTree
from mimoc.compiler.objects.built_object import PlacedThing
from mimoc.schema.objects import ObjectSpec
from mimoc.schema.source import Source


def compile_model(files: Mapping[str, bytes]) -> mujoco.MjModel:
    """Return the compiled scene of a bundle's files; raise a ModelError if MuJoCo rejects it."""
    try:
        return mujoco.MjModel.from_xml_string(*mjcf_of(files, "scene.xml"))
    except ValueError as error:
        message = _refusal(files) or " ".join(str(error).split())
        raise ModelError(f"MuJoCo rejects the model: {message}", _element(message, files)) from None


def without_textures(files: Mapping[str, bytes]) -> mujoco.MjSpec:
    """Return MuJoCo's elements of a scene; decoding textures and skins takes longer than all else."""
    meshes = {name: content for name, content in files.items() if name.startswith("assets/") and name[-4:] != ".png"}
    include = {name: files[name] for name in ("infant.xml",) if name in files}  # A world is in one file.
    spec = mujoco.MjSpec.from_string(files["scene.xml"].decode(), include=include, assets=meshes)
    for skin in list(spec.skins):
        spec.delete(skin)
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for texture in list(spec.textures):
        spec.delete(texture)
    return spec


def model_without_pictures(files: Mapping[str, bytes]) -> mujoco.MjModel:
    """Return the model of a scene without textures and skins, in which contacts are as in the whole one."""
    return without_textures(files).compile()


def trace_model_error(error: ModelError, written: Source, provenance: Mapping[str, Mapping[str, Any]]) -> ModelError:
    """Return the error of `compile_model` with the places in the spec that determine the element it is about."""
    if error.element is None:
        return ModelError(f"{written.file}: {error}; please report this")
    keys = sorted(tuple(key.split(".")[1:]) for key in _sources(error.element, provenance) if key.startswith("spec."))
    problems = [written.problem(key, f"'{error.element}' follows from this, and {error}") for key in keys]
    return ModelError("\n".join(map(str, problems)) or f"{written.file}: '{error.element}': {error}", error.element)


def _sources(element: str, provenance: Mapping[str, Mapping[str, Any]]) -> set[str]:
    """Return the keys of an element's numbers and of all numbers that these depend on."""
    pending = [key for key, entry in provenance.items() if f"[@name='{element}']" in entry.get("xml", "")]
    sources: set[str] = set()
    while pending:
        key = pending.pop()
        if key not in sources:
            sources.add(key)
            pending += provenance[key].get("from", ())
    return sources


def _refusal(files: Mapping[str, bytes]) -> str | None:
    try:
        mujoco.MjModel.from_xml_string(*mjcf_of(files, "infant.xml"))
    except ValueError as error:
        return " ".join(str(error).split())
    return None


def _element(message: str, files: Mapping[str, bytes]) -> str | None:
    """Return the name of the element that MuJoCo's message is about: it gives the name, or the line in the XML."""
    xml = files["infant.xml"].decode()
    line = re.search(r"line (\d+)", message)
    on_line = re.search(r'name="([^"]+)"', "".join(xml.splitlines()[int(line[1]) - 1 : int(line[1])])) if line else None
    quoted = (name for name in re.findall(r"'([^']+)'", message) if f'name="{name}"' in xml)
    return next(quoted, on_line and on_line[1])


LONGER_M = 1e-5  # By how much the way of a ribbon may be longer than that is: numbers are rounded.


def free_poses(
    scene: SceneTree, start: str, specs: Sequence[ObjectSpec], things: Sequence[PlacedThing]
) -> tuple[Keyframe, ...]:
    """Return the poses of a scene in which no object is inside of the infant, of another object or of furniture.

    Nor is a ribbon shorter than its way in any of them. An ObjectError says that the pose *start* is none of them.

    """
    if not things:
        return scene.keyframes
    bare = scene.without_skin
    model = model_without_pictures({**printing.render_infant(bare), **printing.render_world(bare, b"")})
    return free_keyframes(model, scene.keyframes, start, specs, things)


def free_keyframes(
    model: mujoco.MjModel,
    keyframes: Sequence[Keyframe],
    start: str,
    specs: Sequence[ObjectSpec],
    things: Sequence[PlacedThing],
) -> tuple[Keyframe, ...]:
    """Return those keyframes of a model that are as `free_poses` says."""
    # The number of the object that each geom belongs to, by geom.
    geoms = (
        (geom.name, number)
        for number, thing in enumerate(things)
        for body in thing.elements.root.subtree()
        for geom in body.geoms
    )
    numbers = {model.geom(name).id: number for name, number in geoms}
    data, kept = mujoco.MjData(model), list[Keyframe]()
    for pose in keyframes:
        overlap = _deepest(model, data, pose, numbers)
        if overlap is None:
            kept += [pose] if _ribbons_reach(model, data, things) else []
        elif pose.name == start:
            raise _overlap_error(model, overlap, numbers, specs)
    return tuple(kept)


def _deepest(
    model: mujoco.MjModel, data: mujoco.MjData, pose: Keyframe, numbers: Mapping[int, int]
) -> tuple[int, int] | None:
    """Return the two geoms, one of an object, that are deepest inside each other in a pose; None if none are."""
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose.name).id)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    is_objects = np.isin(data.contact.geom, list(numbers)).any(axis=1)
    depths_m = np.where(is_objects, -data.contact.dist, 0.0)
    if depths_m.max(initial=0.0) <= TOUCH_M:
        return None
    first, second = data.contact.geom[int(depths_m.argmax())].tolist()
    return first, second


def _ribbons_reach(model: mujoco.MjModel, data: mujoco.MjData, things: Sequence[PlacedThing]) -> bool:
    mujoco.mj_tendon(model, data)
    ribbons = [ribbon for thing in things for ribbon in thing.elements.ribbons]
    return all(data.ten_length[model.tendon(ribbon.name).id] <= ribbon.range_m[1] + LONGER_M for ribbon in ribbons)


def _overlap_error(
    model: mujoco.MjModel, overlap: tuple[int, int], numbers: Mapping[int, int], specs: Sequence[ObjectSpec]
) -> ObjectError:
    """Return the error of the later of two objects, or of the one that is inside of something else."""
    first, second = sorted(overlap, key=lambda geom: numbers.get(geom, -1))
    other = f"the object '{specs[numbers[first]].name}'" if first in numbers else f"'{_name(model, first)}'"
    number = numbers[second]
    key = "above" if specs[number].above is not None else "at"
    return ObjectError(key, f"it would start inside of {other}; give it another place, or make it smaller", number)


def _name(model: mujoco.MjModel, geom: int) -> str:
    body = model.geom_bodyid[geom]
    return model.body(body).name if body else model.geom(geom).name
