"""What the runtime must know of a scene."""

from mimoc.body import FREE_JOINT, BodyTree
from mimoc.body.stature import stature
from mimoc.scene import instruments
from mimoc.scene.appearance import face_material
from mimoc.scene.faces import FACES
from mimoc.scene.keypoints import KEYPOINTS, PREFIX
from mimoc.scene.tree import SceneTree
from mimoc.schema import InfantSpec, SensesSpec
from mimoc.schema.manifest import (
    ActuationEntry,
    ActuatorEntry,
    ChildEntry,
    FaceEntry,
    Manifest,
    ProprioceptionEntry,
    SensesEntry,
    VestibularEntry,
)


def describe(spec: InfantSpec, tree: BodyTree, scene: SceneTree) -> Manifest:
    """Return the manifest of a scene."""
    return Manifest(
        name=spec.name,
        child=_child(spec, tree),
        root_body=tree.bodies[0].name,
        root_joint=FREE_JOINT,
        timestep_ms=spec.control.timestep_ms,
        step_ms=spec.control.step_ms,
        pose=spec.scene.pose,
        poses=tuple(keyframe.name for keyframe in scene.keyframes),
        actuation=ActuationEntry(model=spec.actuation.model, actuators=tuple(_actuators(scene))),
        senses=_senses(spec.senses, tree),
        face=FaceEntry(geom="head", materials={name: face_material(name) for name in FACES}),
        keypoints=tuple(PREFIX + name for name in KEYPOINTS),
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


def _actuators(scene: SceneTree) -> list[ActuatorEntry]:
    return [
        ActuatorEntry(
            name=actuator.name,
            mimo_actuator=actuator.mimo_actuator,
            joint=actuator.joint,
            action_low=actuator.control_range[0],
            action_high=actuator.control_range[1],
        )
        for actuator in scene.actuators
    ]


def _senses(senses: SensesSpec, tree: BodyTree) -> SensesEntry:
    proprioception = senses.proprioception and ProprioceptionEntry(
        include=senses.proprioception.include,
        joints=tuple(tree.joints),
        torque_sensors=tuple(sensor.name for sensor in instruments.torque_sensors(tree)),
    )
    accelerometer, gyro = instruments.VESTIBULAR_SENSORS
    vestibular = senses.vestibular and VestibularEntry(accelerometer=accelerometer.name, gyro=gyro.name)
    return SensesEntry(proprioception=proprioception, vestibular=vestibular)
