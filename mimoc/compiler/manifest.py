"""The manifest of a scene: the parts that the runtime and controllers use, and notes on the build for its user."""

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
from mimoc.compiler.looks.appearance import face_material
from mimoc.compiler.mjcf.mimo import find_target
from mimoc.compiler.mjcf.scene import Placed, SceneTree
from mimoc.compiler.mjcf.sensor_sites import KEYPOINTS, PREFIX
from mimoc.compiler.mjcf.world import FreeObject
from mimoc.compiler.objects.built_object import PlacedThing
from mimoc.compiler.placing import start_pose
from mimoc.compiler.presets import delays, noise
from mimoc.compiler.provenance import SCALE_NOT_KNOWN
from mimoc.compiler.task_setup import TaskSetup, commanded_joints, hold_name, holds, locked_joints
from mimoc.compiler.toys import Toybox
from mimoc.schema.actuation import ActuationEntry, ActuatorEntry
from mimoc.schema.base import dotted, given
from mimoc.schema.body import EXPRESSIONS, FAT
from mimoc.schema.caregiver import CaregiverEntry
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import ACTUATIONS, OBJECTS, SCENES, SENSES, TASKS, TOY_SOURCES
from mimoc.schema.names import single_groups
from mimoc.schema.objects import ObjectEntry
from mimoc.schema.scene import SceneSpec
from mimoc.schema.senses import SensesEntry
from mimoc.schema.sizes import pairs

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


def unused_keys(spec: InfantSpec) -> tuple[str, ...]:
    """Return a note for each key of a spec that is given, is not the default, and has no effect."""
    return tuple(f"'{key}' has no effect: {why}" for key, why in _unused(spec))


def _unused(spec: InfantSpec) -> Iterator[tuple[str, str]]:
    if spec.development == "published" and spec.body.individual:
        for key in (*FAT, "maturation_rate"):
            if getattr(spec.body.individual, key) is not None:
                yield f"body.individual.{key}", "by the law 'published', strength follows size alone"
    yield from _other_kinds("actuation", "model", spec.actuation, ACTUATIONS)
    yield from _other_kinds("scene", "kind", spec.scene, SCENES)
    if toys := spec.scene.toys:
        yield from _other_kinds("scene.toys", "source", toys, TOY_SOURCES)
        if toys.root is not None and not TOY_SOURCES[toys.source].needs_root:
            yield "scene.toys.root", f"scene.toys.source is '{toys.source}', which needs no folder"
    if vision := spec.senses.vision:
        yield from _unused_of_vision(vision)
    if (impairments := spec.impairments) and spec.senses.vision is None:
        for key in ("acuity", "field_deg"):
            if getattr(impairments, key):
                yield f"impairments.{key}", "senses.vision is off"
    if (touch := spec.senses.touch) and touch.spacing_cm and touch.density != type(touch)().density:
        yield "senses.touch.density", "senses.touch.spacing_cm gives the distances"
    if touch and touch.channels and touch.quantity != type(touch)().quantity:
        yield "senses.touch.quantity", "senses.touch.channels are observed in its place"
    adult = spec.scene.caregiver
    if adult and adult.answers and adult.answers.to == "vocalisation" and not spec.actuation.voice:
        yield "scene.caregiver.answers", "actuation.voice is off, so that there is nothing to answer"
    locked = single_groups(spec.actuation.locked)
    for name in spec.actuation.strength:
        if single_groups([name]) <= locked:
            yield f"actuation.strength.{name}", "these joints are locked"
    on = [name for name, section in spec.senses if section is not None]
    if spec.delays.sensory_ms and all(getattr(spec.delays, f"{name}_ms") is not None for name in on):
        yield "delays.sensory_ms", "every sense has a delay of its own" if on else "all senses are off"
    if not SCENES[spec.scene.kind].varies:
        for key, files in spec.scene.textures:
            if files is not None:
                yield f"scene.textures.{key}", f"scene.kind '{spec.scene.kind}' has no wallpaper"


def _unused_of_vision(vision: Any) -> Iterator[tuple[str, str]]:
    usual, is_off = type(vision)(), vision.acuity == "off"
    is_plain = vision.contrast in ("linear", "mimo3", "off")
    follows_age = isinstance(vision.acuity, float) or vision.acuity == "age" or (is_off and not is_plain)
    if vision.acuity_profile != usual.acuity_profile and not follows_age:
        yield "senses.vision.acuity_profile", "senses.vision.acuity follows no age"
    if vision.contrast == "mimo3" and is_off:
        yield "senses.vision.contrast", "senses.vision.acuity is off"
    for key in ("foveation_radius", "fovea"):
        if getattr(vision, key) != getattr(usual, key) and not vision.foveation:
            yield f"senses.vision.{key}", "senses.vision.foveation is 0"


def _other_kinds(section: str, key: str, given: Any, kinds: Registry[Any]) -> Iterator[tuple[str, str]]:
    """Yield sections that belong to other kinds than the chosen one, and why they have no effect."""
    chosen = getattr(given, key)
    for kind in kinds.values():
        if kind.spec and kind.name != chosen and getattr(given, kind.name) != kind.spec():
            yield f"{section}.{kind.name}", f"{section}.{key} is '{chosen}'"


def notes(spec: InfantSpec, toybox: Toybox, plugins: Mapping[str, str], target: str | None = None) -> tuple[str, ...]:
    """Return the notes of a bundle for README and manifest; *target* is the software that it is built for, if any."""
    built_for = (f"built for {target}: parts, joints and commands are those that its code expects",) if target else ()
    if find_target(target).chest_joint and not spec.body.chest_joint:
        built_for += (f"'body.chest_joint' is false: {target}'s own infants have two joints and commands more",)
    of_toys = toybox.notes if spec.scene.toys else ()
    on_spec = (*_task_notes(spec), *unused_keys(spec), *_said_twice(spec))
    scale = () if spec.body.size_is_known else (SCALE_NOT_KNOWN,)
    return (*_impaired(spec), *scale, *built_for, *_plugin_notes(plugins), *on_spec, *of_toys)


def notes_on_shapes(toys: Iterable[FreeObject], things: Iterable[PlacedThing]) -> tuple[str, ...]:
    """Return the notes on the shapes of toys and objects, each once."""
    said = (*(toy.notes for toy in toys), *(thing.built.notes for thing in things))
    return tuple(dict.fromkeys(note for notes in said for note in notes))


DIFFERS = "differs from a healthy child"  # How the note on impairments begins.


def _impaired(spec: InfantSpec) -> Iterator[str]:
    if spec.impairments is None or not (asked := given(spec.impairments.complete)):
        return
    preset, side = spec.impairments.preset, spec.impairments.side
    name = "" if preset == "none" else f" ({preset}{f', {side}' if side else ''})"
    parts = [f"{key} {_shown(value)}" for key, value in asked.items() if key != "preset"]
    yield f"{DIFFERS}{name}: {'; '.join(parts)}"


def _shown(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_shown(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return " to ".join(map(_shown, value))
    return f"{value:g}" if isinstance(value, float) else str(value)


def _plugin_notes(plugins: Mapping[str, str]) -> Iterator[str]:
    for kind, distribution in sorted(plugins.items()):
        if distribution:
            yield f"'{kind}' is a plug-in: to build this bundle again, install '{distribution}'"
        else:
            yield f"'{kind}' is a plug-in that a script registered"


def _said_twice(spec: InfantSpec) -> Iterator[str]:
    for earlier, later, _ in pairs(spec.body, spec.corrected_age_months):
        first, second = dotted(earlier.path), dotted(later.path)
        if later.is_side_of(earlier) and later.value != earlier.value:
            yield f"'{second}' counts in place of '{first}' on that side"
        else:
            yield f"'{first}' and '{second}' say the same; one of the two is enough"


def _task_notes(spec: InfantSpec) -> Iterator[str]:
    if spec.task and TASKS[spec.task.kind].poses == () and spec.scene.pose != SceneSpec().pose:
        yield f"task '{spec.task.kind}' has its own starting pose; 'scene.pose: {spec.scene.pose}' has no effect"
