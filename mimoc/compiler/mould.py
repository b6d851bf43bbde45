"""A model of an infant at one age, from which those of other ages are cast without printing or parsing MJCF.

The ages of an infant differ in numbers only. MuJoCo's own compiler makes each model, from its own copy of the elements,
into which the numbers are written as they would be printed; what never changes, such as textures, is taken from the
first model. `compile_model` of a whole bundle gives the same, array for array.
"""

import copy
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, islice
from typing import Any

import mujoco
import numpy as np

from mimoc.compiler.model_check import compile_model
from mimoc.mjcf.infant import Actuator, Camera, Node, PrintedGeom, PrintedJoint, Site
from mimoc.mjcf.scene import Keyframe, SceneTree
from mimoc.mjcf.world import World
from mimoc.rounding import rounded_array

KINDS = ("body", "jnt", "dof", "geom", "site", "cam", "light", "tendon", "actuator", "eq", "key", "qpos", "bvh", "pair")
"""What the arrays of a model begin with whose numbers can depend on age."""
STATISTICS = ("meaninertia", "meanmass", "meansize", "extent", "center")
XML_NAMES = {"user": "userdata"}
"""Attributes of MJCF that MuJoCo's elements have under another name."""

JOINT = (
    ("axis", "axis"),
    ("pos", "pos_m"),
    ("range", "range_rad"),
    ("stiffness", "stiffness_nm_per_rad"),
    ("damping", "damping_nms_per_rad"),
    ("frictionloss", "frictionloss_nm"),
    ("armature", "armature_kgm2"),
    ("springref", "springref_rad"),
)
"""Attributes of a joint, and the numbers that are printed as them."""

Numbers = float | Sequence[float]
Change = tuple[Any, str, Numbers]
"""An element, one of its attributes, and the numbers that this begins with."""


class DifferenceError(Exception):
    """Two scenes differ in more than numbers."""


class Mould:
    """A scene whose numbers can be changed."""

    def __init__(self, files: Mapping[str, bytes], scene: SceneTree):
        """Keep a scene.

        Args:
            files: As it is printed.
            scene: The same before that.

        Raises:
            ModelError: If MuJoCo rejects it.
        """
        self._scene, self._model = scene, compile_model(files)
        self._spec = _without_textures(files)
        self._elements = _Elements(self._spec)
        self._arrays = _same_arrays(self._model, self._spec.compile())
        self.broken = False
        """Whether MuJoCo has rejected a scene; it is of no use then."""

    def cast(self, scene: SceneTree) -> mujoco.MjModel:
        """Return the model of a scene that differs from this one in numbers only; the next one is compared with it.

        Raises:
            DifferenceError: If more is different; nothing has changed then.
            ValueError: If MuJoCo rejects it; this mould is broken then.
        """
        changes = [*_of_infant(self._scene, scene, self._elements), *_of_world(self._scene, scene, self._elements)]
        _write([*changes, *_of_keyframes(self._spec, scene.keyframes)])
        self._scene, self.broken = scene, True
        compiled, model = self._spec.compile(), copy.copy(self._model)
        self.broken = False
        for name in self._arrays:
            getattr(model, name)[...] = getattr(compiled, name)
        for name in STATISTICS:
            setattr(model.stat, name, getattr(compiled.stat, name))
        return model


class _Elements:
    """MuJoCo's elements by name."""

    def __init__(self, spec: mujoco.MjSpec):
        self.bodies, self.joints, self.geoms = map(_by_name, (spec.bodies, spec.joints, spec.geoms))
        self.sites, self.cameras, self.tendons = map(_by_name, (spec.sites, spec.cameras, spec.tendons))
        self.actuators, self.equalities = map(_by_name, (spec.actuators, spec.equalities))


def _by_name(elements: Iterable[Any]) -> dict[str, Any]:
    return {element.name: element for element in elements}


def _without_textures(files: Mapping[str, bytes]) -> mujoco.MjSpec:
    """Return MuJoCo's elements of a scene; decoding textures takes as long as all else."""
    meshes = {name: content for name, content in files.items() if name.startswith("assets/") and name[-4:] != ".png"}
    include = {"infant.xml": files["infant.xml"]}
    spec = mujoco.MjSpec.from_string(files["scene.xml"].decode(), include=include, assets=meshes)
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for texture in list(spec.textures):
        spec.delete(texture)
    return spec


def _same_arrays(model: mujoco.MjModel, without_textures: mujoco.MjModel) -> list[str]:
    """Return the names of the arrays whose numbers can depend on age."""
    names = [name for name in dir(model) if name.split("_")[0].rstrip("0") in KINDS or name.startswith("qpos")]
    arrays = [name for name in names if isinstance(getattr(model, name), np.ndarray) and getattr(model, name).size]
    return [name for name in arrays if np.array_equal(getattr(model, name), getattr(without_textures, name))]


def _of_infant(old: SceneTree, new: SceneTree, elements: _Elements) -> Iterator[Change]:
    """Yield what changes in an infant."""
    if replace(new, roots=old.roots, tendons=old.tendons, actuators=old.actuators, world=old.world, keyframes=()) != (
        replace(old, keyframes=())
    ):
        raise DifferenceError
    _check([keyframe.name for keyframe in old.keyframes] == [keyframe.name for keyframe in new.keyframes])
    for before, after in _pairs([*_nodes(old.roots)], [*_nodes(new.roots)]):
        yield from _of_node(before, after, elements)
    for before, after in _changed(old.tendons, new.tendons):
        _check(replace(after, range_rad=before.range_rad) == before)
        yield elements.tendons[after.name], "range", after.range_rad
    for before, after in _changed(old.actuators, new.actuators):
        yield from _of_actuator(before, after, elements.actuators[after.name])


def _of_node(old: Node, new: Node, elements: _Elements) -> Iterator[Change]:
    _check((old.name, old.free_joints, len(old.children)) == (new.name, new.free_joints, len(new.children)))
    yield from _of_place(old, new, elements.bodies[new.name])
    for before, after in _changed(old.joints, new.joints):
        yield from _of_joint(before, after, elements.joints[after.name])
    for before, after in _changed(old.geoms, new.geoms):
        yield from _of_geom(before, after, elements.geoms[after.name])
    for before, after in _changed(old.sites, new.sites):
        yield from _of_site(before, after, elements.sites[after.name])
    for before, after in _changed(old.cameras, new.cameras):
        yield from _of_camera(before, after, elements.cameras[after.name])


def _nodes(roots: Iterable[Node]) -> Iterator[Node]:
    """Yield all bodies, each before those that hang on it."""
    pending = [*roots]
    while pending:
        node = pending.pop()
        pending += node.children
        yield node


def _of_place(old: Any, new: Any, element: Any) -> Iterator[Change]:
    if old.pos_m != new.pos_m:
        yield element, "pos", new.pos_m
    if old.euler_rad != new.euler_rad:
        yield element.alt, "euler", new.euler_rad


def _of_joint(old: PrintedJoint, new: PrintedJoint, element: Any) -> Iterator[Change]:
    _check(old.name == new.name)
    for attribute, field in JOINT:
        numbers = getattr(new, field)
        if numbers != getattr(old, field):
            yield element, attribute, numbers


def _of_geom(old: PrintedGeom, new: PrintedGeom, element: Any) -> Iterator[Change]:
    numbers = {"size_m": new.size_m, "pos_m": new.pos_m, "euler_rad": new.euler_rad, "mass_kg": new.mass_kg}
    _check(replace(old, **numbers) == new)
    yield from _of_place(old, new, element)
    yield element, "size", new.size_m
    yield element, "mass", new.mass_kg


def _of_site(old: Site, new: Site, element: Any) -> Iterator[Change]:
    _check(replace(old, pos_m=new.pos_m, radius_m=new.radius_m) == new)
    yield element, "pos", new.pos_m
    if old.radius_m != new.radius_m:
        yield element, "size", new.radius_m


def _of_camera(old: Camera, new: Camera, element: Any) -> Iterator[Change]:
    _check(replace(old, pos_m=new.pos_m, euler_rad=new.euler_rad) == new)
    yield from _of_place(old, new, element)


def _of_actuator(old: Actuator, new: Actuator, element: Any) -> Iterator[Change]:
    _check(replace(old, gear=new.gear, control_range=new.control_range, settings=new.settings) == new)
    _check([name for name, _ in old.settings] == [name for name, _ in new.settings])
    yield element, "gear", new.gear
    if old.control_range != new.control_range:
        yield element, "ctrlrange", new.control_range
    for (name, numbers), (_, before) in zip(new.settings, old.settings, strict=True):
        if numbers != before:
            yield element, XML_NAMES.get(name, name), numbers


def _of_world(old: SceneTree, new: SceneTree, elements: _Elements) -> Iterator[Change]:
    """Yield what changes around an infant."""
    before, after = old.world, new.world
    _check(_fixed(before) == _fixed(after))
    for here, there in _changed(before.furniture.geoms, after.furniture.geoms):
        _check(replace(here, size_m=there.size_m, pos_m=there.pos_m, euler_rad=there.euler_rad) == there)
        yield from _of_place(here, there, elements.geoms[there.name])
        yield elements.geoms[there.name], "size", there.size_m
    for here, there in _changed(before.objects, after.objects):
        _check(replace(here, pos_m=there.pos_m, quat=there.quat) == there)
        yield elements.bodies[there.name], "pos", there.pos_m
        yield elements.bodies[there.name], "quat", there.quat
    for here, there in _changed(before.locks, after.locks):
        _check(replace(here, angle_rad=there.angle_rad) == there)
        yield elements.equalities[there.name], "data", there.angle_rad
    for here, there in _changed(before.welds, after.welds):
        _check(replace(here, anchor_m=there.anchor_m, pos_m=there.pos_m, quat=there.quat) == there)
        yield elements.equalities[there.name], "data", (*there.anchor_m, *there.pos_m, *there.quat)


def _fixed(world: World) -> World:
    """Return a world without what can be changed in it."""
    return replace(world, furniture=replace(world.furniture, geoms=()), objects=(), locks=(), welds=())


def _of_keyframes(spec: mujoco.MjSpec, keyframes: Sequence[Keyframe]) -> Iterator[Change]:
    for key, keyframe in zip(spec.keys, keyframes, strict=True):
        for name, numbers in (("qpos", keyframe.qpos), *keyframe.settings):
            yield key, name, numbers


def _write(changes: Sequence[Change]) -> None:
    """Write numbers, as they are read from where they are printed, to where attributes begin."""
    several = [(numbers,) if isinstance(numbers, (float, int)) else numbers for *_, numbers in changes]
    printed = iter(rounded_array(np.array([*chain(*several)], float)).tolist())
    for (element, attribute, _), numbers in zip(changes, several, strict=True):
        read, now = [*islice(printed, len(numbers))], getattr(element, attribute)
        if isinstance(now, np.ndarray):
            now[: len(read)] = read
        else:
            setattr(element, attribute, read[0] if isinstance(now, float) else read)


def _changed(old: Sequence[Any], new: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
    """Yield the elements that differ, with what they were."""
    return ((before, after) for before, after in _pairs(old, new) if before != after)


def _pairs(old: Sequence[Any], new: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
    _check(len(old) == len(new))
    return zip(old, new, strict=True)


def _check(same: bool) -> None:
    if not same:
        raise DifferenceError
