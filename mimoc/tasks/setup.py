"""The setup of a task: what it requires of an infant and adds to its world."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from mimoc.body import BodyTree
from mimoc.errors import UnsupportedTaskError
from mimoc.geometry.rotations import Vec3
from mimoc.kinds import function_of
from mimoc.mjcf.furniture import BARE, Furniture
from mimoc.mjcf.world import FreeObject
from mimoc.tasks import TASKS
from mimoc.tasks.base import TaskEntry, TaskSpec
from mimoc.tasks.free import FreeEntry

Side = Literal["right", "left"]


@dataclass(frozen=True, slots=True)
class Hold:
    """A part of the infant that is fixed at its starting position."""

    body: str
    anchor_m: Vec3 = (0.0, 0.0, 0.0)
    """The fixed point, in the frame of the body."""
    turns: bool = False
    """Whether the part can rotate about that point."""


@dataclass(frozen=True, slots=True)
class TaskSetup:
    """The setup of a task; positions are for an infant at the origin that faces along x."""

    entry: TaskEntry
    """The task's entry in the manifest."""
    start: tuple[float, ...] | None = None
    """Starting state as qpos; None means the pose of the spec."""
    commanded: Collection[str] | None = None
    """The commanded joints; None means all."""
    locked: Collection[str] = ()
    """Joints that are locked at their starting angles."""
    holds: tuple[Hold, ...] = ()
    """Parts that are held at their starting positions."""
    objects: tuple[FreeObject, ...] = ()
    """Movable objects that are added to the world."""
    furniture: Furniture = BARE
    """Fixed objects that are added to the world."""
    taken: tuple[Vec3, ...] = ()
    """Floor area occupied by these, where no toy is placed: discs by x, y and radius, in [m]."""
    weightless: bool = False
    """Whether there is no gravity."""


NO_TASK = TaskSetup(FreeEntry())
"""Setup of an infant without a task."""


def build_task(spec: TaskSpec | None, tree: BodyTree) -> TaskSetup:
    """Return the setup of a spec's task.

    Raises:
        UnsupportedTaskError: If the infant lacks what the task requires.
    """
    return function_of(TASKS[spec.kind].build, "build")(spec, tree) if spec else NO_TASK


def require(tree: BodyTree, task: str, *bodies: str) -> None:
    """Check that an infant has the limbs that a task requires.

    Raises:
        UnsupportedTaskError: If it does not.
    """
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
