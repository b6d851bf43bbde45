"""The setup of a task: what it adds to the world, such as a ball, and which joints it locks, commands and holds."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from mimoc.base.errors import UnsupportedTaskError
from mimoc.base.geometry.rotations import Vec3, quaternion_from_matrix
from mimoc.base.kinds import function_of
from mimoc.body.kinematics import frames_in_world
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.elements import BARE, Furniture, WorldMaterial
from mimoc.compiler.mjcf.world import FreeObject, Lock, ObjectGeom, Weld
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import TASKS
from mimoc.schema.names import single_groups
from mimoc.schema.task import BallEntry, TaskEntry, TaskSpec, no_task

Side = Literal["left", "right"]


@dataclass(frozen=True, slots=True)
class Hold:
    """A part of the infant that is fixed at its starting position."""

    body: str
    anchor_m: Vec3 = (0.0, 0.0, 0.0)  # The fixed point, in the frame of the body.
    turns: bool = False  # Whether the part can rotate about that point.


@dataclass(frozen=True, slots=True)
class TaskSetup:
    """The setup of a task; positions are for an infant at the origin that faces along x."""

    entry: TaskEntry  # The task's entry in the manifest.
    start: tuple[float, ...] | None = None  # Starting state as qpos; None means the pose of the spec.
    commanded: Collection[str] | None = None  # The commanded joints; None means all.
    locked: Collection[str] = ()  # Joints that are locked at their starting angles.
    holds: tuple[Hold, ...] = ()  # Parts that are held at their starting positions.
    objects: tuple[FreeObject, ...] = ()  # Movable objects that are added to the world.
    furniture: Furniture = BARE  # Fixed objects that are added to the world.
    taken: tuple[Vec3, ...] = ()
    """Floor area occupied by these, where no toy is placed: discs by x, y and radius, in [m]."""
    weightless: bool = False  # Whether there is no gravity.
    ahead_m: float = 0.0  # How far ahead of the infant the furniture is that it starts at.


NO_TASK = TaskSetup(no_task())  # Setup of an infant without a task.


def build_task(spec: TaskSpec | None, tree: BodyTree, step_ms: float) -> TaskSetup:
    """Return the setup of a spec's task, which takes as long with a control step, *step_ms*, as with the task's own.

    An entry counts in the task's own steps. Each of its keys `steps` or `*_steps` becomes as many of *step_ms* as last
    as long, at least one, unless the spec gives it: 500 steps of 10 ms are 250 of 20 ms.

    """
    if spec is None:
        return NO_TASK
    kind = TASKS[spec.kind]
    setup: TaskSetup = function_of(kind.build, "build")(spec, tree)
    counts = {key: count for key, count in setup.entry if f"_{key}".endswith("_steps") and type(count) is int and count}
    chosen = {key for key in counts if getattr(spec, key, None)}
    steps = {key: max(1, round(counts[key] * kind.step_ms / step_ms)) for key in counts.keys() - chosen}
    return replace(setup, entry=setup.entry.model_copy(update=steps))


def require(tree: BodyTree, task: str, *bodies: str) -> None:
    """Check that an infant has the limbs that a task requires; raise an UnsupportedTaskError if it does not."""
    missing = sorted(set(bodies) - {body.name for body in tree.bodies})
    if missing:
        raise UnsupportedTaskError(f"task '{task}' requires {' and '.join(missing)}, which this infant does not have")


def joints_of(tree: BodyTree, *groups: str) -> tuple[str, ...]:
    """Return the hinges of some muscle groups, each with its side (`left_arm`), in the order of the body."""
    return tuple(joint for joint, group in tree.muscle_groups.items() if group in groups)


def bodies_of(tree: BodyTree, group: str) -> tuple[str, ...]:
    """Return the parts that belong to a muscle group with its side."""
    return tuple(body for body, of_body in tree.body_groups.items() if of_body == group)


def one_armed(
    tree: BodyTree,
    side: Side,
    entry: TaskEntry,
    start: tuple[float, ...],
    objects: tuple[FreeObject, ...] = (),
    *,
    weightless: bool = False,
) -> TaskSetup:
    """Return the setup of a one-handed task: only that arm moves, and the infant is held at the hip."""
    arm = joints_of(tree, f"{side}_arm", f"{side}_hand")
    return TaskSetup(
        entry=entry,
        start=start,
        commanded=arm,
        locked=[joint for joint in tree.joints if joint not in arm],
        holds=(Hold("hip"),),
        objects=objects,
        weightless=weightless,
    )


def middle_finger(tree: BodyTree, side: Side) -> str:
    """Return the body in the middle of the fingers, which represents all of them."""
    return f"{side}_mfmiddle" if tree.hands == "five_finger" else f"{side}_fingers"


NAME = "ball"
BALL = BallEntry(body="target", joint="target_joint", geom=NAME)  # Names of its body and joint: MIMo's.
RADIUS_M = 0.025  # Radius of the ball in MIMo's reaching task.
DENSITY_KG_M3 = 1000.0
RED = WorldMaterial(NAME, (0.85, 0.16, 0.12, 1.0), specular=0.4, shininess=0.5)


def ball(pos_m: Vec3, radius_m: float = RADIUS_M) -> FreeObject:
    """Return a red ball with the density of water."""
    mass_kg = DENSITY_KG_M3 * 4 / 3 * math.pi * radius_m**3
    geom = ObjectGeom(
        name=BALL.geom,
        type="sphere",
        material=RED.name,
        sizes=(("size", (radius_m,)),),
        mass_kg=mass_kg,
        condim=6,
    )
    return FreeObject(
        name=BALL.body,
        object=NAME,
        category=NAME,
        source="mimoc",
        joint=BALL.joint,
        pos_m=pos_m,
        quat=(1.0, 0.0, 0.0, 0.0),
        size_m=2 * radius_m,
        mass_kg=mass_kg,
        density_kg_m3=DENSITY_KG_M3,
        geoms=(geom,),
        materials=(RED,),
        meshes=(),
    )


SAME = 1e-6  # Tolerance, in [m] or [rad], within which two poses count as satisfying the same constraint.
FIRM, LOOSE = 1.0, 0.0  # `torquescale` of a part whose orientation is fixed, and of one that can turn about a point.


def locked_joints(spec: InfantSpec, tree: BodyTree, setup: TaskSetup) -> tuple[str, ...]:
    """Return the hinges that are locked, by the spec or for its task, in the order of the body."""
    groups = single_groups(spec.actuation.locked)
    by_task = set(setup.locked)
    return tuple(joint for joint, group in tree.muscle_groups.items() if group in groups or joint in by_task)


def commanded_joints(spec: InfantSpec, tree: BodyTree, setup: TaskSetup) -> Collection[str]:
    """Return the hinges that are commanded: those in the spec's regions that its task uses and that are not locked."""
    regions = spec.actuation.regions
    groups = None if regions is None else single_groups(regions)
    locked = set(locked_joints(spec, tree, setup))
    commanded = {
        joint
        for joint, group in tree.muscle_groups.items()
        if (groups is None or group in groups)
        and (setup.commanded is None or joint in setup.commanded)
        and joint not in locked
    }
    if setup.commanded is not None and commanded.isdisjoint(motor.joint for motor in tree.motors):
        key = "locked" if regions is None else "regions"
        raise UnsupportedTaskError(
            f"none of this infant's commanded actuators moves a joint of task '{setup.entry.kind}'; "
            + ("choose other groups" if regions is not None else "lock fewer groups"),
            ("actuation", key),
        )
    return commanded


def holds(spec: InfantSpec, tree: BodyTree, setup: TaskSetup) -> tuple[Hold, ...]:
    """Return the parts that are held, by the task or by the spec, each once; UnsupportedTaskError if one is missing."""
    bodies = {body.name for body in tree.bodies}
    homes = {tree.home(name): name for name in spec.scene.held}
    for home, name in homes.items():
        if home not in bodies:
            raise UnsupportedTaskError(f"this infant has no '{name}' to hold; remove it", ("scene", "held"))
    by_task = {hold.body for hold in setup.holds}
    return (*setup.holds, *(Hold(home) for home in homes if home not in by_task))


def hold_name(body: str) -> str:
    """Return the name of the constraint that holds a part."""
    return f"hold:{body}"


def lock(joints: Collection[str], tree: BodyTree, state: Sequence[float]) -> tuple[Lock, ...]:
    """Return constraints that lock some hinges at their angles in a state (qpos), and inactive ones for the others.

    MIMo's code looks each up by the name of its hinge.
    """
    return tuple(
        Lock(name=joint, joint=joint, angle_rad=angle_rad if joint in joints else 0.0, active=joint in joints)
        for joint, angle_rad in zip(tree.joints, state[7:], strict=False)
    )


def weld(held: Collection[Hold], tree: BodyTree, state: Sequence[float]) -> tuple[Weld, ...]:
    """Return constraints that fix some parts at their poses in a state (qpos)."""
    placed = frames_in_world(tree, state) if held else {}
    welds = []
    for hold in held:
        origin, rotation = placed[hold.body]
        x, y, z = (origin + rotation @ hold.anchor_m).tolist()
        quat = quaternion_from_matrix(rotation)
        torquescale = LOOSE if hold.turns else FIRM
        welds.append(Weld(hold_name(hold.body), hold.body, hold.anchor_m, (x, y, z), quat, torquescale))
    return tuple(welds)


def keeps(
    joints: Collection[str], held: Collection[Hold], tree: BodyTree, start: Sequence[float], state: Sequence[float]
) -> bool:
    """Return whether a state (qpos) has locked hinges and held parts at their starting poses."""
    if not joints and not held:
        return True
    lock_now, lock_at_start = lock(joints, tree, state), lock(joints, tree, start)
    if any(abs(mine.angle_rad - theirs.angle_rad) > SAME for mine, theirs in zip(lock_now, lock_at_start, strict=True)):
        return False
    places = [
        np.array([[*pose.pos_m, *(pose.torquescale * np.array(pose.quat))] for pose in weld(held, tree, at)])
        for at in (start, state)
    ]
    return bool(np.allclose(*places, rtol=0.0, atol=SAME))
