"""What the runtime must know of a scene."""

from collections.abc import Mapping

from mimoc.actuation.spec import ActuationEntry, ActuatorEntry
from mimoc.body import FREE_JOINT, BodyTree
from mimoc.body.stature import stature
from mimoc.bundle.manifest import ChildEntry, FaceEntry, FasteningsEntry, LockEntry, Manifest, ToyEntry, WeldEntry
from mimoc.bundle.plugins_needed import needed_plugins
from mimoc.compiler.constraints import commanded_joints, hold_name, holds, locked_joints
from mimoc.compiler.furnish import start_pose
from mimoc.delays.presets import delays
from mimoc.looks.appearance import face_material
from mimoc.looks.expressions import FACES
from mimoc.mjcf.keypoints import KEYPOINTS, PREFIX
from mimoc.mjcf.mimo.lookups import lock_name
from mimoc.mjcf.placed import Placed
from mimoc.mjcf.tree import SceneTree
from mimoc.schema.infant import InfantSpec
from mimoc.senses.spec import SensesEntry
from mimoc.tasks.setup import NO_TASK, TaskSetup


def describe(
    spec: InfantSpec, tree: BodyTree, scene: SceneTree, senses: Mapping[str, Placed], stage: TaskSetup = NO_TASK
) -> Manifest:
    """Return the manifest of a scene."""
    return Manifest(
        name=spec.name,
        child=_child(spec, tree),
        root_body=scene.roots[0].name,
        root_joint=FREE_JOINT,
        timestep_ms=spec.control.timestep_ms,
        step_ms=spec.control.step_ms,
        pose=start_pose(spec, stage),
        poses=tuple(keyframe.name for keyframe in scene.keyframes),
        actuation=_actuation(spec, tree, scene, stage),
        senses=SensesEntry(**{name: placed.entry for name, placed in senses.items()}),
        delays=delays(spec, tree),
        fastenings=_fastenings(spec, tree, stage),
        task=stage.goal,
        plugins=needed_plugins(senses, stage.goal.kind, spec.actuation.model),
        face=FaceEntry(geom="head", materials={name: face_material(name) for name in FACES}),
        keypoints=tuple(PREFIX + name for name in KEYPOINTS),
    )


def describe_toys(scene: SceneTree) -> tuple[ToyEntry, ...]:
    """Return what the manifest says of the toys in a scene."""
    return tuple(
        ToyEntry(
            body=prop.name,
            joint=prop.joint,
            object=prop.object,
            category=prop.category,
            source=prop.source,
            size_m=prop.size_m,
            mass_kg=prop.mass_kg,
        )
        for prop in scene.world.toys
    )


def _child(spec: InfantSpec, tree: BodyTree) -> ChildEntry:
    measured = stature(tree)
    return ChildEntry(
        age_months=tree.age_months,
        sex=spec.body.individual and spec.body.individual.sex,
        length_cm=measured["length_cm"],
        weight_kg=measured["weight_kg"],
        head_circumference_cm=measured["head_circumference_cm"],
        arm_circumference_cm=measured["arm_circumference_cm"],
    )


def _fastenings(spec: InfantSpec, tree: BodyTree, stage: TaskSetup) -> FasteningsEntry:
    return FasteningsEntry(
        locks=tuple(LockEntry(equality=lock_name(joint), joint=joint) for joint in locked_joints(spec, tree, stage)),
        welds=tuple(WeldEntry(equality=hold_name(hold.body), body=hold.body) for hold in holds(spec, tree, stage)),
    )


def _actuation(spec: InfantSpec, tree: BodyTree, scene: SceneTree, stage: TaskSetup) -> ActuationEntry:
    commanded = commanded_joints(spec, tree, stage)
    actuators = tuple(
        ActuatorEntry(
            name=actuator.name,
            mimo_actuator=actuator.mimo_actuator,
            joint=actuator.joint,
            action_low=actuator.control_range[0],
            action_high=actuator.control_range[1],
            commanded=actuator.joint in commanded,
        )
        for actuator in scene.actuators
    )
    return ActuationEntry(model=spec.actuation.model, actuators=actuators)
