"""Compilation of several infants to one world, which MuJoCo checks: a bundle in memory."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from mimoc.base.classes import PATH, check_class, takes
from mimoc.base.errors import MimocError, ModelError, NoSpaceError, ObjectError, SpecError, ToyError
from mimoc.base.kinds import function_of
from mimoc.base.rounding import render_json, rounded
from mimoc.body.kinematics import length_m
from mimoc.body.origins import Entry
from mimoc.bundle.arrays import ARRAYS, pack_arrays
from mimoc.bundle.io import MANIFEST, with_lock
from mimoc.bundle.manifest import Manifest, to_data as manifest_data
from mimoc.bundle.model import mjcf_of
from mimoc.bundle.provenance import PROVENANCE, packed
from mimoc.bundle.world import START, WorldBundle, WorldManifest, file_of, manifest_with_prefix, overlaps, world_bundle
from mimoc.compiler.assembling import multiccd
from mimoc.compiler.building import Builder, builder
from mimoc.compiler.manifest import describe_objects, describe_toys
from mimoc.compiler.notes import notes_on_shapes
from mimoc.compiler.placing import PlacedScene, SceneAssets, assets_of_scene, discs_of, surroundings, toys_around
from mimoc.compiler.provenance import SPEC_FILE, trace_spec, trace_world
from mimoc.compiler.world_places import InfantPart, part_of, places_of, states_of, trace_places, within
from mimoc.compiler.world_provenance import trace_around, trace_infant
from mimoc.fits import load_tables
from mimoc.mjcf import printing
from mimoc.mjcf.world import FreeObject, World, barrier_pairs
from mimoc.objects.built_object import PlacedThing
from mimoc.objects.placing import place_objects, trace_objects
from mimoc.scenes import SCENES
from mimoc.scenes.built_scene import WEIGHTLESS, BuiltScene, Occupant, Placement
from mimoc.schema import source as sources
from mimoc.schema.infant import InfantSpec, as_written, to_data
from mimoc.schema.world import WORLD, WorldPlan, in_world, plan_of, read_world
from mimoc.schema.yaml_document import dump
from mimoc.toys.objects import trace_toys
from mimoc.version import __version__

RESOLVED = "resolved.yaml"


@dataclass(frozen=True)
class BuiltWorld:
    """Infants in their world, before it is written."""

    plan: WorldPlan
    builders: Mapping[str, Builder]
    parts: Mapping[str, InfantPart]
    """What each infant adds."""
    around: BuiltScene
    """The scene, in which nothing moves yet."""
    world: World
    """All that is around the infants."""
    toys: tuple[FreeObject, ...]
    things: tuple[PlacedThing, ...]
    """The objects of the scene."""
    origins: Mapping[str, Entry]
    """Where the numbers of the world come from."""

    def to_bundle(self, *, check: bool = False) -> WorldBundle:
        """Return the bundle; *check* that MuJoCo takes it, and that no two infants start within each other.

        Raises:
            ModelError: If MuJoCo rejects the model.
            SpecError: If infants start within each other.
        """
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
        states = states_of(START, parts, self.world.resting)
        solver = replace(parts[0].tree.solver, multiccd=multiccd(spec.scene))
        infants = [replace(part.tree, solver=solver) for part in parts]
        return printing.render_infants(spec.name, infants, self.world, states)

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
            notes=tuple(_notes(self)),
        )
        return WorldManifest.model_validate(rounded(manifest.model_dump()))

    @cached_property
    def manifests(self) -> dict[str, Manifest]:
        """The manifests of the infants; names of what they share have no prefix."""
        toys, objects = describe_toys(self.toys), describe_objects(self.things)
        shared = {"seed": self.plan.spec.scene.seed, "toys": toys, "objects": objects}
        return {
            name: manifest_with_prefix(one.manifest, f"{name}_").model_copy(update=shared)
            for name, one in self.builders.items()
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
    """Return the infants of a world in it, before anything is written; *builders* are those of its infants, if known.

    Raises:
        SpecError: If they cannot be built, or not in the same world.
    """
    builders = builders or {name: _builder(plan, name) for name in plan.infants}
    _check_options(plan, builders)
    relative, scene = places_of(plan, builders), plan.spec.scene
    assets = assets_of_scene(scene, plan.written)
    discs = np.concatenate([part_of(builders[name], relative[name], "").taken for name in builders])
    largest = max(builders.values(), key=lambda one: length_m(one.tree))
    build = function_of(SCENES[scene.kind].build, "build")
    around: BuiltScene = build(scene, Occupant(largest.tree, discs), assets.wallpapers)
    places = {name: within(around.start, place) for name, place in relative.items()}
    parts = {name: part_of(builders[name], place, f"{name}_") for name, place in places.items()}
    things = _objects(plan, around, parts, builders, places)
    toys = _toys(plan, around, parts, builders, assets, things)
    weightless = any(one.task_setup.weightless for one in builders.values())
    world = _world(around, parts, toys, things, weightless)
    origins = {**dict(trace_places(plan, places)), **(trace_toys(toys) if scene.toys else {}), **trace_objects(things)}
    return BuiltWorld(plan, builders, parts, around, world, toys, things, origins)


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
    """Check that infants can have the same options of MuJoCo's, and the same gravity.

    Raises:
        SpecError: If they cannot.
    """
    first_name, first = next(iter(builders.items()))
    problems = []
    for index, (name, one) in enumerate(builders.items()):
        if one.infant.solver != first.infant.solver:
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


def _objects(
    plan: WorldPlan,
    around: BuiltScene,
    parts: Mapping[str, InfantPart],
    builders: Mapping[str, Builder],
    places: Mapping[str, Placement],
) -> tuple[PlacedThing, ...]:
    """Return the objects of the scene; where their places name a part of an infant, it is the first infant's."""
    scene, (name, part) = plan.spec.scene, next(iter(parts.items()))
    pose, folder = part.poses[part.start], plan.written.folder
    among = surroundings(scene, around, builders[name].tree, pose, places[name], folder)
    try:
        things = place_objects(scene.objects, among)
    except ObjectError as error:
        path = "scene", "objects", error.number, error.key
        raise SpecError([plan.written.problem(path, str(error))]) from None
    if tied := [number for number, thing in enumerate(things) if thing.built.tie]:
        message = "nothing can be tied to one of several infants yet; leave out what ties it"
        raise SpecError(plan.written.problem(("scene", "objects", number), message) for number in tied)
    if wet := [number for number, thing in enumerate(things) if thing.built.water]:
        message = "only a single infant can be in water yet; leave it out"
        raise SpecError(plan.written.problem(("scene", "objects", number), message) for number in wet)
    return things


def _toys(
    plan: WorldPlan,
    around: BuiltScene,
    parts: Mapping[str, InfantPart],
    builders: Mapping[str, Builder],
    assets: SceneAssets,
    things: Sequence[PlacedThing],
) -> tuple[FreeObject, ...]:
    """Return the toys, around the first infant and outside of what all cover."""
    name, part = next(iter(parts.items()))
    taken = np.concatenate([*(other.taken for other in parts.values()), discs_of(things)])
    try:
        return toys_around(plan.spec.scene, around, builders[name].tree, part.poses[part.start], taken, assets.toybox)
    except (NoSpaceError, ToyError) as error:
        lines = str(error).splitlines()
        raise SpecError(plan.written.problem(("scene", "toys"), line) for line in lines) from None


def _world(
    around: BuiltScene,
    parts: Mapping[str, InfantPart],
    toys: Sequence[FreeObject],
    things: Sequence[PlacedThing],
    weightless: bool,
) -> World:
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
    return replace(world, pairs=barrier_pairs(world, roots))


def _texts(built: BuiltWorld) -> dict[str, bytes]:
    """Return all files but MJCF and what it refers to."""
    plan, manifest, manifests = built.plan, built.manifest, built.manifests
    files = {
        SPEC_FILE: plan.written.text.encode(),
        RESOLVED: dump(_resolved(built)).encode(),
        PROVENANCE: render_json(packed(dict(_provenance(built))), 2),
        MANIFEST: render_json(manifest.model_dump()),
        "README.md": _readme(manifest, manifests),
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


def _readme(manifest: WorldManifest, manifests: Mapping[str, Manifest]) -> bytes:
    infants = list(manifests.values())
    return printing.render_text("WORLD.md.j2", world=manifest, manifests=infants, version=__version__)


def _resolved(built: BuiltWorld) -> dict[str, Any]:
    """Return the file of a world with all that it leaves open, which names the files of the infants in the bundle."""
    data = rounded(built.plan.spec.model_dump(mode="json", exclude_none=True))
    relative = places_of(built.plan, built.builders)
    data["infants"] = [
        {
            "name": name,
            "spec": file_of(name, RESOLVED),
            "x_cm": rounded(100 * relative[name].x_m),
            "y_cm": rounded(100 * relative[name].y_m),
            "yaw_deg": item.yaw_deg,
        }
        for name, item in zip(built.builders, built.plan.spec.placed, strict=True)
    ]
    data["scene"] = {key: value for key, value in data["scene"].items() if key not in ("pose", "held")}
    return data


def _notes(built: BuiltWorld) -> Iterator[str]:
    """Yield what of the infants' own scenes has no effect."""
    for name, spec in built.plan.infants.items():
        given, around = spec.scene.model_fields_set - {"pose", "held"}, built.plan.spec.scene
        if ignored := sorted(key for key in given if getattr(spec.scene, key) != getattr(around, key)):
            keys = " and ".join(f"scene.{key}" for key in ignored)
            yield f"'{keys}' of '{name}' has no effect: it is in the scene of this world"
    yield from notes_on_shapes(built.toys, built.things)


def _provenance(built: BuiltWorld) -> Iterator[tuple[str, Entry]]:
    plan = built.plan
    of_spec, first = trace_spec(plan.spec, plan.written), next(iter(built.builders))
    largest = max(built.builders, key=lambda name: length_m(built.builders[name].tree))
    shared = {**of_spec, **built.origins, **built.around.origins}
    yield from of_spec.items()
    yield from trace_around(built.origins, shared, first)
    yield from trace_around(built.around.origins, shared, largest)
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
    """Check that MuJoCo takes a world, and that no two infants start within each other.

    Raises:
        ModelError: If it does not.
        SpecError: If they do.
    """
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
