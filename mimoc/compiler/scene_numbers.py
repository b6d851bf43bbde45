"""The numbers of a scene that can depend on age, what else there is in it, and which of MuJoCo's elements have them."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields, replace
from operator import attrgetter
from typing import Any

import mujoco

from mimoc.mjcf.furniture import WorldGeom
from mimoc.mjcf.infant import Camera, Node, PrintedGeom, PrintedJoint, PrintedTendon, Site
from mimoc.mjcf.scene import SceneTree
from mimoc.mjcf.world import FreeObject, Lock, World

XML_NAMES = {"user": "userdata"}
"""Attributes of MJCF that MuJoCo's elements have under another name."""

Settings = tuple[tuple[str, tuple[float, ...]], ...]
Slot = tuple[Any, str]
"""An element, and the attribute that begins with some numbers."""


@dataclass(frozen=True, slots=True)
class SceneLayout:
    """How some elements are read."""

    elements: str
    """Where `MjSpec` lists them."""
    attributes: Callable[[Any], tuple[str, ...]]
    """MuJoCo's names of what has numbers."""
    numbers: Callable[[Any], tuple[Any, ...]]
    """Each a number or several."""
    rest: Callable[[Any], Any]
    """Everything else."""


def _form(kind: type, elements: str, attributes: dict[str, str], *parts: str) -> SceneLayout:
    """Return the form of a kind of elements.

    Args:
        kind: Their class.
        elements: Where `MjSpec` lists them.
        attributes: The fields with numbers that can change, by MuJoCo's attribute.
        parts: Fields that hold other elements.
    """
    numbers, names = tuple(attributes.values()), tuple(attributes)
    rest = attrgetter(*(field.name for field in fields(kind) if field.name not in {*numbers, *parts}))
    read: Any = (
        attrgetter(*numbers) if len(numbers) > 1 else lambda element: tuple(getattr(element, key) for key in numbers)
    )
    return SceneLayout(elements, lambda _: names, read, rest)


PLACE = {"pos": "pos_m", "alt.euler": "euler_rad"}
BODY = _form(Node, "bodies", PLACE, "joints", "geoms", "sites", "cameras", "children")
GEOM = _form(PrintedGeom, "geoms", {**PLACE, "size": "size_m", "mass": "mass_kg"})
SITE = _form(Site, "sites", {"pos": "pos_m", "size": "radius_m"})
CAMERA = _form(Camera, "cameras", PLACE)
TENDON = _form(PrintedTendon, "tendons", {"range": "range_rad"})
FURNITURE = _form(WorldGeom, "geoms", {**PLACE, "size": "size_m"})
OBJECT = _form(FreeObject, "bodies", {"pos": "pos_m", "quat": "quat"})
LOCK = _form(Lock, "equalities", {"data": "angle_rad"})
JOINT = _form(
    PrintedJoint,
    "joints",
    {
        "axis": "axis",
        "pos": "pos_m",
        "range": "range_rad",
        "stiffness": "stiffness_nm_per_rad",
        "damping": "damping_nms_per_rad",
        "frictionloss": "frictionloss_nm",
        "armature": "armature_kgm2",
        "springref": "springref_rad",
    },
)
WELD = SceneLayout(
    "equalities",
    lambda _: ("data",),
    lambda weld: ((*weld.anchor_m, *weld.pos_m, *weld.quat),),
    lambda weld: replace(weld, anchor_m=(0.0, 0.0, 0.0), pos_m=(0.0, 0.0, 0.0), quat=(1.0, 0.0, 0.0, 0.0)),
)
ACTUATOR = SceneLayout(
    "actuators",
    lambda actuator: ("gear", "ctrlrange", *_names(actuator.settings)),
    lambda actuator: (actuator.gear, actuator.control_range, *(numbers for _, numbers in actuator.settings)),
    lambda actuator: (actuator.name, actuator.mimo_actuator, actuator.joint, *(name for name, _ in actuator.settings)),
)
KEYFRAME = SceneLayout(
    "keys",
    lambda key: ("qpos", *_names(key.settings)),
    lambda key: (key.qpos, *(numbers for _, numbers in key.settings)),
    lambda key: (key.name, *(name for name, _ in key.settings)),
)


def _names(settings: Settings) -> tuple[str, ...]:
    """Return MuJoCo's names of some attributes."""
    return tuple(XML_NAMES.get(name, name) for name, _ in settings)


def read(scene: SceneTree) -> tuple[list[Any], list[Any]]:
    """Return the numbers of a scene, and everything else: scenes with the same rest differ in numbers only.

    The infant's name is in neither: no part of the model is called by it.
    """
    bare = replace(
        scene, name="", roots=(), tendons=(), actuators=(), keyframes=(), world=_fixed(scene.world), skin=None
    )
    numbers, rest = list[Any](), list[Any]([bare])
    for form, element in _elements(scene):
        numbers += form.numbers(element)
        rest.append(form.rest(element) if form is not BODY else (form.rest(element), *map(len, _parts(element))))
    return numbers, rest


def slots(scene: SceneTree, spec: mujoco.MjSpec) -> list[Slot]:
    """Return where MuJoCo's elements of a scene hold each of its numbers."""
    named = {form.elements: {element.name: element for element in getattr(spec, form.elements)} for form in FORMS}
    return [
        _slot(named[form.elements][element.name], attribute)
        for form, element in _elements(scene)
        for attribute in form.attributes(element)
    ]


def _slot(element: Any, attribute: str) -> Slot:
    return (element.alt, attribute[4:]) if attribute.startswith("alt.") else (element, attribute)


def _elements(scene: SceneTree) -> Iterator[tuple[SceneLayout, Any]]:
    """Yield all elements whose numbers can change, with their forms."""
    for node in _nodes(scene.roots):
        yield BODY, node
        for form, elements in zip((JOINT, GEOM, SITE, CAMERA), _parts(node), strict=False):
            yield from ((form, part) for part in elements)
    world = scene.world
    lists = scene.tendons, scene.actuators, world.furniture.geoms, world.objects, world.locks, world.welds
    for form, elements in zip(FORMS[5:], (*lists, scene.keyframes), strict=True):
        yield from ((form, part) for part in elements)


def _nodes(roots: Iterable[Node]) -> Iterator[Node]:
    """Yield all bodies, each before those that hang on it."""
    pending = [*roots]
    while pending:
        node = pending.pop()
        pending += node.children
        yield node


def _parts(node: Node) -> tuple[tuple[Any, ...], ...]:
    return node.joints, node.geoms, node.sites, node.cameras, node.children


def _fixed(world: World) -> World:
    """Return a world without what can be changed in it."""
    return replace(world, furniture=replace(world.furniture, geoms=()), objects=(), locks=(), welds=())


FORMS = BODY, JOINT, GEOM, SITE, CAMERA, TENDON, ACTUATOR, FURNITURE, OBJECT, LOCK, WELD, KEYFRAME
