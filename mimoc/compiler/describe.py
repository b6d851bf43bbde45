"""What the runtime must know of a scene."""

from mimoc.body import FREE_JOINT, BodyTree
from mimoc.body.stature import stature
from mimoc.bundle.manifest import (
    ActuationEntry,
    ActuatorEntry,
    ChildEntry,
    FaceEntry,
    FasteningsEntry,
    LockEntry,
    Manifest,
    ProprioceptionEntry,
    SensesEntry,
    TouchEntry,
    ToyEntry,
    VestibularEntry,
    VisionEntry,
    WeldEntry,
)
from mimoc.compiler.constraints import commanded_joints, hold_name, holds, locked_joints
from mimoc.compiler.furnish import start_pose
from mimoc.delays.presets import delays
from mimoc.looks.appearance import face_material
from mimoc.looks.expressions import FACES
from mimoc.mjcf import sensor_sites
from mimoc.mjcf.keypoints import KEYPOINTS, PREFIX
from mimoc.mjcf.mimo.lookups import lock_name
from mimoc.mjcf.tree import SceneTree
from mimoc.schema.infant import InfantSpec
from mimoc.senses.spec import TouchSpec, VestibularSpec, VisionSpec
from mimoc.senses.touch.skin_points import Skin
from mimoc.senses.vision.acuity_by_age import resolve_acuity
from mimoc.tasks.free.build import FREE
from mimoc.tasks.setups import Stage


def describe(spec: InfantSpec, tree: BodyTree, scene: SceneTree, stage: Stage = FREE) -> Manifest:
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
        senses=_senses(spec, tree, scene),
        delays=delays(spec, tree),
        fastenings=_fastenings(spec, tree, stage),
        task=stage.goal,
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


def _fastenings(spec: InfantSpec, tree: BodyTree, stage: Stage) -> FasteningsEntry:
    return FasteningsEntry(
        locks=tuple(LockEntry(equality=lock_name(joint), joint=joint) for joint in locked_joints(spec, tree, stage)),
        welds=tuple(WeldEntry(equality=hold_name(hold.body), body=hold.body) for hold in holds(spec, tree, stage)),
    )


def _actuation(spec: InfantSpec, tree: BodyTree, scene: SceneTree, stage: Stage) -> ActuationEntry:
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


def _senses(spec: InfantSpec, tree: BodyTree, scene: SceneTree) -> SensesEntry:
    proprioception = spec.senses.proprioception and ProprioceptionEntry(
        include=spec.senses.proprioception.include,
        joints=tuple(tree.joints),
        torque_sensors=tuple(sensor.name for sensor in sensor_sites.torque_sensors(tree)),
    )
    return SensesEntry(
        proprioception=proprioception,
        vestibular=spec.senses.vestibular and _vestibular(spec.senses.vestibular),
        touch=_touch(spec.senses.touch, scene.skin) if spec.senses.touch and scene.skin else None,
        vision=spec.senses.vision and _vision(spec.senses.vision, spec.age_months, tree),
    )


def _vestibular(vestibular: VestibularSpec) -> VestibularEntry:
    names = {sensor.kind: sensor.name for sensor in sensor_sites.VESTIBULAR_SENSORS}
    felt = {kind: name for kind, name in names.items() if kind in vestibular.include}
    return VestibularEntry(accelerometer=felt.get("accelerometer"), gyro=felt.get("gyro"))


def _touch(touch: TouchSpec, skin: Skin) -> TouchEntry:
    return TouchEntry(
        quantity=touch.quantity,
        response=touch.response,
        points_m={body: tuple((x, y, z) for x, y, z in points.tolist()) for body, points in skin.points_m.items()},
        spacing_m=dict(skin.spacing_m),
    )


def _vision(vision: VisionSpec, age_months: float, tree: BodyTree) -> VisionEntry:
    return VisionEntry(
        cameras=tuple(camera.name for eye in sensor_sites.cameras(tree, vision.fovy_deg).values() for camera in eye),
        width_px=vision.width_px,
        height_px=vision.height_px,
        supersample=vision.supersample,
        acuity_cpd=resolve_acuity(vision, age_months),
        foveation=vision.foveation,
        foveation_radius=vision.foveation_radius,
        unseen=sensor_sites.UNSEEN,
    )
