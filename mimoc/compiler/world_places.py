"""Where the infants of a world are: as its file says, or side by side; and what belongs to them there."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.rotations import Vec3, matrix_from_axis, matrix_from_euler
from mimoc.base.rounding import rounded
from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import FloatArray
from mimoc.body.origins import Entry
from mimoc.bundle.world import START
from mimoc.compiler.building import Builder
from mimoc.compiler.caregiver import HEAD, BuiltCaregiver, place_caregiver, settings_at
from mimoc.compiler.mjcf.elements import Furniture, WorldGeom
from mimoc.compiler.mjcf.printing import prefixed, prefixed_scene
from mimoc.compiler.mjcf.scene import Keyframe, SceneTree
from mimoc.compiler.mjcf.world import FreeObject, Lock, Persona, Weld
from mimoc.compiler.model_check import model_without_pictures
from mimoc.compiler.placing import place_discs, place_object, place_pose, start_pose
from mimoc.compiler.scenes import Placement
from mimoc.compiler.task_setup import holds, lock, locked_joints, weld
from mimoc.schema.caregiver import CaregiverEntry, CaregiverSpec
from mimoc.schema.world import WorldPlan

GAP_CM = 10.0  # Between two infants that are side by side, whatever poses of theirs they are in.
UP = (0.0, 0.0, 1.0)
Poses = Mapping[str, Keyframe]  # The state of each infant, by its name.


@dataclass(frozen=True)
class InfantPart:
    """What an infant adds to its world, placed there, all its names with its prefix."""

    prefix: str
    tree: SceneTree  # The infant.
    poses: Mapping[str, Keyframe]  # Its states, by pose.
    start: str  # The pose that its spec gives.
    objects: tuple[FreeObject, ...]  # The movable objects of its task.
    furniture: Furniture  # The other objects of its task.
    locks: tuple[Lock, ...]
    welds: tuple[Weld, ...]
    taken: FloatArray  # Floor that it covers in all its poses, and its task: discs, shape (n, 3), [m].


def places_of(plan: WorldPlan, builders: Mapping[str, Builder]) -> dict[str, Placement]:
    """Return where each infant of a world is: as its file says, or side by side along y, centimetres rounded up."""
    yaws = [math.radians(item.yaw_deg % 360.0) for item in plan.spec.placed]
    turned = zip(builders.values(), yaws, strict=True)
    # Where the middles of infants, each of which covers discs around its own, are along y in a row, [cm].
    infants = [place_discs(builder.infant_and_task_discs, Placement(0.0, 0.0, yaw)) for builder, yaw in turned]
    ends = [((discs[:, 1] - discs[:, 2]).min(), (discs[:, 1] + discs[:, 2]).max()) for discs in infants]
    middles_cm, end_cm = [], 0
    for low_m, high_m in ends:
        middles_cm.append(end_cm + math.ceil(-100 * low_m))
        end_cm = middles_cm[-1] + math.ceil(100 * high_m) + GAP_CM
    middle_cm = math.floor((end_cm - GAP_CM) / 2)
    row_cm = [float(y_cm - middle_cm) for y_cm in middles_cm]
    return {
        name: Placement(cm_to_m(item.x_cm or 0.0), cm_to_m(y_cm if item.y_cm is None else item.y_cm), yaw)
        for name, item, y_cm, yaw in zip(builders, plan.spec.placed, row_cm, yaws, strict=True)
    }


def entries_of(plan: WorldPlan, builders: Mapping[str, Builder]) -> list[dict[str, Any]]:
    """Return the infants of a world as its file lists them, with the names and the places that it leaves open."""
    entries = list[dict[str, Any]]()
    at = {item.name: item.at for item in plan.spec.scene.objects}
    for item, (name, place) in zip(plan.spec.placed, places_of(plan, builders).items(), strict=True):
        entry: dict[str, Any] = {"name": name, "spec": item.spec}
        if item.start_at is None or at[item.start_at] is None:  # Otherwise, the furniture takes it to its place.
            y_cm = rounded(100 * place.y_m) if item.y_cm is None else item.y_cm
            entry |= {"x_cm": item.x_cm or 0.0, "y_cm": y_cm, "yaw_deg": item.yaw_deg}
        entries.append(entry | ({} if item.start_at is None else {"start_at": item.start_at}))
    return entries


def trace_places(plan: WorldPlan, places: Mapping[str, Placement]) -> Iterator[tuple[str, Entry]]:
    """Yield where the places of infants come from."""
    for name, item, place in zip(places, plan.spec.placed, places.values(), strict=True):
        row = f"side by side along y, {GAP_CM:g} cm apart in whatever poses of theirs, in whole centimetres"
        rules = {"x_m": None if item.x_cm is None else "as given", "y_m": row if item.y_cm is None else "as given"}
        for key in ("x_m", "y_m"):
            rule = rules[key] or "in the row"
            yield (
                f"place.{name}.{key}",
                {"value": getattr(place, key), "unit": "m", "rule": rule, "from": ["spec.infants"]},
            )


def within(group: Placement, place: Placement) -> Placement:
    """Return a place in the frame of a group of infants as one in the world."""
    (x_m, y_m, _) = place_discs(np.array([(place.x_m, place.y_m, 0.0)]), group)[0].tolist()
    return Placement(x_m, y_m, (group.yaw_rad + place.yaw_rad) % (2 * math.pi))


def part_of(builder: Builder, place: Placement, prefix: str) -> InfantPart:
    """Return what an infant adds to its world at a place."""
    spec, tree, setup = builder.spec, builder.tree, builder.task_setup
    poses = {pose.name: place_pose(pose, place) for pose in builder.infant.keyframes}
    start = start_pose(spec, setup)
    state = poses[start].qpos
    furniture = replace(setup.furniture, geoms=tuple(place_geom(geom, place) for geom in setup.furniture.geoms))
    return InfantPart(
        prefix=prefix,
        tree=prefixed_scene(builder.infant, prefix),
        poses=poses,
        start=start,
        objects=tuple(prefixed(place_object(thing, place), prefix) for thing in setup.objects),
        furniture=prefixed(furniture, prefix),
        locks=tuple(prefixed(item, prefix) for item in lock(locked_joints(spec, tree, setup), tree, state)),
        welds=tuple(prefixed(item, prefix) for item in weld(holds(spec, tree, setup), tree, state)),
        taken=place_discs(builder.infant_and_task_discs, place),
    )


def place_geom(geom: WorldGeom, place: Placement) -> WorldGeom:
    """Return a thing that is fixed to the world elsewhere on the floor, turned about the vertical."""
    (x_m, y_m, _) = place_discs(np.array([(*geom.pos_m[:2], 0.0)]), place)[0].tolist()
    turned = matrix_from_axis(UP, place.yaw_rad) @ matrix_from_euler(tuple(map(math.degrees, geom.euler_rad)))
    return replace(geom, pos_m=(x_m, y_m, geom.pos_m[2]), euler_rad=_euler_rad(turned))


def _euler_rad(turn: FloatArray) -> Vec3:
    """Return the angles about x, y and z in turn, each axis as the former left it, of a matrix, shape (3, 3)."""
    about_y = math.asin(min(1.0, max(-1.0, float(turn[0, 2]))))
    return math.atan2(-turn[1, 2], turn[2, 2]), about_y, math.atan2(-turn[0, 1], turn[0, 0])


Settings = tuple[tuple[str, tuple[float, ...]], ...]  # Attributes of a keyframe, and their numbers.


def states_of(
    name: str, parts: Mapping[str, InfantPart], resting: Sequence[float], beside: Callable[[Poses], Settings]
) -> list[Keyframe]:
    """Return a state of a name with all infants as they start, and for each of their poses one with only this changed.

    Those of the poses are called by them, with the prefix of the infant. *resting* is what else moves, as in
    `World.resting`, and *beside* returns what a state says of the bodies that programs move, by the poses of infants.

    """
    starts = {infant: part.poses[part.start] for infant, part in parts.items()}
    states = {name: starts}
    for infant, part in parts.items():
        states |= {part.prefix + pose: {**starts, infant: keyframe} for pose, keyframe in part.poses.items()}
    return [_state(key, list(parts.values()), poses, resting, beside(poses)) for key, poses in states.items()]


def _state(
    name: str, parts: Sequence[InfantPart], poses: Poses, resting: Sequence[float], beside: Settings
) -> Keyframe:
    """Return the state of a world: all infants, then what else moves."""
    qpos = [*(number for pose in poses.values() for number in pose.qpos), *resting]
    given = dict.fromkeys(key for pose in poses.values() for key, _ in pose.settings)
    settings = tuple((key, tuple(_padded(key, parts, list(poses.values())))) for key in given)
    return Keyframe(name, tuple(qpos), (*settings, *beside))


def _padded(key: str, parts: Sequence[InfantPart], poses: Sequence[Keyframe]) -> Iterator[float]:
    """Yield what states say of all actuators, 0 of those that they say nothing of."""
    for part, pose in zip(parts, poses, strict=True):
        tree, values = part.tree, dict(pose.settings).get(key, ())
        active = dict(tree.actuator_defaults).get("dyntype", "none") != "none"
        count = len(tree.actuators) + len(tree.reflexes) if key == "ctrl" else len(tree.actuators) * active
        yield from (*values, *[0.0] * (count - len(values)))


IntArray = npt.NDArray[np.intp]
GAP_M = 0.02  # Smallest gap between it and the other infants, as all start; an assumption.
PLACES = (
    {"place": "in_front"},
    {"place": "beside", "side": "left"},
    {"place": "beside", "side": "right"},
    {"place": "above"},
)
"""Where it is tried, unless its spec says where it is."""


@dataclass(frozen=True)
class WorldCaregiver:
    """A caregiver at its place by one of several infants."""

    infant: str  # The infant that it is by.
    built: BuiltCaregiver
    entries: Mapping[str, CaregiverEntry]
    """What the manifest of each infant says of it: the face and the kicks in it are that infant's."""

    @property
    def persona(self) -> Persona:
        """All of it that stands in the MJCF."""
        return self.built.persona

    @property
    def origins(self) -> Mapping[str, Entry]:
        """Where its numbers come from."""
        return self.built.origins

    def settings_at(self, builders: Mapping[str, Builder], poses: Poses) -> Settings:
        """Return what a keyframe says of its bodies."""
        return settings_at(self.built, builders[self.infant].tree, poses[self.infant].qpos)

    def in_the_way(self, mjcf: Mapping[str, bytes], parts: Mapping[str, InfantPart]) -> str:
        """Return another infant that it would be within as all start, or that would hide its infant from it, or ""."""
        model = model_without_pictures(mjcf)
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(START).id)
        mujoco.mj_kinematics(model, data)
        entry = self.entries[self.infant]
        adult = [model.body(body.name).id for body in self.persona.bodies]
        own = np.flatnonzero(np.isin(model.geom_bodyid, adult))
        head = data.body(entry.head)
        face = data.body(f"{parts[self.infant].prefix}{HEAD}")
        way_m = face.xpos - head.xpos
        hit = np.full(1, -1, np.int32)
        model.geom_matid[:], model.geom_rgba[:, 3] = -1, 1.0
        model.geom_rgba[own, 3] = 0.0  # Rays pass through what is not drawn.
        mujoco.mj_ray(model, data, head.xpos, way_m, None, 0, -1, hit)
        seen = model.body_rootid[model.geom_bodyid[hit[0]]] if hit[0] >= 0 else -1
        for name, part in parts.items():
            root = model.body(part.tree.roots[0].name).id
            theirs = np.flatnonzero(model.body_rootid[model.geom_bodyid] == root)
            if name != self.infant and (seen == root or _are_near(model, data, own, theirs)):
                return name
        return ""


def _are_near(model: mujoco.MjModel, data: mujoco.MjData, own: IntArray, theirs: IntArray) -> bool:
    apart_m = np.linalg.norm(data.geom_xpos[own][:, None] - data.geom_xpos[theirs], axis=2)
    reach_m = model.geom_rbound[own][:, None] + model.geom_rbound[theirs] + GAP_M
    pairs = np.argwhere(apart_m < reach_m).tolist()
    return any(
        mujoco.mj_geomDistance(model, data, own[one], theirs[other], GAP_M, None) < GAP_M for one, other in pairs
    )


def caregivers(
    spec: CaregiverSpec, builders: Mapping[str, Builder], parts: Mapping[str, InfantPart]
) -> Iterator[WorldCaregiver]:
    """Yield the caregiver at each place that it can have by an infant, the most usual first."""
    is_free = not {"place", "side", "height_cm"} & spec.model_fields_set and len(parts) > 1
    infant = spec.infant or next(iter(parts))
    for place in PLACES if is_free else ({},):
        placed = spec.model_copy(update=place)
        built = {
            name: place_caregiver(placed, builders[name].tree, part.poses[part.start].qpos, part.prefix)
            for name, part in parts.items()
        }
        own = {name: one for name, one in built.items() if one}
        about = {"infant": infant, "answers_all": spec.infant is None}
        yield WorldCaregiver(
            infant, own[infant], {name: one.entry.model_copy(update=about) for name, one in own.items()}
        )
