"""An infant put into the world of its spec, with toys around it."""

from dataclasses import dataclass, field, replace

import numpy as np

from mimoc.actuation.drives import Drive
from mimoc.body import BodyTree
from mimoc.body.kinematics import FloatArray
from mimoc.compiler.constraints import holds, keeps, lock, locked_joints, weld
from mimoc.errors import NoRoomError
from mimoc.kinds import function_of
from mimoc.mjcf.contact_pairs import barrier_pairs
from mimoc.mjcf.tree import Keyframe, Prop, SceneTree
from mimoc.random_streams import stream
from mimoc.scenes import SCENES
from mimoc.scenes.footprint import floor_reach, footprint, reach_of
from mimoc.scenes.placement import moved, put, put_prop
from mimoc.scenes.setting import WEIGHTLESS, Decor, Occupant, Setting
from mimoc.scenes.spec import SceneSpec
from mimoc.schema.infant import InfantSpec
from mimoc.tasks.setup import NO_TASK, TaskSetup, build_task
from mimoc.toys.builtin.build import BUILTIN_TOYS
from mimoc.toys.choosing import Toybox, choose_toys
from mimoc.toys.placing import Floor, Reach, place_toys
from mimoc.toys.props import make_prop


@dataclass(frozen=True, slots=True)
class Supplies:
    """What scenes are made of that does not follow from a spec alone."""

    decor: Decor = field(default_factory=Decor)
    """What rooms are decorated with."""
    toybox: Toybox = BUILTIN_TOYS
    """What toys there are."""


def set_up_task(scene: SceneTree, spec: InfantSpec, tree: BodyTree, drive: Drive) -> tuple[SceneTree, TaskSetup]:
    """Return the scene with one more pose, if the task of its spec starts from its own, and what the task needs.

    Poses in which what is held or locked would be elsewhere are left out: MuJoCo would tear the infant out of them.

    Raises:
        UnplayableError: If the infant lacks what the task is about, or a part that the spec holds.
    """
    stage = build_task(spec.task, tree)
    poses = scene.keyframes
    if spec.task and stage.start is not None:
        own = Keyframe(spec.task.kind, stage.start)
        poses = (*poses, drive.keyframe(own))
    (start,) = (pose for pose in poses if pose.name == start_pose(spec, stage))
    joints, held = locked_joints(spec, tree, stage), holds(spec, tree, stage)
    kept = tuple(pose for pose in poses if keeps(joints, held, tree, start.qpos, pose.qpos))
    return replace(scene, keyframes=kept), stage


def start_pose(spec: InfantSpec, stage: TaskSetup) -> str:
    """Return the name of the keyframe that a reset starts from."""
    return spec.scene.pose if spec.task is None or stage.start is None else spec.task.kind


def outline(scene: SceneTree, spec: SceneSpec, tree: BodyTree) -> FloatArray:
    """Return the discs of floor that an infant takes up in all its poses, shape (n, 3); none where nobody asks."""
    if spec.toys is None and spec.kind in ("empty", "flat"):
        return np.empty((0, 3))
    return footprint(tree, [pose.qpos for pose in scene.keyframes])


def furnish(
    scene: SceneTree,
    spec: InfantSpec,
    tree: BodyTree,
    supplies: Supplies,
    stage: TaskSetup = NO_TASK,
    discs: FloatArray | None = None,
) -> SceneTree:
    """Return a scene with the world of its spec, and the infant's poses where they are in that.

    Args:
        scene: The infant, with its poses resting on the floor at the origin.
        spec: What is wanted.
        tree: The infant's body.
        supplies: What to make the world of.
        stage: What its task needs.
        discs: The infant's `outline`, if it is known already: it is the same for every seed.

    Raises:
        NoRoomError: If there is no room for a toy.
        ToyError: If nothing can be made of a toy.
        UnplayableError: If the spec holds a part that the infant does not have.
    """
    discs = outline(scene, spec.scene, tree) if discs is None else discs
    build = function_of(SCENES[spec.scene.kind].build, "build")
    setting: Setting = build(spec.scene, Occupant(tree, discs), supplies.decor)
    starts = {pose.name: put(pose, setting.start) for pose in scene.keyframes}
    start = starts[start_pose(spec, stage)]
    taken = np.concatenate([discs, np.reshape(stage.taken, (-1, 3))])
    toys = _toys(spec.scene, setting, tree, start, moved(taken, setting.start), supplies.toybox)
    world = replace(
        setting.world,
        infant_at=(setting.start.x_m, setting.start.y_m, setting.start.yaw_rad),
        toys=toys,
        apparatus=tuple(put_prop(prop, setting.start) for prop in stage.props),
        furniture=setting.world.furniture + stage.furniture,
        locks=lock(locked_joints(spec, tree, stage), tree, start.qpos),
        welds=weld(holds(spec, tree, stage), tree, start.qpos),
        gravity_m_s2=WEIGHTLESS if stage.weightless else setting.world.gravity_m_s2,
    )
    world = replace(world, pairs=barrier_pairs(world, scene.roots))
    resting = tuple(number for prop in world.props for number in (*prop.pos_m, *prop.quat))
    keyframes = tuple(replace(pose, qpos=(*pose.qpos, *resting)) for pose in starts.values())
    return replace(scene, world=world, keyframes=keyframes)


def _toys(
    spec: SceneSpec, setting: Setting, tree: BodyTree, start: Keyframe, taken: FloatArray, toybox: Toybox
) -> tuple[Prop, ...]:
    """Return the toys of a scene, around where the infant starts and clear of the discs that are taken."""
    if spec.toys is None:
        return ()
    toys = choose_toys(spec.toys, spec.seed, toybox)
    here = start.qpos
    reach = floor_reach(tree, here) or Reach((here[0], here[1]), reach_of(taken - (*here[:2], 0.0)), 0.1)
    places = place_toys(
        [toy.radius_m for toy in toys], reach, Floor(setting.half_size_m, taken), stream(spec.seed, "toys.place")
    )
    if places is None:
        raise NoRoomError(
            f"there is no room for {len(toys)} toys around the infant; use fewer, smaller ones or a larger room"
        )
    return tuple(make_prop(toy, number, place) for number, (toy, place) in enumerate(zip(toys, places, strict=True), 1))
