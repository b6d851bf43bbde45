"""What a task makes of an infant and its world."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from mimoc.body import BodyTree
from mimoc.body.strength import body_groups, muscle_groups
from mimoc.errors import UnsupportedTaskError
from mimoc.geometry.rotations import Vec3
from mimoc.kinds import function_of
from mimoc.mjcf.furniture import BARE, Furniture
from mimoc.mjcf.objects import FreeObject
from mimoc.tasks import TASKS
from mimoc.tasks.base import TaskEntry, TaskSpec
from mimoc.tasks.free.spec import FreeEntry

Side = Literal["right", "left"]


@dataclass(frozen=True, slots=True)
class Hold:
    """A part of the infant that is kept where it starts."""

    body: str
    anchor_m: Vec3 = (0.0, 0.0, 0.0)
    """The point that is kept, in the frame of the body."""
    turns: bool = False
    """Whether it may turn about that point."""


@dataclass(frozen=True, slots=True)
class TaskSetup:
    """What a task needs; places are those of an infant at the origin that looks along x."""

    entry: TaskEntry
    """What the runtime must know of the task."""
    start: tuple[float, ...] | None = None
    """How the infant starts, as qpos; None is in the pose of the spec."""
    commanded: Collection[str] | None = None
    """The joints that take commands; None is all of them."""
    locked: Collection[str] = ()
    """Joints that are kept at their angles."""
    holds: tuple[Hold, ...] = ()
    """Parts that are kept where they are."""
    props: tuple[FreeObject, ...] = ()
    """What else is there that moves."""
    furniture: Furniture = BARE
    """What else is there that does not."""
    taken: tuple[Vec3, ...] = ()
    """What that takes up of the floor, where no toy is put: discs by x, y and radius, in [m]."""
    weightless: bool = False
    """Whether there is no gravity."""


NO_TASK = TaskSetup(FreeEntry())
"""Of an infant that is to achieve nothing."""


def build_task(spec: TaskSpec | None, tree: BodyTree) -> TaskSetup:
    """Return what the task of a spec needs.

    Raises:
        UnsupportedTaskError: If the infant lacks what the task requires.
    """
    return function_of(TASKS[spec.kind].build, "build")(spec, tree) if spec else NO_TASK


def require(tree: BodyTree, task: str, *bodies: str) -> None:
    """Pass an infant that has the limbs that a task is about.

    Raises:
        UnsupportedTaskError: If it has not.
    """
    missing = sorted(set(bodies) - {body.name for body in tree.bodies})
    if missing:
        raise UnsupportedTaskError(f"task '{task}' requires {' and '.join(missing)}, which this infant does not have")


def joints_of(tree: BodyTree, *groups: str) -> tuple[str, ...]:
    """Return the hinges of some groups of muscles, each with its side (`left_arm`), in the order of the body."""
    return tuple(joint for joint, group in muscle_groups(tree).items() if group in groups)


def bodies_of(tree: BodyTree, group: str) -> tuple[str, ...]:
    """Return the parts that belong to a group of muscles, with its side."""
    return tuple(body for body, found in body_groups(tree).items() if found == group)


def one_armed(
    tree: BodyTree,
    side: Side,
    entry: TaskEntry,
    start: tuple[float, ...],
    props: tuple[FreeObject, ...] = (),
    *,
    weightless: bool = False,
) -> TaskSetup:
    """Return the setup of a task of one hand: only that arm moves, and the infant is held at the hip."""
    arm = joints_of(tree, f"{side}_arm", f"{side}_hand")
    return TaskSetup(
        entry=entry,
        start=start,
        commanded=arm,
        locked=[joint for joint in tree.joints if joint not in arm],
        holds=(Hold("hip"),),
        props=props,
        weightless=weightless,
    )


def middle_finger(tree: BodyTree, side: Side) -> str:
    """Return the body at the middle of the fingers, which stands for all of them."""
    return f"{side}_fingers" if tree.hands == "mitten" else f"{side}_mfmiddle"
