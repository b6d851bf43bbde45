"""Compilation of several infants to one world, which MuJoCo checks: a bundle in memory."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from mimoc.base.classes import PATH, check_class, takes
from mimoc.base.errors import MimocError, ModelError, SpecError
from mimoc.base.kinds import function_of
from mimoc.base.rounding import render_json, rounded
from mimoc.body.kinematics import length_m
from mimoc.body.origins import Entry
from mimoc.bundle.io import ARRAYS, MANIFEST, pack_arrays, with_lock
from mimoc.bundle.manifest import Manifest, to_data as manifest_data
from mimoc.bundle.model import mjcf_of
from mimoc.bundle.provenance import PROVENANCE, packed
from mimoc.bundle.world import (
    START,
    WorldBundle,
    WorldManifest,
    file_of,
    is_world_folder,
    manifest_with_prefix,
    overlaps,
    read_world_bundle,
    world_bundle,
)
from mimoc.compiler.assembling import multiccd
from mimoc.compiler.building import Builder, builder
from mimoc.compiler.manifest import describe_objects, describe_toys, notes_on_shapes, rounded_caregiver
from mimoc.compiler.mjcf import printing
from mimoc.compiler.mjcf.scene import Keyframe
from mimoc.compiler.mjcf.world import FreeObject, World, barrier_pairs
from mimoc.compiler.model_check import free_keyframes, model_without_pictures
from mimoc.compiler.objects.built_object import PlacedThing
from mimoc.compiler.objects.placing import place_furniture, place_objects, trace_objects
from mimoc.compiler.placing import (
    PlacedScene,
    SceneAssets,
    assets_of_scene,
    check_offers,
    discs_of,
    errors_in_file,
    place_discs,
    surroundings,
    toys_around,
)
from mimoc.compiler.provenance import SPEC_FILE, trace_around, trace_infant, trace_spec, trace_world
from mimoc.compiler.scenes import WEIGHTLESS, BuiltScene, Occupant, Placement, footprint
from mimoc.compiler.toys import trace_toys
from mimoc.compiler.world_places import (
    InfantPart,
    Poses,
    Settings,
    WorldCaregiver,
    caregivers,
    entries_of,
    part_of,
    places_of,
    states_of,
    trace_places,
    within,
)
from mimoc.fits import load_tables
from mimoc.schema import source as sources
from mimoc.schema.infant import SPEC_SUFFIXES, InfantSpec, as_written, to_data
from mimoc.schema.kinds import SCENES
from mimoc.schema.objects import ObjectSpec
from mimoc.schema.source import dump
from mimoc.schema.world import WORLD, WorldPlan, in_scene, in_world, is_world, plan_of, read_world
from mimoc.version import __version__


def world_of(source: Any, scene_seed: int | None = None) -> WorldBundle | None:
    """Return the world of several infants that something is, or is the path of; None if it is anything else.

    A *scene_seed* replaces that of a world's file.

    """
    if isinstance(source, WorldBundle):
        return source
    if isinstance(source, (WorldPlan, Mapping)):
        return build_world(source)
    if not isinstance(source, PATH):
        return None
    path = Path(source).expanduser()
    if path.suffix.lower() not in SPEC_SUFFIXES:
        return read_world_bundle(path) if is_world_folder(path) else None
    written = sources.read(path) if path.is_file() else None
    if written is None or not is_world(written.data):
        return None
    plan = read_world(written)
    return build_world(plan if scene_seed is None else in_scene(plan, scene_seed))


RESOLVED = "resolved.yaml"


@dataclass(frozen=True)
class BuiltWorld:
    """Infants in their world, before it is written."""

    plan: WorldPlan
    builders: Mapping[str, Builder]
    parts: Mapping[str, InfantPart]  # What each infant adds.
    scene: BuiltScene  # The scene without its objects and toys.
    world: World  # All that is around the infants.
    toys: tuple[FreeObject, ...]
    things: tuple[PlacedThing, ...]  # The objects of the scene.
    origins: Mapping[str, Entry]  # Where the numbers of the world come from.
    caregiver: WorldCaregiver | None

    def to_bundle(self, *, check: bool = False) -> WorldBundle:
        """Return the bundle; *check* that MuJoCo takes it, and that no two infants start within each other."""
        files = {**self.mjcf, **_texts(self)}
        if check:
            _check(self, files)
        return world_bundle(
            with_lock(files, {"mimoc": __version__}, load_tables().files), self.manifest, self.manifests
        )

    @property
    def mjcf(self) -> dict[str, bytes]:
        """The MJCF and its assets: the part of the bundle that MuJoCo reads."""
        parts = list(self.parts.values())
        spec = self.plan.spec
        solver = replace(parts[0].tree.solver, multiccd=multiccd(spec.scene))
        infants = [replace(part.tree, solver=solver) for part in parts]
        return printing.render_infants(spec.name, infants, self.world, self.states)

    @cached_property
    def states(self) -> list[Keyframe]:
        """The keyframes."""
        return states_of(START, self.parts, self.world.resting, self._caregiver_settings)

    def _caregiver_settings(self, poses: Poses) -> Settings:
        return self.caregiver.settings_at(self.builders, poses) if self.caregiver else ()

    @cached_property
    def manifest(self) -> WorldManifest:
        """The manifest of the world."""
        first = next(iter(self.builders.values())).manifest
        manifest = WorldManifest(
            name=self.plan.spec.name,
            timestep_ms=first.timestep_ms,
            step_ms=first.step_ms,
            infants=tuple(self.builders),
            seed=self.plan.spec.scene.seed,
            toys=describe_toys(self.toys),
            objects=describe_objects(self.things),
            caregiver=self.caregiver and self.caregiver.entries[self.caregiver.infant],
            notes=tuple(_notes(self)),
        )
        return WorldManifest.model_validate(rounded(manifest.model_dump()))

    @cached_property
    def manifests(self) -> dict[str, Manifest]:
        """The manifests of the infants; names of what they share have no prefix."""
        shared = {
            "seed": self.plan.spec.scene.seed,
            "toys": describe_toys(self.toys),
            "objects": describe_objects(self.things),
        }
        caregiver_entries = self.caregiver.entries if self.caregiver else {}
        kept = {state.name for state in self.states}
        return {
            name: manifest_with_prefix(infant_builder.manifest, f"{name}_").model_copy(
                update={
                    **shared,
                    "caregiver": rounded_caregiver(caregiver_entries.get(name)),
                    "poses": tuple(part.prefix + pose for pose in part.poses if part.prefix + pose in kept),
                }
            )
            for (name, infant_builder), part in zip(self.builders.items(), self.parts.values(), strict=True)
        }


def plan_world(source: WorldPlan | Mapping[str, InfantSpec] | str | Path, **keys: Any) -> WorldPlan:
    """Return the world that a file describes, or that of infants by name; see `build_world`."""
    if isinstance(source, WorldPlan):
        return source
    if isinstance(source, Mapping):
        for name, infant in source.items():
            check_class(f"infant '{name}'", infant, "a spec, as mimoc.load_spec returns it", InfantSpec)
        return plan_of(source, **keys)
    if keys:
        raise MimocError(f"{' and '.join(keys)} can be said of specs by name only; a file of a world says so itself")
    return read_world(sources.read(source, WORLD))


@takes("the path of a world's file, or specs by the names of infants", WorldPlan, Mapping, *PATH)
def build_world(source: WorldPlan | Mapping[str, InfantSpec] | str | Path, **keys: Any) -> WorldBundle:
    """Compile several infants to one world: the same specs give the same bytes.

    Args:
        source: The path of a world's YAML file, or the specs of infants by their names in the world.
        keys: Of infants by name, other keys of such a file: `name`, and `scene`.

    Raises:
        SpecError: If a file is invalid or cannot be built, or if infants would start within each other.
        ModelError: If MuJoCo rejects the model.
        MimocError: If keys are given that a file says.
        TypeError: If an infant is no spec.

    Example:
        >>> import mimoc
        >>> anna = mimoc.load_spec("nine_months.yaml")
        >>> bundle = mimoc.build_world({"anna": anna, "ben": anna})
        >>> mimoc.write_bundle(bundle, "out/two").name, sorted(bundle.infants)
        ('two', ['anna', 'ben'])
    """
    return assemble_world(plan_world(source, **keys)).to_bundle(check=True)


def assemble_world(plan: WorldPlan, builders: Mapping[str, Builder] | None = None) -> BuiltWorld:
    """Return the infants of a world in it, before anything is written; their *builders* can be given if known."""
    builders = builders or {name: _builder(plan, name) for name in plan.infants}
    _check_options(plan, builders)
    relative = places_of(plan, builders)
    assets = assets_of_scene(plan.spec.scene, plan.written)
    scene = _scene(plan, builders, relative, assets)
    objects, places = _at_furniture(plan, builders, scene, relative)
    parts = {name: part_of(builders[name], place, f"{name}_") for name, place in places.items()}
    things = _objects(plan, objects, scene, parts, builders, places)
    toys = _toys(plan, scene, parts, builders, assets, things)
    world = _world_around(list(parts.values()), builders, scene, toys, things)
    of_toys = trace_toys(toys) if plan.spec.scene.toys else {}
    origins = {**dict(trace_places(plan, places)), **of_toys, **trace_objects(things)}
    built = BuiltWorld(plan, builders, parts, scene, world, toys, things, origins, None)
    return _without_bad_poses(_with_caregiver(built))


def _builder(plan: WorldPlan, name: str) -> Builder:
    spec = in_world(plan, name)
    try:
        return builder(spec)
    except SpecError as error:
        written = as_written(plan.infants[name])
        keys = [tuple(problem.key.split(".")) for problem in error.problems]
        raise SpecError(
            written.problem(key if key in written.key_places else (), problem.message)
            for key, problem in zip(keys, error.problems, strict=True)
        ) from None


def _check_options(plan: WorldPlan, builders: Mapping[str, Builder]) -> None:
    first_name, first = next(iter(builders.items()))
    problems = []
    for index, (name, infant_builder) in enumerate(builders.items()):
        if infant_builder.infant.solver.integrator != first.infant.solver.integrator:
            model, first_model = infant_builder.spec.actuation.model, first.spec.actuation.model
            message = (
                f"'{name}' has '{model}' actuators and '{first_name}' '{first_model}' ones, which need another "
                "integrator; write the same actuation.model in both specs"
            )
            problems.append(plan.problem(index, message))
        if infant_builder.task_setup.weightless != first.task_setup.weightless:
            message = f"the task of either '{name}' or '{first_name}' has no gravity; give them other tasks"
            problems.append(plan.problem(index, message))
    if problems:
        raise SpecError(problems)


def _scene(
    plan: WorldPlan, builders: Mapping[str, Builder], relative: Mapping[str, Placement], assets: SceneAssets
) -> BuiltScene:
    """Return the scene for the largest of the infants, with room for what all of them cover."""
    discs = np.concatenate(
        [place_discs(builders[name].infant_and_task_discs, place) for name, place in relative.items()]
    )
    largest = max(builders.values(), key=lambda infant_builder: length_m(infant_builder.tree))
    build = function_of(SCENES[plan.spec.scene.kind].build, "build")
    return build(plan.spec.scene, Occupant(largest.tree, discs), assets.wallpapers)


def _at_furniture(
    plan: WorldPlan, builders: Mapping[str, Builder], scene: BuiltScene, relative: Mapping[str, Placement]
) -> tuple[Sequence[ObjectSpec], dict[str, Placement]]:
    """Return the objects of the scene and where the infants are in it, once furniture and its infants are together."""
    objects = plan.spec.scene.objects
    places = {name: within(scene.start, place) for name, place in relative.items()}
    for name, item in zip(builders, plan.spec.placed, strict=True):
        with_item = plan.spec.scene.model_copy(update={"objects": objects, "start_at": item.start_at})
        objects, places[name] = place_furniture(with_item, places[name], builders[name].task_setup.ahead_m)
    return objects, places


def _world_around(
    parts: Sequence[InfantPart],
    builders: Mapping[str, Builder],
    scene: BuiltScene,
    toys: Sequence[FreeObject],
    things: Sequence[PlacedThing],
) -> World:
    """Return all that is around the infants: the scene with its objects and toys, and what the tasks add."""
    is_weightless = any(infant_builder.task_setup.weightless for infant_builder in builders.values())
    world = replace(
        scene.world,
        furniture=sum((part.furniture for part in parts), start=scene.world.furniture),
        gravity_m_s2=WEIGHTLESS if is_weightless else scene.world.gravity_m_s2,
        objects=(*toys, *(item for part in parts for item in part.objects)),
        placed=tuple(thing.elements for thing in things),
        locks=tuple(lock for part in parts for lock in part.locks),
        welds=tuple(weld for part in parts for weld in part.welds),
    )
    return replace(world, pairs=barrier_pairs(world, [root for part in parts for root in part.tree.roots]))


def _with_caregiver(built: BuiltWorld) -> BuiltWorld:
    """Return a world with the caregiver of its scene, if there is one, where it is within no other infant."""
    spec = built.plan.spec.scene.caregiver
    written = built.plan.written
    if spec is None:
        return built
    check_offers(spec, built.toys, built.things, lambda: written)
    inside = ""
    for caregiver in caregivers(spec, built.builders, built.parts):
        world = replace(built.world, persona=caregiver.persona)
        with_caregiver = replace(built, world=world, caregiver=caregiver)
        if not (inside := caregiver.in_the_way(with_caregiver.mjcf, built.parts)):
            return with_caregiver
    message = f"'{inside}' would be within it, or in its way; give another place or distance_cm, or move the infants"
    raise SpecError([written.problem(("scene", "caregiver"), message)])


def _without_bad_poses(built: BuiltWorld) -> BuiltWorld:
    if not built.things:
        return built
    model = model_without_pictures(built.mjcf)
    specs = built.plan.spec.scene.objects
    with errors_in_file(lambda: built.plan.written):
        free = {state.name for state in free_keyframes(model, built.states, START, specs, built.things)}
    parts = {
        name: replace(part, poses={pose: state for pose, state in part.poses.items() if part.prefix + pose in free})
        for name, part in built.parts.items()
    }
    return replace(built, parts=parts)


def _objects(
    plan: WorldPlan,
    objects: Sequence[ObjectSpec],
    scene: BuiltScene,
    parts: Mapping[str, InfantPart],
    builders: Mapping[str, Builder],
    places: Mapping[str, Placement],
) -> tuple[PlacedThing, ...]:
    starts = {name: part.poses[part.start] for name, part in parts.items()}
    floors = {name: footprint(builders[name].tree, [start.qpos]) for name, start in starts.items()}
    among = {
        name: replace(
            surroundings(plan.spec.scene, scene, builders[name].tree, start, places[name], plan.written.folder),
            prefix=parts[name].prefix,
            taken=tuple(tuple(disc) for other in floors if other != name for disc in floors[other].tolist()),
        )
        for name, start in starts.items()
    }
    with errors_in_file(lambda: plan.written):
        return place_objects(objects, among)


def _toys(
    plan: WorldPlan,
    scene: BuiltScene,
    parts: Mapping[str, InfantPart],
    builders: Mapping[str, Builder],
    assets: SceneAssets,
    things: Sequence[PlacedThing],
) -> tuple[FreeObject, ...]:
    name = (plan.spec.scene.toys and plan.spec.scene.toys.infant) or next(iter(parts))
    part = parts[name]
    taken = np.concatenate([*(other.taken for other in parts.values()), discs_of(things)])
    with errors_in_file(lambda: plan.written):
        return toys_around(plan.spec.scene, scene, builders[name].tree, part.poses[part.start], taken, assets.toybox)


def _texts(built: BuiltWorld) -> dict[str, bytes]:
    plan = built.plan
    manifest = built.manifest
    manifests = built.manifests
    # This is the world's file with what it leaves open filled in; it names the files of the infants in the bundle.
    data = rounded(plan.spec.model_dump(mode="json", exclude_none=True))
    data["infants"] = [
        {**entry, "spec": file_of(entry["name"], RESOLVED)} for entry in entries_of(plan, built.builders)
    ]
    data["scene"] = {key: value for key, value in data["scene"].items() if key not in ("pose", "held")}
    files = {
        SPEC_FILE: plan.written.text.encode(),
        RESOLVED: dump(data).encode(),
        PROVENANCE: render_json(packed(dict(_provenance(built))), 2),
        MANIFEST: render_json(manifest.model_dump()),
        "README.md": printing.render_text(
            "WORLD.md.j2", world=manifest, manifests=list(manifests.values()), version=__version__
        ),
    }
    for name, infant_builder in built.builders.items():
        arrays = {ARRAYS: pack_arrays(infant_builder.arrays)} if infant_builder.arrays else {}
        of_infant = {
            **arrays,
            MANIFEST: render_json(manifest_data(manifests[name])),
            SPEC_FILE: as_written(plan.infants[name]).text.encode(),
            RESOLVED: dump(rounded(to_data(infant_builder.spec))).encode(),
        }
        files |= {file_of(name, file): content for file, content in of_infant.items()}
    return files


def _notes(built: BuiltWorld) -> Iterator[str]:
    scene = built.plan.spec.scene
    for name, spec in built.plan.infants.items():
        given = spec.scene.model_fields_set - {"pose", "held"}
        if ignored := sorted(key for key in given if getattr(spec.scene, key) != getattr(scene, key)):
            keys = " and ".join(f"scene.{key}" for key in ignored)
            yield f"'{keys}' of '{name}' has no effect: it is in the scene of this world"
    answers = scene.caregiver and scene.caregiver.answers
    has_voice = any(spec.actuation.voice for spec in built.plan.infants.values())
    if answers and answers.to == "vocalisation" and not has_voice:
        yield "'scene.caregiver.answers' has no effect: no infant has a voice, actuation.voice"
    yield from notes_on_shapes(built.toys, built.things)


def _provenance(built: BuiltWorld) -> Iterator[tuple[str, Entry]]:
    plan = built.plan
    of_spec = trace_spec(plan.spec, plan.written)
    first = next(iter(built.builders))
    largest = max(built.builders, key=lambda name: length_m(built.builders[name].tree))
    shared = {**of_spec, **built.origins, **built.scene.origins}
    yield from of_spec.items()
    yield from trace_around(built.origins, shared, first)
    yield from trace_around(built.scene.origins, shared, largest)
    if built.caregiver:
        yield from trace_around(built.caregiver.origins, shared, built.caregiver.infant)
    for name, infant_builder in built.builders.items():
        part = built.parts[name]
        placed = replace(infant_builder.infant, world=replace(built.world, objects=part.objects))
        entries = {
            **trace_spec(infant_builder.spec, as_written(plan.infants[name])),
            **trace_world(infant_builder.spec, PlacedScene(placed, (), part.objects, {})),
            **infant_builder.origins,
        }
        yield from trace_infant(name, part.prefix, entries)


def _check(built: BuiltWorld, files: Mapping[str, bytes]) -> None:
    try:
        model = mujoco.MjModel.from_xml_string(*mjcf_of(files, "scene.xml"))
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"{built.plan.written.file}: MuJoCo rejects the model: {reason}; please report this") from None
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(START).id)
    roots = [f"{name}_{infant_builder.manifest.root_body}" for name, infant_builder in built.builders.items()]
    depths = overlaps(model, data, roots)
    names = list(built.builders)
    if problems := [
        built.plan.problem(
            second,
            f"'{names[second]}' starts {100 * depth_m:.2g} cm within '{names[first]}'; "
            "give one of them another place with x_cm and y_cm",
        )
        for (first, second), depth_m in sorted(depths.items())
    ]:
        raise SpecError(problems)
