"""What the infant of a MIMo scene is in the spec language: its hands, chest and limbs, actuators, locks and senses."""

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import mujoco
import numpy as np

from mimoc.anatomy.anatomy import Anatomy, assemble
from mimoc.base.errors import SpecError
from mimoc.body.tree import FREE_JOINT
from mimoc.compat.import_mimo.reading import Element
from mimoc.compat.settings import named
from mimoc.schema.names import SIDES

HIP, CHEST, UPPER_BODY = "hip", "chest", "upper_body"
HANDS = ("mitten", "five_finger")
CHEST_JOINT = "robot:chest_lean"
BODIES = (HIP, "lower_body", UPPER_BODY, "head")
SENSORS = {"proprioception": "proprio:", "vestibular": "vestibular_"}
"""The beginning of the names of each sense's sensors."""


@dataclass(frozen=True)
class Infant:
    """MIMo in a scene: what it has of MIMo's parts."""

    tree: Element
    hip: Element
    anatomy: Anatomy  # MIMo's, with the same hands and chest.

    @cached_property
    def chain(self) -> list[Element]:
        """The elements from the scene's root to the hip."""
        return _chain(self.tree, self.hip)

    @cached_property
    def bodies(self) -> dict[str, Element]:
        """Its bodies by name."""
        return {body.get("name"): body for body in self.hip.walk() if body.tag == "body"}

    @cached_property
    def hinges(self) -> dict[str, str]:
        """Joints that it has, and the muscle group of each."""
        return {joint: group for _, body, group, joints in self._parts for joint in joints if body in self.bodies}

    @cached_property
    def removed(self) -> list[str]:
        """MIMo's limbs that it lacks, without what hangs on them."""
        lacking = {body: parent for parent, body, _, _ in self._parts if body not in self.bodies and body != CHEST}
        return [body for body, parent in lacking.items() if parent not in lacking]

    @cached_property
    def motors(self) -> dict[str, str]:
        """Its motors by the names of MIMo's, and their joints."""
        sided = ((motor.name.format(side=side), motor.joint.format(side=side)) for side, motor in self.anatomy.motors)
        return {name: joint for name, joint in sided if joint in self.hinges}

    @cached_property
    def free_joint(self) -> Element | None:
        """The joint that lets it move freely in the world."""
        for element in self.chain:
            for joint in element.children:
                if joint.tag == "freejoint" or (joint.tag == "joint" and joint.get("type") == "free"):
                    return joint
        return None

    @cached_property
    def home(self) -> Element | None:
        """The body that it is in, such as MIMo's `mimo_location`, if there is one."""
        return next((element for element in reversed(self.chain[:-1]) if element.tag == "body"), None)

    @cached_property
    def parents(self) -> dict[str, str]:
        """The parent of each of MIMo's bodies; in many scenes, the chest is part of the upper body."""
        merged = {} if CHEST in self.bodies else {CHEST: UPPER_BODY}
        return {body: merged.get(parent, parent) for parent, body, _, _ in self._parts}

    @cached_property
    def _parts(self) -> list[tuple[str, str, str, list[str]]]:
        """Parent, name, muscle group and joints of each of MIMo's bodies, parents first."""
        parts, groups = [], dict[str, str]()
        for side, part in self.anatomy.parts:
            body = part.name.format(side=side)
            parent = (part.parent or "").format(side=side)
            groups[body] = part.group.format(side=side) or groups.get(parent, "")
            parts.append((parent, body, groups[body], [joint.name.format(side=side) for joint in part.joints]))
        return parts


def find_infant(tree: Element, file: str) -> Infant:
    """Return the MIMo in a scene; raise a SpecError if there is none, or if its trunk or its hands are not MIMo's."""
    hip = next((body for body in tree.walk() if body.tag == "body" and body.get("name") == HIP), None)
    names = {body.get("name") for body in hip.walk() if body.tag == "body"} if hip else set[str]()
    if hip is None or names.isdisjoint(BODIES[1:]):
        whole = Element("", {}, file, 1)
        raise SpecError([whole.problem(f"there is no MIMo in it, whose bodies are {', '.join(BODIES)} and so on")])
    if missing := [name for name in BODIES if name not in names]:
        raise SpecError([hip.problem(f"this MIMo has no {' and no '.join(missing)}, without which no infant can be")])
    has_chest_joint = any(joint.get("name") == CHEST_JOINT for joint in hip.walk())
    anatomies = [assemble(hands, has_chest_joint, "published") for hands in HANDS]
    usual, articulated = (_bodies(anatomy) for anatomy in anatomies)
    chosen = anatomies[len(names & (articulated - usual)) > len(names & (usual - articulated))]
    infant = Infant(tree, hip, chosen)
    if problems := [hand.problem(why) for hand, why in _strange_hands(infant, usual ^ articulated)]:
        raise SpecError(problems)
    return infant


def _bodies(anatomy: Anatomy) -> set[str]:
    return {part.name.format(side=side) for side, part in anatomy.parts}


def _strange_hands(infant: Infant, of_one_kind: set[str]) -> Iterator[tuple[Element, str]]:
    """Yield the hands whose fingers are not those of the infant's kind of hands, and what is wrong with them."""
    expected, hands = _bodies(infant.anatomy), infant.anatomy.hands
    for side in SIDES:
        hand = infant.bodies.get(f"{side}_hand")
        fingers = [body.get("name") for body in hand.children if body.tag == "body"] if hand else []
        if hand is None or expected & set(fingers) or not fingers:
            continue
        if of_one_kind & set(fingers):
            yield hand, f"it has other fingers than the rest of this MIMo, whose hands are '{hands}'; use one kind"
        else:
            kinds = "MIMo's mittens have the body right_fingers, and its five fingers right_ffknuckle and so on"
            yield hand, f"an unknown hand: of its fingers ({', '.join(fingers)}), none is MIMo's; {kinds}"


def read_body(infant: Infant) -> dict[str, Any]:
    """Return the section `body` of a spec."""
    section: dict[str, Any] = {"hands": infant.anatomy.hands} if infant.anatomy.hands != HANDS[0] else {}
    if any(joint == CHEST_JOINT for joint in infant.hinges):
        section["chest_joint"] = True
    return section | ({"remove": infant.removed} if infant.removed else {})


def read_actuation(infant: Infant, model: mujoco.MjModel) -> dict[str, Any]:
    """Return the section `actuation` of a spec: its model, and what the scene locks or leaves without actuators."""
    groups = Counter(infant.hinges[joint] for joint in infant.motors.values())
    present = {model.actuator(index).name: index for index in range(model.nu)}
    driven = Counter(infant.hinges[joint] for name, joint in infant.motors.items() if name in present)
    locked = {group for group, wholly in locked_groups(infant).items() if wholly and group in groups}
    affine = int(mujoco.mjtBias.mjBIAS_AFFINE)
    servos = [name for name in infant.motors if name in present and model.actuator_biastype[present[name]] == affine]
    section: dict[str, Any] = {"model": "position"} if servos else {}
    if set(driven) - locked != set(groups) - locked:
        section["regions"] = named(set(driven) - locked)
    if locked:
        section["locked"] = named(locked)
    return section


def locked_groups(infant: Infant) -> dict[str, bool]:
    """Return the muscle groups of which the scene locks joints, and whether it locks all of the group's joints."""
    locked, joints = set(locks(infant)), infant.hinges
    return {
        group: all(joint in locked for joint, of in joints.items() if of == group)
        for group in sorted({joints[joint] for joint in locked})
    }


def locks(infant: Infant) -> Iterator[str]:
    """Yield the infant's joints that an active constraint of the scene locks."""
    for lock in _active_constraints(infant):
        if lock.tag == "joint" and not lock.get("joint2") and lock.get("joint1") in infant.hinges:
            yield lock.get("joint1")
        first, second = lock.get("body1"), lock.get("body2")
        child = first if infant.parents.get(first) == second else second
        if lock.tag == "weld" and second and infant.parents.get(child) in (first, second):
            body = infant.bodies.get(child)
            names = [joint.get("name") for joint in body.children if joint.tag == "joint"] if body else []
            yield from (name for name in names if name in infant.hinges)


def held_parts(infant: Infant) -> list[str]:
    """Return the infant's parts that the scene fixes in space."""
    home, movable = infant.home, infant.free_joint is not None
    names = {home.get("name"): HIP, FREE_JOINT: HIP} if home else {}
    welds = [lock for lock in _active_constraints(infant) if lock.tag == "weld" and not lock.get("body2")]
    bodies = [names.get(lock.get("body1"), lock.get("body1")) for lock in welds]
    known = [body for body in bodies if body in infant.parents]
    return list(dict.fromkeys(known if movable else [HIP, *known]))


def read_senses(model: mujoco.MjModel) -> dict[str, Any]:
    """Return the section `senses` of a spec: those with sensors in the scene."""
    names = [model.sensor(index).name for index in range(model.nsensor)]
    return {sense: {} for sense, start in SENSORS.items() if any(name.startswith(start) for name in names)}


def _active_constraints(infant: Infant) -> Iterator[Element]:
    for section in infant.tree.children:
        if section.tag == "equality":
            yield from (lock for lock in section.children if lock.get("active") not in ("false", "0"))


def _chain(root: Element, last: Element) -> list[Element]:
    """Return the elements from one to another below it, both included; nothing if that is not below it."""
    if root is last:
        return [root]
    for child in root.children:
        if below := _chain(child, last):
            return [root, *below]
    return []


TARGET, RAIL_OR_CRIB, ROOM = "target", "crib", "room"  # Bodies of MIMo's and BabyBench's scenes.
STANDING_M = 0.2  # Height of the hip above which an upright infant stands.
UPRIGHT, LYING = 0.7, 0.85  # Cosine of the angle up to which the trunk is upright, or lies.
STEP_MS = 10.0
DEFAULT = {"step_ms": STEP_MS, "timestep_ms": 5.0}
ROOM_SIDES_M = (1.0, 20.0)


def notes_on_surroundings(sections: dict[str, Any]) -> Iterator[str]:
    """Yield notes on what the spec's world is besides that of the scene."""
    kind = sections["scene"]["kind"]
    if "task" in sections:
        task = sections["task"]["kind"]
        yield f"it is taken for MIMo's scene of the task '{task}', which in mimoc brings its own pose and objects"
    elif kind in (ROOM, RAIL_OR_CRIB):
        yield f"the spec's {kind} is one of mimoc's; that of the scene is in the file beside it"


def read_surroundings(infant: Infant, model: mujoco.MjModel) -> dict[str, Any]:
    """Return the sections `scene`, `control` and `task` of a spec; a task brings its own pose and held parts."""
    task = _task(infant, model)
    scene: dict[str, Any] = {"kind": "flat"} if task else _scene(infant, model)
    timestep_ms = round(1000 * model.opt.timestep, 6)
    steps = max(1, math.ceil(STEP_MS / timestep_ms - 1e-6))
    control = {"step_ms": round(steps * timestep_ms, 6), "timestep_ms": timestep_ms}
    return {"scene": scene, "control": {} if control == DEFAULT else control} | (
        {"task": {"kind": task}} if task else {}
    )


def _task(infant: Infant, model: mujoco.MjModel) -> str:
    """Return the task that MIMo has a scene like this for, empty if there is none: they are known by their bodies."""
    bodies = {model.body(body).name: body for body in range(model.nbody)}
    if TARGET in bodies and _moves_freely(model, bodies[TARGET]):
        falls = bool(np.any(model.opt.gravity))
        return "catch" if falls and infant.anatomy.hands == "five_finger" else "reach"
    rail = bodies.get(RAIL_OR_CRIB)
    return "standup" if rail and not np.any(model.body_parentid[1:] == rail) and model.body_geomnum[rail] > 1 else ""


def _moves_freely(model: mujoco.MjModel, body: int) -> bool:
    free = mujoco.mjtJoint.mjJNT_FREE
    return bool(model.body_jntnum[body] == 1 and model.jnt_type[model.body_jntadr[body]] == free)


def _scene(infant: Infant, model: mujoco.MjModel) -> dict[str, Any]:
    """Return the section `scene`, without objects, of which the spec language has no list."""
    bodies = {model.body(body).name: body for body in range(model.nbody)}
    section: dict[str, Any] = {"kind": "flat" if mujoco.mjtGeom.mjGEOM_PLANE in model.geom_type else "empty"}
    if RAIL_OR_CRIB in bodies:
        section = {"kind": "crib"}
    elif ROOM in bodies and (sides_m := _room_sides(model, bodies[ROOM])):
        section = {"kind": "room", "room": {"size_m": [[side, side] for side in sides_m]}}
    held = held_parts(infant)
    return {**section, "pose": _pose(model)} | ({"held": held} if held else {})


def _room_sides(model: mujoco.MjModel, room: int) -> list[float]:
    """Return depth, width and height between the walls of a room, empty if a spec cannot say these."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    walls = [geom for geom in range(model.ngeom) if model.geom_bodyid[geom] == room]
    sides = []
    for axis in (0, 1):
        inner = [abs(data.geom_xpos[wall][axis]) - model.geom_size[wall][axis] for wall in walls]
        far = [side for wall, side in zip(walls, inner, strict=True) if abs(data.geom_xpos[wall][axis]) > side > 0]
        sides.append(round(2 * float(min(far)), 3) if far else 0.0)
    top = max((float(data.geom_xpos[wall][2] + model.geom_size[wall][2]) for wall in walls), default=0.0)
    sides.append(round(top, 3))
    low, high = ROOM_SIDES_M
    return sides if all(low <= side <= high for side in sides) else []


def _pose(model: mujoco.MjModel) -> str:
    """Return the pose that is nearest to that of the scene, by the direction of the trunk."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    forward, up = (float(data.body(HIP).xmat.reshape(3, 3)[2, axis]) for axis in (0, 2))
    if forward > LYING:
        return "supine"
    if forward < -LYING:
        return "prone"
    return "standing" if up > UPRIGHT and data.body(HIP).xpos[2] > STANDING_M else "sitting"
