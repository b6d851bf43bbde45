"""The manifest of a scene, with the names of the parts that the runtime and controllers use."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Literal

from mimoc.anatomy.parts import PARTS
from mimoc.base.kinds import Registry
from mimoc.base.rounding import rounded
from mimoc.body.kinematics import stature
from mimoc.body.tree import FREE_JOINT, BodyTree
from mimoc.bundle.manifest import (
    AnatomyEntry,
    ChildEntry,
    ConstraintsEntry,
    EyeEntry,
    FaceEntry,
    LimbEntry,
    LockEntry,
    Manifest,
    ToyEntry,
    WeldEntry,
)
from mimoc.compiler.actuation import voice_of
from mimoc.compiler.constraints import commanded_joints, hold_name, holds, locked_joints
from mimoc.compiler.looks.appearance import face_material
from mimoc.compiler.mjcf.scene import Placed, SceneTree
from mimoc.compiler.mjcf.sensor_sites import KEYPOINTS, PREFIX
from mimoc.compiler.mjcf.world import FreeObject
from mimoc.compiler.objects.built_object import PlacedThing
from mimoc.compiler.placing import start_pose
from mimoc.compiler.presets import delays, noise
from mimoc.compiler.task_setup import TaskSetup
from mimoc.schema.actuation import ActuationEntry, ActuatorEntry
from mimoc.schema.body import EXPRESSIONS
from mimoc.schema.caregiver import CaregiverEntry
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import ACTUATIONS, OBJECTS, SCENES, SENSES, TASKS, TOY_SOURCES
from mimoc.schema.objects import ObjectEntry
from mimoc.schema.senses import SensesEntry

Side = Literal["left", "right"]
Ends = tuple[str, str]  # Names of two things, with `{side}`.

HEAD = "head"
ARM: Ends = ("{side}_upper_arm", "{side}_hand")  # First and last body; fingers are parts of the hand.
LEG: Ends = ("{side}_upper_leg", "{side}_foot")  # First and last body; toes are parts of the foot.
EYE: Ends = ("{side}_eye", "eye_{side}")  # Body and camera.

LIMB_SIDES: tuple[Side, Side] = ("right", "left")
EYE_SIDES: tuple[Side, Side] = ("left", "right")  # Sides in MIMo's order.


def describe_anatomy(tree: BodyTree) -> AnatomyEntry:
    """Return the anatomy of a body for the manifest."""
    bodies = {body.name for body in tree.bodies}
    groups: dict[str, list[str]] = {}
    for joint, group in tree.muscle_groups.items():
        groups.setdefault(group, []).append(joint)
    return AnatomyEntry(
        head=HEAD if HEAD in bodies else None,
        trunk=tuple(body.name for body in tree.bodies if body.region == "trunk"),
        arms=tuple(_limbs(ARM, bodies)),
        legs=tuple(_limbs(LEG, bodies)),
        eyes=tuple(
            EyeEntry(side=side, body=EYE[0].format(side=side), camera=EYE[1].format(side=side))
            for side in EYE_SIDES
            if EYE[0].format(side=side) in bodies
        ),
        groups={group: tuple(joints) for group, joints in sorted(groups.items())},
    )


def _limbs(ends: Ends, bodies: set[str]) -> Iterator[LimbEntry]:
    for side in LIMB_SIDES:
        root, end = (name.format(side=side) for name in ends)
        if root in bodies:
            yield LimbEntry(side=side, root=root, end=end if end in bodies else None)


def make_manifest(
    spec: InfantSpec, tree: BodyTree, scene: SceneTree, senses: Mapping[str, Placed], setup: TaskSetup
) -> Manifest:
    """Return the manifest of a scene, numbers rounded as in its file."""
    child = ChildEntry(
        age_months=spec.age_months,
        months_early=spec.months_early,
        sex=spec.body.individual and spec.body.individual.sex,
        clothes=spec.clothes,
        size_is_known=spec.body.size_is_known,
        **stature(tree),
    )
    locked, held = locked_joints(spec, tree, setup), holds(spec, tree, setup)
    commanded = commanded_joints(spec, tree, setup)
    voice = voice_of(tree) if spec.actuation.voice else None
    actuation = ActuationEntry(
        model=spec.actuation.model,
        arousal=spec.actuation.arousal,
        bandwidth_hz=spec.actuation.bandwidth_hz,
        actuators=tuple(
            ActuatorEntry(
                name=actuator.name,
                mimo_actuator=actuator.mimo_actuator,
                joint=actuator.joint,
                action_low=actuator.control_range[0],
                action_high=actuator.control_range[1],
                tone=actuator.tone,
                commanded=actuator.joint in commanded,
            )
            for actuator in scene.actuators
        ),
    ).model_copy(update={"voice": voice})
    # The distributions of a spec's kinds that are not part of mimoc, by section and name (`senses.sound`).
    manifest = Manifest(
        name=spec.name,
        child=child,
        root_body=scene.roots[0].name,
        root_joint=FREE_JOINT,
        timestep_ms=spec.control.timestep_ms,
        step_ms=spec.control.step_ms,
        pose=start_pose(spec, setup),
        poses=tuple(keyframe.name for keyframe in scene.keyframes),
        actuation=actuation,
        anatomy=describe_anatomy(tree),
        senses=SensesEntry(**{name: placed.entry for name, placed in senses.items()}),
        delays=delays(spec, tree),
        noise=noise(spec, [actuator.joint for actuator in actuation.actuators if actuator.commanded]),
        constraints=ConstraintsEntry(
            locks=tuple(LockEntry(equality=joint, joint=joint) for joint in locked),
            welds=tuple(WeldEntry(equality=hold_name(hold.body), body=hold.body) for hold in held),
        ),
        task=setup.entry,
        face=FaceEntry(
            geom="head",
            materials={name: face_material(name) for name in EXPRESSIONS},
            skin="head" if scene.skin else None,
            begins=spec.body.expression if scene.skin else "neutral",
            shapes=tuple(name for name in EXPRESSIONS if name != "neutral") if scene.skin else (),
        ),
        keypoints=tuple(PREFIX + name for name in KEYPOINTS),
        plugins={
            f"{group}.{name}": kinds.distribution(name)
            for group, kinds, name in _used_kinds(spec)
            if kinds.distribution(name) != "mimoc"
        },
    )
    return Manifest.model_validate(rounded(manifest.model_dump()))


def describe_toys(toys: Iterable[FreeObject]) -> tuple[ToyEntry, ...]:
    """Return the entries of toys in the manifest."""
    keys = ("joint", "object", "category", "source", "size_m", "mass_kg")
    data = ({"body": toy.name, **{key: getattr(toy, key) for key in keys}} for toy in toys)
    return tuple(map(ToyEntry.model_validate, map(rounded, data)))


def describe_objects(things: Iterable[PlacedThing]) -> tuple[ObjectEntry, ...]:
    """Return the entries of objects in the manifest."""
    return tuple(ObjectEntry.model_validate(rounded(thing.entry.model_dump())) for thing in things)


def rounded_caregiver(entry: CaregiverEntry | None) -> CaregiverEntry | None:
    """Return the entry of a caregiver with numbers as in files."""
    return entry and CaregiverEntry.model_validate(rounded(entry.model_dump()))


def _used_kinds(spec: InfantSpec) -> Iterator[tuple[str, Registry[Any], str]]:
    """Yield the group, the table and the name of each kind that a spec uses."""
    for name in SENSES:
        if getattr(spec.senses, name) is not None:
            yield "senses", SENSES, name
    yield "actuation", ACTUATIONS, spec.actuation.model
    for name in (spec.body.hands, *(spec.body.extra or ())):
        yield "parts", PARTS, name
    if spec.task:
        yield "tasks", TASKS, spec.task.kind
    yield "scenes", SCENES, spec.scene.kind
    for item in spec.scene.objects:
        yield "objects", OBJECTS, item.kind
    if spec.scene.toys:
        yield "toys", TOY_SOURCES, spec.scene.toys.source
