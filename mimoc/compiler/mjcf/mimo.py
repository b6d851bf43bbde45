"""A model in which code that was written for MIMo finds all that it looks for.

This is what MIMo (1.1), BabyBench (its starter kit of 2025) and Lucignolo (0.1) look up by name or by place, beyond
what every bundle has, and in a model of its own what MIMo 3 does. `docs/compatibility.md` says what was tried.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from mimoc.base.kinds import Component, Registry
from mimoc.base.mujoco_layout import AffineBias
from mimoc.body.tree import Body, BodyTree
from mimoc.compiler.mjcf.elements import Actuator, Camera, Node, Sensor, Site
from mimoc.compiler.mjcf.scene import Keyframe, SceneTree
from mimoc.compiler.mjcf.world import Mark

CHEST, UPPER_BODY, HEAD = "chest", "upper_body", "head"


def as_mimos(tree: BodyTree) -> BodyTree:
    """Return a body whose joints come in MIMo's order; a chest that has no joints is part of the upper body.

    It is the same body: every geom and joint is where it was, and weighs what it did.
    """
    return _head_first(_merge_chest(tree))


def _merge_chest(tree: BodyTree) -> BodyTree:
    chest = next(body for body in tree.bodies if body.name == CHEST)
    if chest.joints:
        return tree
    pairs = (tuple(UPPER_BODY if name == CHEST else name for name in pair) for pair in tree.excluded)
    return replace(
        tree,
        bodies=tuple(_with_chest(body, chest) for body in tree.bodies if body is not chest),
        excluded=tuple(dict.fromkeys((first, second) for first, second in pairs if first != second)),
        merged=((CHEST, UPPER_BODY),),
    )


def _with_chest(body: Body, chest: Body) -> Body:
    """Return the upper body with the chest's geoms, what hangs on the chest hung on it, and others as they are."""
    if body.name == UPPER_BODY:
        geoms = (replace(geom, pos_m=_moved(geom.pos_m, chest)) for geom in chest.geoms)
        return replace(body, geoms=(*body.geoms, *geoms))
    if body.parent == CHEST:
        return replace(body, parent=UPPER_BODY, pos_m=_moved(body.pos_m, chest))
    return body


def _moved(pos_m: tuple[float, float, float], chest: Body) -> tuple[float, float, float]:
    """Return a place in the frame of the chest in that of the upper body; the chest is not turned."""
    x, y, z = (inner + outer for inner, outer in zip(pos_m, chest.pos_m, strict=True))
    return x, y, z


def _head_first(tree: BodyTree) -> BodyTree:
    heads = [body for body in tree.bodies if HEAD in (body.name, body.parent)]
    others = [body for body in tree.bodies if body not in heads]
    place = 1 + next(number for number, body in enumerate(others) if body.name == UPPER_BODY)
    return replace(tree, bodies=(*others[:place], *heads, *others[place:]))


PREFIX = "eef:"
RADIUS_M = 0.01  # Only for looking at.
FORWARD = (1.0, 0.0, 0.0)
BETWEEN_THE_EYES = 5 / 7  # How far forward the head's point is, by the eyes' place (Lucignolo).


def with_effectors(node: Node) -> Node:
    """Return a body and all that hangs on it with these points: their z axis leaves the face, the eye or the palm."""
    return replace(
        node,
        sites=(
            *node.sites,
            *(Site(PREFIX + node.name, pos_m, RADIUS_M, (("zaxis", z_axis),)) for pos_m, z_axis in _places(node)),
        ),
        children=tuple(map(with_effectors, node.children)),
    )


def _places(node: Node) -> list[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """Return place and z axis of the point on a body, if it has one."""
    if node.name in ("left_eye", "right_eye"):
        return [((0.0, 0.0, 0.0), FORWARD)]
    if node.name == "head":
        eyes = [child.pos_m for child in node.children if child.name.endswith("_eye")]
        return [((BETWEEN_THE_EYES * x, 0.0, z), FORWARD) for x, _, z in eyes[:1]]
    if node.name in ("left_hand", "right_hand"):
        palm = node.geoms[0]
        inwards = 1.0 if node.name == "left_hand" else -1.0
        x, y, z = palm.pos_m
        return [((x, y + inwards * palm.size_m[1], z), (0.0, inwards, 0.0))]
    return []


Range = tuple[float, float]


def by_angle(servo: Actuator, range_rad: Range) -> Actuator:
    """Return a servo whose command is the angle of its hinge, in [rad]; it goes where it went."""
    middle, half = _halves(range_rad)
    settings = dict(servo.settings)
    (gain, *others), bias = settings["gainprm"], AffineBias(*settings["biasprm"])
    moved = bias._replace(at_zero=bias.at_zero - gain * middle / half)
    changed = {"gainprm": (gain / half, *others), "biasprm": moved}
    return replace(servo, control_range=range_rad, settings=tuple({**settings, **changed}.items()))


def pose_by_angle(keyframe: Keyframe, ranges_rad: Sequence[Range]) -> Keyframe:
    """Return a state whose servos, with these ranges, hold its pose."""
    halves = [*map(_halves, ranges_rad)]
    angles_rad = {
        name: tuple(middle + half * value for value, (middle, half) in zip(values, halves, strict=True))
        for name, values in keyframe.settings
    }
    return replace(keyframe, settings=tuple(angles_rad.items()))


def _halves(range_rad: Range) -> Range:
    low, high = range_rad
    return (low + high) / 2, (high - low) / 2


Settings = tuple[tuple[str, str], ...]
Numbers = tuple[tuple[str, tuple[float, ...]], ...]

OF_ACTIVATIONS = ("actlimited", "dynprm")  # Attributes that only mean something for actuators with an activation.


def at_once(defaults: Settings) -> Settings:
    """Return what all motors share, without an activation.

    MIMo's muscle model computes an activation of its own, and commands the resulting torque to the motor in place of
    the muscle, whose torque must not be filtered a second time.
    """
    kept = (pair for pair in defaults if pair[0] not in OF_ACTIVATIONS)
    return tuple((name, "none" if name == "dyntype" else value) for name, value in kept)


def without_activation(settings: Numbers) -> Numbers:
    """Return a motor's own attributes without those of an activation."""
    return tuple(pair for pair in settings if pair[0] not in OF_ACTIVATIONS)


GEOM = "geom:"  # MIMo 3's prefix of geoms that are numbered after their body.
CHEST_SENSOR, TRUNK_SENSOR = "proprio:chest", "proprio:trunk_upper"
Entries = Mapping[str, dict[str, Any]]  # Provenance of numbers, by key.


def name_geom(body: str, geom: str) -> str:
    """Return MIMo 3's name of a geom: `geom:left_hand1` for `left_hand1`, but `left_uarm1` and `head` as they are."""
    return GEOM + geom if geom.removeprefix(body).isdigit() else geom


def with_named_geoms(node: Node) -> Node:
    """Return a body and all that hangs on it with MIMo 3's names of geoms."""
    geoms = (replace(geom, name=name_geom(node.name, geom.name)) for geom in node.geoms)
    return replace(node, geoms=tuple(geoms), children=tuple(map(with_named_geoms, node.children)))


def trace_named_geoms(tree: BodyTree, entries: Entries) -> Entries:
    """Return the provenance of a body's numbers with MIMo 3's names of geoms."""
    names = {geom.name: name_geom(body.name, geom.name) for body in tree.bodies for geom in body.geoms}
    keys = {
        f"geom.{old}.{what}": f"geom.{new}.{what}" for old, new in names.items() for what in ("size", "pos", "mass")
    }

    def renamed(key: str, entry: dict[str, Any]) -> dict[str, Any]:
        name = key.partition(".")[2].rpartition(".")[0]
        sources = {"from": [keys.get(source, source) for source in entry["from"]]} if "from" in entry else {}
        place = {"xml": entry["xml"].replace(f"'{name}'", f"'{names[name]}'")} if key in keys else {}
        return entry | sources | place

    return {keys.get(key, key): renamed(key, entry) for key, entry in entries.items()}


def chest_before_trunk(sensors: Sequence[Sensor]) -> tuple[Sensor, ...]:
    """Return the sensors with that of the chest, if there is one, where MIMo 3 has it."""
    chest = [sensor for sensor in sensors if sensor.name == CHEST_SENSOR]
    others = [sensor for sensor in sensors if sensor.name != CHEST_SENSOR]
    place = next((number for number, sensor in enumerate(others) if sensor.name == TRUNK_SENSOR), len(others))
    return (*others[:place], *chest, *others[place:])


LOCATION = "mimo_location"  # The body that the infant is in; its free joint has the same name.
_AT_IT = (("mode", "targetbody"), ("target", LOCATION))
_QUARTER = math.pi / 2
_NARROW_DEG, _WIDE_DEG = 20.0, 45.0
CAMERAS = (
    Camera("corner", (3.0, -3.0, 3.0), (0.0, 0.0, 0.0), _NARROW_DEG, _AT_IT),
    Camera("top", (0.0, 0.0, 2.0), (0.0, 0.0, _QUARTER), _WIDE_DEG),
    Camera("side1", (2.0, 0.0, 0.5), (_QUARTER, _QUARTER, 0.0), _WIDE_DEG),
    Camera("side2", (0.0, 2.0, 0.5), (_QUARTER, math.pi, 0.0), _WIDE_DEG),
    Camera("closeup", (0.25, -0.25, 1.0), (0.0, 0.0, 0.0), _WIDE_DEG, _AT_IT),
)
"""BabyBench's, from where the infant starts."""
MARK_RADIUS_M = 0.01
MARKS = {"head": (0.8, 0.0, 0.0, 1.0), "left_hand": (0.0, 0.8, 0.0, 1.0), "right_hand": (0.15, 0.15, 1.0, 1.0)}
"""What Lucignolo places where a hand is to go, or the head to look, and its colour."""


def fit_infant(infant: SceneTree, model: str) -> SceneTree:
    """Return an infant, in no world yet, for MIMo's code, BabyBench and Lucignolo."""
    return located(replace(infant, roots=tuple(map(with_effectors, infant.roots))), model)


def fit_mimo3_infant(infant: SceneTree, model: str) -> SceneTree:
    """Return an infant, in no world yet, for MIMo 3's code."""
    roots = tuple(map(with_named_geoms, infant.roots))
    return located(replace(infant, roots=roots, sensors=chest_before_trunk(infant.sensors)), model)


def located(infant: SceneTree, model: str) -> SceneTree:
    """Return an infant, in no world yet, in a body of its own: servos take angles, motors have no activation."""
    within = replace(infant, roots=tuple(map(_located, infant.roots)))
    if model == "torque":
        motors = tuple(replace(motor, settings=without_activation(motor.settings)) for motor in infant.actuators)
        return replace(within, actuators=motors, actuator_defaults=at_once(infant.actuator_defaults))
    if model != "position":
        return within
    nodes = (node for root in infant.roots for node in root.subtree())
    of_joint = {joint.name: joint.range_deg for node in nodes for joint in node.joints}
    ranges_deg = (of_joint[servo.joint] for servo in infant.actuators)
    ranges_rad = [(math.radians(low), math.radians(high)) for low, high in ranges_deg]
    return replace(
        within,
        actuators=tuple(map(by_angle, infant.actuators, ranges_rad)),
        keyframes=tuple(pose_by_angle(keyframe, ranges_rad) for keyframe in infant.keyframes),
    )


def fit_world(scene: SceneTree) -> SceneTree:
    """Return a scene with cameras around the infant, and marks to place."""
    x_m, y_m, *_ = scene.keyframes[0].qpos
    places_m = ((camera, camera.pos_m) for camera in CAMERAS)
    cameras = tuple(replace(camera, pos_m=(x + x_m, y + y_m, z)) for camera, (x, y, z) in places_m)
    marks = tuple(Mark(f"target:{part}", (0.0, 0.0, 0.0), MARK_RADIUS_M, rgba) for part, rgba in MARKS.items())
    keyframes = tuple(
        replace(keyframe, settings=_after_marks(keyframe.settings, marks)) for keyframe in scene.keyframes
    )
    return replace(scene, world=replace(scene.world, cameras=cameras, marks=marks), keyframes=keyframes)


def _after_marks(settings: Numbers, marks: Sequence[Mark]) -> Numbers:
    """Return what a keyframe says, with the places of marks before those of other bodies that programs move."""
    first = {"mpos": [number for mark in marks for number in mark.pos_m], "mquat": [1.0, 0.0, 0.0, 0.0] * len(marks)}
    return tuple((name, (*first.get(name, ()), *numbers)) for name, numbers in settings)


def _located(root: Node) -> Node:
    return Node(
        name=LOCATION,
        pos_m=root.pos_m,
        euler_deg=root.euler_deg,
        free_joints=root.free_joints,
        children=(replace(root, pos_m=(0.0, 0.0, 0.0), euler_deg=(0.0, 0.0, 0.0), free_joints=()),),
    )


@dataclass(frozen=True, slots=True)
class CompatibilityTarget(Component):
    """What has to be different in a model that some other software is to read."""

    name: str
    """Name that users know."""
    body: Callable[[BodyTree], BodyTree] = lambda tree: tree  # Changes the body: its parts and their order.
    infant: Callable[[SceneTree, str], SceneTree] = lambda infant, model: infant
    """Changes the infant, before it is placed in a world; the other argument is its actuation model."""
    world: Callable[[SceneTree], SceneTree] = lambda scene: scene  # Changes the scene it is placed in.
    origins: Callable[[BodyTree, Entries], Entries] = lambda tree, entries: entries
    """Changes the provenance of the infant's numbers, by key."""
    chest_joint: bool = False  # Whether infants have the joints of the chest, if their spec does not say.


UNCHANGED = CompatibilityTarget("mimoc")  # For mimoc alone.
TARGETS = Registry(
    CompatibilityTarget,
    "system to build for",
    (
        CompatibilityTarget("mimo", as_mimos, fit_infant, fit_world),
        CompatibilityTarget("mimo3", infant=fit_mimo3_infant, origins=trace_named_geoms, chest_joint=True),
    ),
)


def find_target(name: str | None) -> CompatibilityTarget:
    """Return the target of a name, or raise an UnknownNameError; for None, one that changes nothing."""
    return UNCHANGED if name is None else TARGETS.find(name)
