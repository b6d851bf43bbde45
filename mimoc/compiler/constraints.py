"""Constraints of an infant: locked joints and parts that are held in place."""

from collections.abc import Collection, Sequence

import numpy as np

from mimoc.base.errors import UnsupportedTaskError
from mimoc.base.geometry.rotations import quaternion_from_matrix
from mimoc.body.kinematics import frames_in_world
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.world import Lock, Weld
from mimoc.compiler.task_setup import Hold, TaskSetup
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import single_groups

SAME = 1e-6  # Tolerance, in [m] or [rad], within which two poses count as satisfying the same constraint.
FIRM, LOOSE = 1.0, 0.0  # `torquescale` of a part whose orientation is fixed, and of one that can turn about a point.


def locked_joints(spec: InfantSpec, tree: BodyTree, setup: TaskSetup) -> tuple[str, ...]:
    """Return the hinges that are locked, by the spec or for its task, in the order of the body."""
    groups, by_task = single_groups(spec.actuation.locked), set(setup.locked)
    return tuple(joint for joint, group in tree.muscle_groups.items() if group in groups or joint in by_task)


def commanded_joints(spec: InfantSpec, tree: BodyTree, setup: TaskSetup) -> Collection[str]:
    """Return the commanded hinges: those in the spec's regions that its task uses and that are not locked.

    Raises:
        UnsupportedTaskError: If the task has no commanded hinge.
    """
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
    """Return the parts that are held, by the task or by the spec, each once.

    Raises:
        UnsupportedTaskError: If the spec holds a part that this infant does not have.
    """
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
        quat, torquescale = quaternion_from_matrix(rotation), LOOSE if hold.turns else FIRM
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
