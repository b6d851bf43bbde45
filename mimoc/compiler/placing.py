"""Placement of an infant in the world of its spec, with toys around it, and what toys and wallpapers it has."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import numpy as np

from mimoc.base.errors import NoSpaceError, ObjectError, SpecError, TextureError, ToyError, UnknownToysError, suggestion
from mimoc.base.geometry.rotations import matrix_from_axis, quaternion_from_axis, quaternion_product
from mimoc.base.kinds import function_of
from mimoc.base.random_streams import stream
from mimoc.body.kinematics import FloatArray
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.actuation import ActuationSetup
from mimoc.compiler.caregiver import place_caregiver, settings_at
from mimoc.compiler.looks.wallpaper import CEILINGS, FLOORS, OWN_WALLPAPERS, WALLS, Wallpaper, Wallpapers, read_textures
from mimoc.compiler.mjcf.scene import Keyframe, SceneTree
from mimoc.compiler.mjcf.world import NOBODY, FreeObject, barrier_pairs
from mimoc.compiler.model_check import free_poses
from mimoc.compiler.objects.built_object import PlacedThing, Surroundings
from mimoc.compiler.objects.placing import place_furniture, place_objects, start_at, trace_objects
from mimoc.compiler.scenes import WEIGHTLESS, BuiltScene, Occupant, Placement, footprint, reach_of, reachable_floor
from mimoc.compiler.task_setup import NO_TASK, TaskSetup, build_task, holds, keeps, lock, locked_joints, weld
from mimoc.compiler.toys import Floor, ReachableFloor, Toybox, choose_toys, make_object, place_toys
from mimoc.schema.caregiver import CaregiverEntry, CaregiverSpec
from mimoc.schema.infant import InfantSpec, as_written
from mimoc.schema.kinds import SCENES, TOY_SOURCES
from mimoc.schema.objects import ToysSpec
from mimoc.schema.scene import SceneSpec
from mimoc.schema.source import Source


@cache
def _builtin_toys() -> Toybox:
    return function_of(TOY_SOURCES["builtin"].build, "build")(ToysSpec(), Path())


@dataclass(frozen=True, slots=True)
class SceneAssets:
    """The toys and wallpapers that scenes choose from."""

    wallpapers: Wallpapers = OWN_WALLPAPERS
    toybox: Toybox = field(default_factory=_builtin_toys)


def load_scene_assets(spec: InfantSpec) -> SceneAssets:
    """Return the toys and wallpapers for the scenes of a spec, whose paths are relative to its file, or a SpecError."""
    if spec.scene.toys is None and not any(path for _, path in spec.scene.textures):
        return SceneAssets()
    return assets_of_scene(spec.scene, as_written(spec))


def assets_of_scene(scene: SceneSpec, written: Source) -> SceneAssets:
    """Return the toys and wallpapers for a scene that a file describes; see `load_scene_assets`."""
    wallpapers = Wallpapers(
        floors=(*FLOORS.values(), *_own("floor", scene, written)),
        ceilings=(*CEILINGS.values(), *_own("ceiling", scene, written)),
        walls=(*WALLS.values(), *_own("wall", scene, written)),
    )
    return SceneAssets(wallpapers, _builtin_toys() if scene.toys is None else _toybox(scene.toys, written))


def _toybox(toys: ToysSpec, written: Source) -> Toybox:
    try:
        return function_of(TOY_SOURCES[toys.source].build, "build")(toys, written.folder)
    except UnknownToysError as error:
        places = {name: ("scene", "toys", "subset", toys.subset.index(name)) for name in error.messages}
        raise SpecError(written.problem(places[name], text) for name, text in error.messages.items()) from None
    except ToyError as error:
        problems = str(error).splitlines()
        raise SpecError(written.problem(("scene", "toys", "root"), problem) for problem in problems) from None


def _own(kind: str, scene: SceneSpec, written: Source) -> tuple[Wallpaper, ...]:
    path = getattr(scene.textures, kind)
    if path is None:
        return ()
    try:
        return read_textures(written.folder / Path(path).expanduser())
    except TextureError as error:
        problems = str(error).splitlines()
        raise SpecError(written.problem(("scene", "textures", kind), problem) for problem in problems) from None


UP = (0.0, 0.0, 1.0)


def place_pose(pose: Keyframe, start: Placement) -> Keyframe:
    """Return a pose elsewhere on the floor, turned about the vertical."""
    x, y, z, *turn = pose.qpos[:7]
    ((x, y, z),) = place_discs(np.array([(x, y, z)]), start).tolist()
    w, i, j, k = turn
    turned = quaternion_product(quaternion_from_axis(UP, start.yaw_rad), (w, i, j, k))
    return Keyframe(pose.name, (x, y, z, *turned, *pose.qpos[7:]), pose.settings)


def place_object(thing: FreeObject, start: Placement) -> FreeObject:
    """Return an object elsewhere on the floor; it is not turned, for it looks the same from all sides."""
    (x, y, _), z = place_discs(np.array([thing.pos_m]), start)[0].tolist(), thing.pos_m[2]
    return replace(thing, pos_m=(x, y, z))


def place_discs(discs: FloatArray, start: Placement) -> FloatArray:
    """Return discs elsewhere on the floor, turned about the vertical with what is at the origin."""
    places = discs[:, :2] @ matrix_from_axis(UP, start.yaw_rad)[:2, :2].T + (start.x_m, start.y_m)
    return np.column_stack([places, discs[:, 2]])


@dataclass(frozen=True, slots=True)
class PlacedScene:
    """An infant in the world of its spec."""

    scene: SceneTree  # The infant and its world, ready to print.
    toys: tuple[FreeObject, ...]
    task_objects: tuple[FreeObject, ...]  # The movable objects of the task.
    origins: Mapping[str, Entry]  # Provenance of the numbers of the scene.
    things: tuple[PlacedThing, ...] = ()  # The objects of the spec.
    caregiver: CaregiverEntry | None = None  # What the manifest says of the caregiver.


def set_up_task(
    scene: SceneTree, spec: InfantSpec, tree: BodyTree, actuation: ActuationSetup
) -> tuple[SceneTree, TaskSetup]:
    """Return the scene, with the starting pose of its task if there is one, and the setup of the task.

    Poses in which held parts or locked joints would be elsewhere are removed: the constraints would pull the infant
    out of them. An UnsupportedTaskError says which part the infant lacks.

    """
    setup = build_task(spec.task, tree, spec.control.step_ms)
    poses = scene.keyframes
    if spec.scene.start_at is not None:
        at = start_at(spec.scene, tree, {pose.name: pose.qpos for pose in poses})
        poses = tuple(actuation.at_rest(Keyframe(name, state)) for name, state in at.states.items())
        setup = replace(setup, holds=(*setup.holds, *at.holds), ahead_m=at.ahead_m)
    if spec.task and setup.start is not None:
        keyframe = Keyframe(spec.task.kind, setup.start)
        poses = (*poses, actuation.at_rest(keyframe))
    (start,) = (pose for pose in poses if pose.name == start_pose(spec, setup))
    joints, held = locked_joints(spec, tree, setup), holds(spec, tree, setup)
    kept = tuple(pose for pose in poses if keeps(joints, held, tree, start.qpos, pose.qpos))
    return replace(scene, keyframes=kept), setup


def start_pose(spec: InfantSpec, setup: TaskSetup) -> str:
    """Return the name of the keyframe that a reset starts from."""
    return spec.scene.pose if spec.task is None or setup.start is None else spec.task.kind


def covered_floor(scene: SceneTree, spec: SceneSpec, tree: BodyTree) -> FloatArray:
    """Return the floor area that an infant covers in all its poses, as discs, shape (n, 3); none if not needed."""
    if spec.toys is None and not SCENES[spec.kind].needs_footprint:
        return np.empty((0, 3))
    return footprint(tree, [pose.qpos for pose in scene.keyframes])


def place_in_scene(
    scene: SceneTree,
    spec: InfantSpec,
    tree: BodyTree,
    assets: SceneAssets,
    setup: TaskSetup = NO_TASK,
    discs: FloatArray | None = None,
) -> PlacedScene:
    """Return a scene, whose infant is at the origin, with the world of its spec and the infant's poses placed in it.

    The infant's `covered_floor`, *discs*, can be given if it is known: it is the same for every seed.

    Raises:
        NoSpaceError, ToyError: If there is no place for the toys, or a mesh cannot be used.
        ObjectError: If an object cannot be where it is to be.

    """
    discs = covered_floor(scene, spec.scene, tree) if discs is None else discs
    build = function_of(SCENES[spec.scene.kind].build, "build")
    built: BuiltScene = build(spec.scene, Occupant(tree, discs), assets.wallpapers)
    objects, place = place_furniture(spec.scene, built.start, setup.ahead_m)
    built = replace(built, start=place)
    starts = {pose.name: place_pose(pose, built.start) for pose in scene.keyframes}
    start = starts[start_pose(spec, setup)]
    folder = spec.source.folder if spec.source else Path()
    things = place_objects(objects, {"": surroundings(spec.scene, built, tree, start, built.start, folder)})
    company = place_caregiver(spec.scene.caregiver, tree, start.qpos)
    taken = place_discs(np.concatenate([discs, np.reshape(setup.taken, (-1, 3))]), built.start)
    toys = toys_around(spec.scene, built, tree, start, np.concatenate([taken, discs_of(things)]), assets.toybox)
    task_objects = tuple(place_object(thing, built.start) for thing in setup.objects)
    world = replace(
        built.world,
        furniture=sum((thing.built.pictures for thing in things), built.world.furniture + setup.furniture),
        gravity_m_s2=WEIGHTLESS if setup.weightless else built.world.gravity_m_s2,
        objects=(*toys, *task_objects),
        placed=tuple(thing.elements for thing in things),
        persona=company.persona if company else NOBODY,
        locks=lock(locked_joints(spec, tree, setup), tree, start.qpos),
        welds=weld(holds(spec, tree, setup), tree, start.qpos),
    )
    ends = {name: settings_at(company, tree, pose.qpos) for name, pose in starts.items()}
    poses = tuple(
        replace(pose, qpos=(*pose.qpos, *world.resting), settings=(*pose.settings, *ends[name]))
        for name, pose in starts.items()
    )
    placed = replace(scene, world=replace(world, pairs=barrier_pairs(world, scene.roots)), keyframes=poses)
    placed = replace(placed, keyframes=free_poses(placed, start.name, spec.scene.objects, things))
    origins = {**built.origins, **trace_objects(things), **(company.origins if company else {})}
    return PlacedScene(placed, toys, task_objects, origins, things, company and company.entry)


@contextmanager
def errors_in_file(written: Callable[[], Source]) -> Iterator[None]:
    """Let errors of objects and toys be SpecErrors, which say where in a file the scene says so."""
    try:
        yield
    except ObjectError as error:
        path = "scene", "objects", error.number, error.key
        raise SpecError([written().problem(path, str(error))]) from None
    except (NoSpaceError, ToyError) as error:
        raise SpecError(written().problem(("scene", "toys"), line) for line in str(error).splitlines()) from None


def check_offers(
    caregiver: CaregiverSpec | None,
    toys: Sequence[FreeObject],
    things: Sequence[PlacedThing],
    written: Callable[[], Source],
) -> None:
    """Check that a caregiver's script offers what moves freely in the scene; a SpecError lists all acts that do not."""
    if caregiver is None:
        return
    objects = {thing.entry.name: thing.entry.motion for thing in things}
    names = {name for toy in toys for name in (toy.name, toy.object, toy.category)}
    names |= {name for name, motion in objects.items() if motion == "free"}
    missing = {
        number: f"'{act.object}' is {objects[act.object]}; offer something that moves freely"
        if act.object in objects
        else f"there is no '{act.object}' in this scene; {suggestion(act.object, names) if names else 'add it'}"
        for number, act in enumerate(caregiver.script)
        if act.object is not None and act.object not in names
    }
    if missing:
        script = "scene", "caregiver", "script"
        raise SpecError(written().problem((*script, number, "object"), text) for number, text in missing.items())


def discs_of(things: Iterable[PlacedThing]) -> FloatArray:
    """Return the floor below objects, as discs by x, y and radius, shape (n, 3), [m]."""
    return np.reshape([disc for thing in things for disc in thing.discs], (-1, 3))


def surroundings(
    spec: SceneSpec, built: BuiltScene, tree: BodyTree, start: Keyframe, place: Placement, folder: Path
) -> Surroundings:
    """Return what objects are placed among, an infant that starts in a pose at a place, and where their files are."""
    return Surroundings(tree, start.qpos, place, built.half_size_m, SCENES[spec.kind].has_floor, folder)


def toys_around(
    spec: SceneSpec, built: BuiltScene, tree: BodyTree, start: Keyframe, taken: FloatArray, toybox: Toybox
) -> tuple[FreeObject, ...]:
    """Return the toys of a scene, around the infant's starting position and outside of occupied discs."""
    if spec.toys is None:
        return ()
    toys = choose_toys(spec.toys, spec.seed, toybox)
    qpos = start.qpos
    reach = reachable_floor(tree, qpos) or ReachableFloor((qpos[0], qpos[1]), reach_of(taken - (*qpos[:2], 0.0)), 0.1)
    places = place_toys(
        [toy.radius_m for toy in toys], reach, Floor(built.half_size_m, taken), stream(spec.seed, "toys.place")
    )
    if places is None:
        raise NoSpaceError(
            f"there is not enough space for {len(toys)} toys; use fewer or smaller ones, or a larger room"
        )
    return tuple(
        make_object(toy, number, place) for number, (toy, place) in enumerate(zip(toys, places, strict=True), 1)
    )
