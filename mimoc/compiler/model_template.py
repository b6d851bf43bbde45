"""A model of an infant at one age, from which those of other ages are cast without printing or parsing MJCF.

The ages of an infant differ in numbers only. MuJoCo's own compiler makes each model, from its own copy of the elements,
into which the numbers are written as they would be printed; what never changes, such as textures, is taken from the
first model. `compile_model` of a whole bundle gives the same, array for array, but for the name of the whole model:
that of the first infant stays.
"""

import copy
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import chain
from operator import attrgetter
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.arrays import rounded_array
from mimoc.body.tree import Geom, Joint, Tendon
from mimoc.bundle.model import prepare
from mimoc.compiler.mjcf.elements import Actuator, Camera, Node, Site, WorldGeom
from mimoc.compiler.mjcf.scene import Keyframe, SceneTree, Skin, single, texture_places
from mimoc.compiler.mjcf.world import FreeObject, Lock, ObjectBody, Ribbon
from mimoc.compiler.model_check import compile_model, without_textures

XML_NAMES = {
    "euler": "alt.euler",
    "radius": "size",
    "angle": "data",
    "control": "ctrlrange",
    "user": "userdata",
    "anchor": "pos",
}
"""What MuJoCo's elements call an attribute if that is neither its name in MJCF nor what its field begins with."""

Slot = tuple[Any, str]  # An element, and the attribute that begins with some numbers.


@dataclass(frozen=True, slots=True)
class SceneLayout:
    """How some elements are read."""

    elements: str  # Where `MjSpec` lists them.
    attributes: Callable[[Any], tuple[Any, ...]]  # MuJoCo's names of what has numbers.
    numbers: Callable[[Any], tuple[Any, ...]]  # Each a number or several.
    rest: Callable[[Any], Any]  # Everything else.


def _form(kind: type, elements: str, changing: str, others: str = "") -> SceneLayout:
    """Return how elements of a class are read.

    Args:
        kind: Their class.
        elements: Where `MjSpec` lists them.
        changing: The fields with numbers that can change, whose names begin with the attribute; the model has degrees
            in radians.
        others: Fields that are read elsewhere, such as those that hold other elements.
    """
    numbers = changing.split()
    names = tuple(XML_NAMES.get(name, name) for name in (field.partition("_")[0] for field in numbers))
    rest = attrgetter(*(field.name for field in fields(kind) if field.name not in {*numbers, *others.split()}))

    def read(element: Any) -> tuple[Any, ...]:
        return tuple(
            _radians(getattr(element, key)) if key.endswith("_deg") else getattr(element, key) for key in numbers
        )

    return SceneLayout(elements, lambda _: names, read, rest)


def _radians(angle_deg: float | tuple[float, ...]) -> float | tuple[float, ...]:
    return tuple(map(math.radians, angle_deg)) if isinstance(angle_deg, tuple) else math.radians(angle_deg)


def _with_settings(form: SceneLayout) -> SceneLayout:
    """Return how elements are read whose `settings` are numbers that can change, too."""
    return SceneLayout(
        form.elements,
        lambda element: (*form.attributes(element), *(XML_NAMES.get(name, name) for name, _ in element.settings)),
        lambda element: (*form.numbers(element), *(numbers for _, numbers in element.settings)),
        lambda element: (form.rest(element), *(name for name, _ in element.settings)),
    )


BODY = _form(Node, "bodies", "pos_m euler_deg", "joints geoms sites cameras children")
GEOM = _form(Geom, "geoms", "pos_m euler_deg size_m mass_kg")
SITE = _form(Site, "sites", "pos_m radius_m")
CAMERA = _form(Camera, "cameras", "pos_m euler_rad")
TENDON = _form(Tendon, "tendons", "range_rad")
FURNITURE = _form(WorldGeom, "geoms", "pos_m euler_rad size_m")
OBJECT = _form(FreeObject, "bodies", "pos_m quat")
THING = _form(ObjectBody, "bodies", "pos_m quat")
RIBBON = _form(Ribbon, "tendons", "range_m")
LOCK = _form(Lock, "equalities", "angle_rad")
JOINT = _with_settings(
    _form(
        Joint,
        "joints",
        "axis anchor_m range_deg stiffness_nm_per_rad damping_nms_per_rad frictionloss_nm armature_kgm2 springref_deg",
        "margin_deg changes",
    )
)
ACTUATOR = _with_settings(_form(Actuator, "actuators", "gear control_range", "settings tone"))  # Tone is not MuJoCo's.
KEYFRAME = _with_settings(_form(Keyframe, "keys", "qpos", "settings"))
WELD = SceneLayout(
    "equalities",
    lambda _: ("data",),
    lambda weld: ((*weld.anchor_m, *weld.pos_m, *weld.quat),),
    lambda weld: replace(weld, anchor_m=(0.0, 0.0, 0.0), pos_m=(0.0, 0.0, 0.0), quat=(1.0, 0.0, 0.0, 0.0)),
)


def read(scene: SceneTree) -> tuple[list[Any], list[Any]]:
    """Return the numbers of a scene, and everything else: scenes with the same rest differ in numbers only.

    The infant's name is in neither: no part of the model is called by it.
    """
    furniture = replace(scene.world.furniture, geoms=())
    world = replace(scene.world, furniture=furniture, objects=(), placed=(), locks=(), welds=())
    world = replace(world, persona=replace(world.persona, bodies=()))
    bare = replace(scene, name="", roots=(), tendons=(), actuators=(), keyframes=(), world=world, skin=None)
    numbers, rest = list[Any](), list[Any]([bare])
    for form, element in _elements(scene):
        numbers += form.numbers(element)
        rest.append(form.rest(element) if form is not BODY else (form.rest(element), *map(len, _parts(element))))
    return numbers, rest


def parameters(scene: SceneTree, spec: mujoco.MjSpec) -> list[Slot]:
    """Return where MuJoCo's elements of a scene hold each of its numbers."""
    named = {form.elements: {element.name: element for element in getattr(spec, form.elements)} for form in FORMS}
    return [
        (named[form.elements][element.name].alt, attribute[4:])
        if attribute.startswith("alt.")
        else (named[form.elements][element.name], attribute)
        for form, element in _elements(scene)
        for attribute in form.attributes(element)
    ]


def _elements(scene: SceneTree) -> Iterator[tuple[SceneLayout, Any]]:
    """Yield all elements whose numbers can change, with their forms."""
    for node in (node for root in scene.roots for node in root.subtree()):
        yield BODY, node
        for form, elements in zip((JOINT, GEOM, SITE, CAMERA), _parts(node), strict=False):
            yield from ((form, part) for part in elements)
    world = scene.world
    yield from ((THING, item.root) for item in world.placed)
    yield from ((THING, body) for body in world.persona.bodies)
    yield from ((RIBBON, ribbon) for item in world.placed for ribbon in item.ribbons)
    lists = scene.tendons, scene.actuators, world.furniture.geoms, world.objects, world.locks, world.welds
    for form, elements in zip(FORMS[5:], (*lists, scene.keyframes), strict=True):
        yield from ((form, part) for part in elements)


def _parts(node: Node) -> tuple[tuple[Any, ...], ...]:
    return node.joints, node.geoms, node.sites, node.cameras, node.children


FORMS = BODY, JOINT, GEOM, SITE, CAMERA, TENDON, ACTUATOR, FURNITURE, OBJECT, LOCK, WELD, KEYFRAME


KINDS = ("body", "jnt", "dof", "geom", "site", "cam", "light", "tendon", "actuator", "eq", "key", "qpos", "bvh", "pair")
"""What the arrays of a model begin with whose numbers can depend on age."""
STATISTICS = ("meaninertia", "meanmass", "meansize", "extent", "center")


class DifferenceError(Exception):
    """Two scenes differ in more than numbers."""


@dataclass(frozen=True, slots=True)
class ModelInstance:
    """The model of a scene, of which copies can be had."""

    shared: mujoco.MjModel  # What never changes, such as textures.
    numbers: mujoco.MjModel  # All else.
    arrays: Sequence[str]  # The names of the arrays with this.
    skin: Skin | None  # Its skin, which MuJoCo only copies.

    def model(self) -> mujoco.MjModel:
        """Return a model of one's own, with the skin of the template."""
        model = copy.copy(self.shared)
        for name in self.arrays:
            getattr(model, name)[...] = getattr(self.numbers, name)
        for name in STATISTICS:
            setattr(model.stat, name, getattr(self.numbers.stat, name))
        prepare(model)
        return model

    def set_textures(self, model: mujoco.MjModel) -> None:
        """Write the skin of the scene into one of these models."""
        if self.skin:
            for layer in self.skin.layers:
                index = model.skin(layer.name).id
                first, bone = model.skin_vertadr[index], model.skin_boneadr[index]
                model.skin_vert[first : first + len(layer.verts_m)] = single(layer.verts_m)
                place = model.skin_texcoordadr[index]
                model.skin_texcoord[place : place + len(layer.texcoords)] = texture_places(layer)
                model.skin_bonebindpos[bone : bone + len(layer.bones)] = single(layer.origins_m)
                model.skin_bonebindquat[bone : bone + len(layer.bones)] = single(layer.quats)


class ModelTemplate:
    """A scene whose numbers can be changed."""

    def __init__(self, files: Mapping[str, bytes], scene: SceneTree):
        """Keep a scene, and the model of the files that it was printed to; raise a ModelError if MuJoCo rejects it."""
        self._model, self._spec = compile_model(files), without_textures(files)
        self._numbers, self._rest = read(scene)
        self._slots = parameters(scene, self._spec)
        values = (getattr(*slot) for slot in self._slots)
        self._views = [value if isinstance(value, np.ndarray) else None for value in values]
        self._arrays = _same_arrays(self._model, self._spec.compile())
        self.broken = False
        """Whether MuJoCo has rejected a scene; it is of no use then."""

    def fits(self, scene: SceneTree) -> bool:
        """Return whether a scene differs from this one in numbers only."""
        return read(scene)[1] == self._rest

    def instantiate(self, scene: SceneTree) -> ModelInstance:
        """Return the model of a scene that differs from this one in numbers only; the next one is compared with it.

        Raises:
            DifferenceError: If more is different; nothing has changed then.
            ValueError: If MuJoCo rejects it; this template is broken then.
        """
        numbers, rest = read(scene)
        if rest != self._rest:
            raise DifferenceError
        every = zip(self._slots, self._views, numbers, self._numbers, strict=True)
        _write([(slot, view, now) for slot, view, now, before in every if now != before])
        self._numbers, self.broken = numbers, True
        instance = ModelInstance(self._model, self._spec.compile(), self._arrays, scene.skin)
        self.broken = False
        return instance


def _same_arrays(model: mujoco.MjModel, without_textures: mujoco.MjModel) -> list[str]:
    names = [name for name in dir(model) if name.split("_")[0].rstrip("0") in KINDS or name.startswith("qpos")]
    arrays = [name for name in names if isinstance(getattr(model, name), np.ndarray) and getattr(model, name).size]
    return [name for name in arrays if np.array_equal(getattr(model, name), getattr(without_textures, name))]


def _write(changes: Sequence[tuple[Slot, npt.NDArray[Any] | None, Any]]) -> None:
    several = [numbers if isinstance(numbers, tuple) else (numbers,) for *_, numbers in changes]
    printed = rounded_array(np.array([*chain(*several)], float))
    end = 0
    for ((element, attribute), view, numbers), values in zip(changes, several, strict=True):
        start, end = end, end + len(values)
        if view is not None:
            view[: len(values)] = printed[start:end]
        else:
            read = printed[start:end].tolist()
            setattr(element, attribute, read if isinstance(numbers, tuple) else read[0])
