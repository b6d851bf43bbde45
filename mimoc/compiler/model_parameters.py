"""The numbers of a scene that can depend on age, what else there is in it, and which of MuJoCo's elements have them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from operator import attrgetter
from typing import Any

import mujoco

from mimoc.compiler.mjcf.elements import Actuator, Camera, Node, PrintedGeom, PrintedJoint, PrintedTendon, Site
from mimoc.compiler.mjcf.furniture import WorldGeom
from mimoc.compiler.mjcf.scene import Keyframe, SceneTree
from mimoc.compiler.mjcf.world import FreeObject, Lock, ObjectBody, Ribbon

XML_NAMES = {"euler": "alt.euler", "radius": "size", "angle": "data", "control": "ctrlrange", "user": "userdata"}
"""What MuJoCo's elements call an attribute if that is neither its name in MJCF nor what its field begins with."""

Slot = tuple[Any, str]
"""An element, and the attribute that begins with some numbers."""


@dataclass(frozen=True, slots=True)
class SceneLayout:
    """How some elements are read."""

    elements: str
    """Where `MjSpec` lists them."""
    attributes: Callable[[Any], tuple[Any, ...]]
    """MuJoCo's names of what has numbers."""
    numbers: Callable[[Any], tuple[Any, ...]]
    """Each a number or several."""
    rest: Callable[[Any], Any]
    """Everything else."""


def _form(kind: type, elements: str, changing: str, others: str = "") -> SceneLayout:
    """Return how elements of a class are read.

    Args:
        kind: Their class.
        elements: Where `MjSpec` lists them.
        changing: The fields with numbers that can change, whose names begin with the attribute.
        others: Fields that are read elsewhere, such as those that hold other elements.
    """
    numbers = changing.split()
    names = tuple(XML_NAMES.get(name, name) for name in (field.partition("_")[0] for field in numbers))
    rest = attrgetter(*(field.name for field in fields(kind) if field.name not in {*numbers, *others.split()}))
    read: Any = (
        attrgetter(*numbers) if len(numbers) > 1 else lambda element: tuple(getattr(element, key) for key in numbers)
    )
    return SceneLayout(elements, lambda _: names, read, rest)


def _with_settings(form: SceneLayout) -> SceneLayout:
    """Return how elements are read whose `settings` are numbers that can change, too."""
    return SceneLayout(
        form.elements,
        lambda element: (*form.attributes(element), *(XML_NAMES.get(name, name) for name, _ in element.settings)),
        lambda element: (*form.numbers(element), *(numbers for _, numbers in element.settings)),
        lambda element: (form.rest(element), *(name for name, _ in element.settings)),
    )


BODY = _form(Node, "bodies", "pos_m euler_rad", "joints geoms sites cameras children")
GEOM = _form(PrintedGeom, "geoms", "pos_m euler_rad size_m mass_kg")
SITE = _form(Site, "sites", "pos_m radius_m")
CAMERA = _form(Camera, "cameras", "pos_m euler_rad")
TENDON = _form(PrintedTendon, "tendons", "range_rad")
FURNITURE = _form(WorldGeom, "geoms", "pos_m euler_rad size_m")
OBJECT = _form(FreeObject, "bodies", "pos_m quat")
THING = _form(ObjectBody, "bodies", "pos_m quat")
RIBBON = _form(Ribbon, "tendons", "range_m")
LOCK = _form(Lock, "equalities", "angle_rad")
JOINT = _with_settings(
    _form(
        PrintedJoint,
        "joints",
        "axis pos_m range_rad stiffness_nm_per_rad damping_nms_per_rad frictionloss_nm armature_kgm2 springref_rad",
        "settings",
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
