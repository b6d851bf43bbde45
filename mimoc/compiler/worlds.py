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
    around: BuiltScene  # The scene, in which nothing moves yet.
    world: World  # All that is around the infants.
    toys: tuple[FreeObject, ...]
    things: tuple[PlacedThing, ...]  # The objects of the scene.
    origins: Mapping[str, Entry]  # Where the numbers of the world come from.
    company: WorldCaregiver | None  # The caregiver, if there is one.

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
        parts, spec = list(self.parts.values()), self.plan.spec
        solver = replace(parts[0].tree.solver, multiccd=multiccd(spec.scene))
        infants = [replace(part.tree, solver=solver) for part in parts]
        return printing.render_infants(spec.name, infants, self.world, self.states)

    @cached_property
    def states(self) -> list[Keyframe]:
        """The keyframes."""
        return states_of(START, self.parts, self.world.resting, self._beside)

    def _beside(self, poses: Poses) -> Settings:
        return self.company.settings_at(self.builders, poses) if self.company else ()

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
            caregiver=self.company and self.company.entries[self.company.infant],
            notes=tuple(_notes(self)),
        )
        return WorldManifest.model_validate(rounded(manifest.model_dump()))

    @cached_property
    def manifests(self) -> dict[str, Manifest]:
        """The manifests of the infants; names of what they share have no prefix."""
        toys, objects = describe_toys(self.toys), describe_objects(self.things)
        shared = {"seed": self.plan.spec.scene.seed, "toys": toys, "objects": objects}
        adults = self.company.entries if self.company else {}
        kept = {state.name for state in self.states}
        return {
            name: manifest_with_prefix(one.manifest, f"{name}_").model_copy(
                update={
                    **shared,
                    "caregiver": rounded_caregiver(adults.get(name)),
                    "poses": tuple(part.prefix + pose for pose in part.poses if part.prefix + pose in kept),
                }
            )
            for (name, one), part in zip(self.builders.items(), self.parts.values(), strict=True)
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
    relative, scene = places_of(plan, builders), plan.spec.scene
    assets = assets_of_scene(scene, plan.written)
    discs = np.concatenate([place_discs(builders[name].covered, place) for name, place in relative.items()])
    largest = max(builders.values(), key=lambda one: length_m(one.tree))
    build = function_of(SCENES[scene.kind].build, "build")
    around: BuiltScene = build(scene, Occupant(largest.tree, discs), assets.wallpapers)
    places = {name: within(around.start, place) for name, place in relative.items()}
    objects = scene.objects
    for name, item in zip(builders, plan.spec.placed, strict=True):
        with_item = scene.model_copy(update={"objects": objects, "start_at": item.start_at})
        objects, places[name] = place_furniture(with_item, places[name], builders[name].task_setup.ahead_m)
    parts = {name: part_of(builders[name], place, f"{name}_") for name, place in places.items()}
    things = _objects(plan, objects, around, parts, builders, places)
    toys = _toys(plan, around, parts, builders, assets, things)
    weightless = any(one.task_setup.weightless for one in builders.values())
    furniture = around.world.furniture
    for part in parts.values():
        furniture += part.furniture
    world = replace(
        around.world,
        furniture=furniture,
        gravity_m_s2=WEIGHTLESS if weightless else around.world.gravity_m_s2,
        objects=(*toys, *(item for part in parts.values() for item in part.objects)),
        placed=tuple(thing.elements for thing in things),
        locks=tuple(item for part in parts.values() for item in part.locks),
        welds=tuple(item for part in parts.values() for item in part.welds),
    )
    roots = [root for part in parts.values() for root in part.tree.roots]
    world = replace(world, pairs=barrier_pairs(world, roots))
    origins = {**dict(trace_places(plan, places)), **(trace_toys(toys) if scene.toys else {}), **trace_objects(things)}
    built = BuiltWorld(plan, builders, parts, around, world, toys, things, origins, None)
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
    for index, (name, one) in enumerate(builders.items()):
        if one.infant.solver.integrator != first.infant.solver.integrator:
            models = one.spec.actuation.model, first.spec.actuation.model
            message = (
                f"'{name}' has '{models[0]}' actuators and '{first_name}' '{models[1]}' ones, which need another "
                "integrator; write the same actuation.model in both specs"
            )
            problems.append(plan.problem(index, message))
        if one.task_setup.weightless != first.task_setup.weightless:
            message = f"the task of either '{name}' or '{first_name}' has no gravity; give them other tasks"
            problems.append(plan.problem(index, message))
    if problems:
        raise SpecError(problems)


def _with_caregiver(built: BuiltWorld) -> BuiltWorld:
    """Return a world with the caregiver of its scene, if there is one, where it is within no other infant."""
    scene, written = built.plan.spec.scene, built.plan.written
    if scene.caregiver is None:
        return built
    check_offers(scene.caregiver, built.toys, built.things, lambda: written)
    inside = ""
    for company in caregivers(scene.caregiver, built.builders, built.parts):
        world = replace(built.world, persona=company.persona)
        beside = replace(built, world=world, company=company)
        if not (inside := company.in_the_way(beside.mjcf, built.parts)):
            return beside
    message = f"'{inside}' would be within it, or in its way; give another place or distance_cm, or move the infants"
    raise SpecError([written.problem(("scene", "caregiver"), message)])


def _without_bad_poses(built: BuiltWorld) -> BuiltWorld:
    if not built.things:
        return built
    model, specs = model_without_pictures(built.mjcf), built.plan.spec.scene.objects
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
    around: BuiltScene,
    parts: Mapping[str, InfantPart],
    builders: Mapping[str, Builder],
    places: Mapping[str, Placement],
) -> tuple[PlacedThing, ...]:
    scene, folder = plan.spec.scene, plan.written.folder
    starts = {name: part.poses[part.start] for name, part in parts.items()}
    floors = {name: footprint(builders[name].tree, [start.qpos]) for name, start in starts.items()}
    among = {
        name: replace(
            surroundings(scene, around, builders[name].tree, start, places[name], folder),
            prefix=parts[name].prefix,
            taken=tuple(tuple(disc) for other in floors if other != name for disc in floors[other].tolist()),
        )
        for name, start in starts.items()
    }
    with errors_in_file(lambda: plan.written):
        return place_objects(objects, among)


def _toys(
    plan: WorldPlan,
    around: BuiltScene,
    parts: Mapping[str, InfantPart],
    builders: Mapping[str, Builder],
    assets: SceneAssets,
    things: Sequence[PlacedThing],
) -> tuple[FreeObject, ...]:
    name = (plan.spec.scene.toys and plan.spec.scene.toys.infant) or next(iter(parts))
    part = parts[name]
    taken = np.concatenate([*(other.taken for other in parts.values()), discs_of(things)])
    with errors_in_file(lambda: plan.written):
        return toys_around(plan.spec.scene, around, builders[name].tree, part.poses[part.start], taken, assets.toybox)


def _texts(built: BuiltWorld) -> dict[str, bytes]:
    plan, manifest, manifests = built.plan, built.manifest, built.manifests
    infants = list(manifests.values())
    # The file of a world with all that it leaves open, which names the files of the infants in the bundle.
    data = rounded(built.plan.spec.model_dump(mode="json", exclude_none=True))
    data["infants"] = [
        {**entry, "spec": file_of(entry["name"], RESOLVED)} for entry in entries_of(built.plan, built.builders)
    ]
    data["scene"] = {key: value for key, value in data["scene"].items() if key not in ("pose", "held")}
    files = {
        SPEC_FILE: plan.written.text.encode(),
        RESOLVED: dump(data).encode(),
        PROVENANCE: render_json(packed(dict(_provenance(built))), 2),
        MANIFEST: render_json(manifest.model_dump()),
        "README.md": printing.render_text("WORLD.md.j2", world=manifest, manifests=infants, version=__version__),
    }
    for name, one in built.builders.items():
        arrays = {ARRAYS: pack_arrays(one.arrays)} if one.arrays else {}
        of_infant = {
            **arrays,
            MANIFEST: render_json(manifest_data(manifests[name])),
            SPEC_FILE: as_written(plan.infants[name]).text.encode(),
            RESOLVED: dump(rounded(to_data(one.spec))).encode(),
        }
        files |= {file_of(name, file): content for file, content in of_infant.items()}
    return files


def _notes(built: BuiltWorld) -> Iterator[str]:
    for name, spec in built.plan.infants.items():
        given, around = spec.scene.model_fields_set - {"pose", "held"}, built.plan.spec.scene
        if ignored := sorted(key for key in given if getattr(spec.scene, key) != getattr(around, key)):
            keys = " and ".join(f"scene.{key}" for key in ignored)
            yield f"'{keys}' of '{name}' has no effect: it is in the scene of this world"
    adult = built.plan.spec.scene.caregiver
    voices = [spec.actuation.voice for spec in built.plan.infants.values() if spec.actuation.voice]
    if adult and adult.answers and adult.answers.to == "vocalisation" and not voices:
        yield "'scene.caregiver.answers' has no effect: no infant has a voice, actuation.voice"
    yield from notes_on_shapes(built.toys, built.things)


def _provenance(built: BuiltWorld) -> Iterator[tuple[str, Entry]]:
    plan = built.plan
    of_spec, first = trace_spec(plan.spec, plan.written), next(iter(built.builders))
    largest = max(built.builders, key=lambda name: length_m(built.builders[name].tree))
    shared = {**of_spec, **built.origins, **built.around.origins}
    yield from of_spec.items()
    yield from trace_around(built.origins, shared, first)
    yield from trace_around(built.around.origins, shared, largest)
    if built.company:
        yield from trace_around(built.company.origins, shared, built.company.infant)
    for name, one in built.builders.items():
        part = built.parts[name]
        placed = replace(one.infant, world=replace(built.world, objects=part.objects))
        entries = {
            **trace_spec(one.spec, as_written(plan.infants[name])),
            **trace_world(one.spec, PlacedScene(placed, (), part.objects, {})),
            **one.origins,
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
    roots = [f"{name}_{one.manifest.root_body}" for name, one in built.builders.items()]
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
