"""The movement columns of an infant: where it is, how it moves, what it touches and looks at, and what drives it.

A column is a `Quantity` over control steps whose name ends with its unit, such as `right_hand_speed_m_s`; its `frame`
and `source` say all that a stranger must know to use it. See `docs/movement_data.md`.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, NamedTuple

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.movement_quantities import APART
from mimoc.base.quantity import Quantity
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.components.senses.touch.receptors import contact_forces, skin_body_of_geoms
from mimoc.runtime.infant import Infant
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import worlds_of_one
from mimoc.schema.objects import ObjectEntry

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
WORLD = "world: x and y horizontal, z up; of the last physics step that was computed"
"""Frame and time of what follows from the positions of bodies."""


class Values(NamedTuple):
    """The values of some columns at some times."""

    numbers: FloatArray  # Values of the columns that have numbers, shape (times, columns).
    texts: Sequence[tuple[str, ...]] = ()
    """Values of the columns that have names: a tuple for each time; none if there are no such columns."""


@dataclass(frozen=True, slots=True)
class Group:
    """Columns of one infant that are read together: copied at each time, computed for many times at once."""

    columns: tuple[Quantity, ...]  # Those of numbers first.
    values: Callable[[Sequence[FloatArray], Sequence[Any]], Values]
    """Computes them, given `fields` at all times, each with a leading axis of times, and what `moment` returned."""
    fields: tuple[FloatArray, ...] = ()  # Arrays of `MjData` that are copied at each time.
    moment: Callable[[], Any] | None = None  # Returns what else is kept of a time.


NO_COLUMNS = Group((), lambda fields, moments: Values(np.empty((0, 0))))  # What an infant has none of.


def _column(name: str, unit: str, about: str, source: str, frame: str = WORLD, *, is_text: bool = False) -> Quantity:
    return Quantity(name, about, unit, about, steps=("record",), source=source, frame=frame, is_text=is_text)


SCENE = "scene"  # What has no name of its own and does not move.


@dataclass(frozen=True)
class Parts:
    """Parts of an infant's body: its bodies, but hands with their fingers, feet with their toes, head with its eyes.

    Its own parts are named as those of an infant that is alone; those of others in its world begin with their names,
    such as `ben_left_hand`.
    """

    model: mujoco.MjModel
    manifest: Manifest
    others: Sequence[Manifest] = ()  # The infants that share its world.
    object_entries: Sequence[ObjectEntry] = ()  # The objects of the scene.

    @classmethod
    def of(cls, infant: Infant) -> "Parts":
        """Return the parts of an infant, and what else there is where it is."""
        others = [other.manifest for other in infant.simulation.infants.values() if other is not infant]
        return cls(infant.model, infant.manifest, others, infant.simulation.bundle.manifest.objects)

    @cached_property
    def whole(self) -> tuple[str, ...]:
        """Bodies that what hangs on them is a part of."""
        return _whole(self.manifest)

    @cached_property
    def bodies(self) -> IntArray:
        """The infant's bodies."""
        return _bodies(self.model, self.manifest)

    @cached_property
    def part_of_body(self) -> dict[int, str]:
        """The name of the part that each of its bodies belongs to, in the model's order."""
        parts = _parts_of_bodies(self.model, self.manifest)
        return {body: self.manifest.of_infant(name) for body, name in parts.items()}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all parts, in the model's order."""
        return tuple(dict.fromkeys(self.part_of_body.values()))

    @cached_property
    def things(self) -> tuple[str, ...]:
        """Names of its parts, then of all else that there is in the model."""
        return tuple(dict.fromkeys((*self.names, *map(self._thing, range(self.model.ngeom)))))

    @cached_property
    def thing_of_geom(self) -> IntArray:
        """Index in `things` of what each geom belongs to, shape (ngeom,)."""
        index = {name: number for number, name in enumerate(self.things)}
        return np.array([index[self._thing(geom)] for geom in range(self.model.ngeom)], np.intp)

    @cached_property
    def objects(self) -> dict[int, str]:
        """The name of each of the spec's objects, by its outermost body."""
        return {int(self.model.body(item.body).id): item.name for item in self.object_entries}

    @cached_property
    def _part_of_others(self) -> dict[int, str]:
        parts = (_parts_of_bodies(self.model, other) for other in self.others)
        return {body: name for of_other in parts for body, name in of_other.items()}

    def _thing(self, geom: int) -> str:
        """Return what a geom belongs to: a part, an object, a fixed thing named as its geom, or the body that moves."""
        body = int(self.model.geom_bodyid[geom])
        if part := self.part_of_body.get(body) or self._part_of_others.get(body):
            return part
        if (outermost := int(self.model.body_rootid[body])) in self.objects:
            return self.objects[outermost]
        if self.model.body_weldid[body] == 0:
            return self.model.geom(geom).name or self.model.body(body).name or SCENE
        return self.model.body(body).name or self.model.geom(geom).name or SCENE


def _whole(manifest: Manifest) -> tuple[str, ...]:
    anatomy = manifest.anatomy
    ends = [limb.end for limb in (*anatomy.arms, *anatomy.legs)]
    return tuple(body for body in (*ends, anatomy.head) if body)


def _bodies(model: mujoco.MjModel, manifest: Manifest) -> IntArray:
    return np.flatnonzero(in_subtrees(model, [model.body(manifest.root_body).id]))


def _parts_of_bodies(model: mujoco.MjModel, manifest: Manifest) -> dict[int, str]:
    """Return the name, in the model, of the part that each body of an infant belongs to, in the model's order."""
    parts = {int(body): model.body(body).name for body in _bodies(model, manifest)}
    for name in _whole(manifest):
        inside = np.flatnonzero(in_subtrees(model, [model.body(name).id]))
        parts |= dict.fromkeys(inside.tolist(), name)
    return parts


AXES = "xyz"
SIDES = {"L": "left_", "R": "right_"}
BODY = "body"  # The name of all parts together.
TRUNK = "trunk"
_LABEL = re.compile(r"([LR](?=[A-Z]))?([A-Z]\w*)")
_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")


def keypoint_name(label: str) -> str:
    """Return the name of a keypoint of BODY_25: `right_big_toe` for `BODY_25:RBigToe`."""
    match = _LABEL.fullmatch(label.rpartition(":")[2])
    side, point = match.groups() if match else (None, label)
    return SIDES.get(side or "", "") + _CAPITAL.sub("_", point).lower()


def bind_keypoints(env: Infant) -> Group:
    """Return where the keypoints of `InfantEnv.keypoints` are, to the bit; NaN for those of missing limbs."""
    labels = env.manifest.keypoints
    sites = np.array([mujoco.mj_name2id(env.model, mujoco.mjtObj.mjOBJ_SITE, label) for label in labels], np.intp)

    def values(fields: Sequence[FloatArray], moments: object) -> Values:
        places_m = fields[0][:, sites]
        places_m[:, sites < 0] = np.nan
        return Values(places_m.reshape(len(places_m), -1))

    columns = [column for label in labels for column in _place(keypoint_name(label), *_KEYPOINT)]
    return Group(tuple(columns), values, (env.data.site_xpos,))


def bind_parts(env: Infant) -> Group:
    """Return position, velocity and speed of the centres of mass of hands, feet, head, trunk and the whole body.

    A part of bodies i with the masses m_i has its centre of mass at sum m_i x_i / sum m_i, which moves with
    sum m_i v_i / sum m_i, where v_i = v + w x (x_i - c) from the spatial velocity (w, v) of the body about c, the
    centre of mass of the infant, as MuJoCo's `cvel` gives it.
    """
    parts, model = Parts.of(env), env.model
    inside = _bodies_of_parts(parts)
    bodies = parts.bodies
    root = int(model.body_rootid[parts.bodies[0]])
    shares = np.array([np.isin(bodies, of_part) * model.body_mass[bodies] for of_part in inside.values()])
    shares /= shares.sum(axis=1, keepdims=True)

    columns = tuple(column for name in inside for column in _motion(name))

    def values(fields: Sequence[FloatArray], moments: object) -> Values:
        places_m = fields[0][:, bodies]
        spatial = fields[1][:, bodies]
        about_m = fields[2][:, None]
        velocities = spatial[..., 3:] + np.cross(spatial[..., :3], places_m - about_m)
        motion = np.empty((len(places_m), len(shares), 7))
        motion[..., :3], motion[..., 3:6] = shares @ places_m, shares @ velocities
        motion[..., 6] = np.linalg.norm(motion[..., 3:6], axis=-1)
        return Values(motion.reshape(len(places_m), -1))

    return Group(columns, values, (env.data.xipos, env.data.cvel, env.data.subtree_com[root]))


def bind_objects(env: Infant) -> Group:
    """Return position, velocity and speed of the centre of mass of the outermost body of each object of the spec.

    It moves with v = v' + w x (x - c), where (w, v') is its spatial velocity about c, the centre of mass of the object.
    """
    entries = env.simulation.bundle.manifest.objects
    if not entries:
        return NO_COLUMNS
    bodies = np.array([env.model.body(item.body).id for item in entries], np.intp)

    def values(fields: Sequence[FloatArray], moments: object) -> Values:
        places_m, spatial, about_m = (field[:, bodies] for field in fields)
        velocities = spatial[..., 3:] + np.cross(spatial[..., :3], places_m - about_m)
        speeds = np.linalg.norm(velocities, axis=-1, keepdims=True)
        return Values(np.concatenate([places_m, velocities, speeds], axis=-1).reshape(len(places_m), -1))

    columns = [column for item in entries for column in _motion(f"object_{item.name}", _OBJECT)]
    return Group(tuple(columns), values, (env.data.xipos, env.data.cvel, env.data.subtree_com))


def bind_gaze(env: Infant) -> Group:
    """Return where the line of sight first meets something that is not the head: of both eyes, or of the only one.

    It begins midway between the eyes' cameras, and points along the mean of the directions in which they look.
    """
    model, head = env.model, env.manifest.anatomy.head
    eyes = np.array([model.camera(eye.camera).id for eye in env.manifest.anatomy.eyes], np.intp)
    if not len(eyes):
        return NO_COLUMNS
    parts, geom = Parts.of(env), np.zeros(1, np.int32)
    data = env.data
    cam_xpos = env.data.cam_xpos
    cam_xmat = env.data.cam_xmat
    mean = np.bincount(eyes, minlength=model.ncam) / len(eyes)
    own_head = env.manifest.of_infant(head) if head else ""
    skipped = parts.things.index(own_head) if own_head in parts.things else -1
    excluded = model.body(head).id if head else -1

    def moment() -> tuple[FloatArray, FloatArray, float, int]:
        start_m, towards = mean @ cam_xpos, (-mean @ cam_xmat)[2::3]  # Cameras look along -z; it need not be a unit.
        times, thing, begin_m = 0.0, skipped, start_m
        while thing == skipped:  # The eyes are bodies of their own, through which it may pass.
            further = mujoco.mj_ray(model, data, begin_m, towards, None, 1, excluded, geom)
            if further < 0:
                return start_m, towards, math.nan, -1
            times = times + float(further) + _BEYOND
            thing = int(parts.thing_of_geom[int(geom[0])])
            begin_m = start_m + times * towards
        return start_m, towards, times - _BEYOND, thing

    def values(fields: object, moments: Sequence[tuple[FloatArray, FloatArray, float, int]]) -> Values:
        start_m, towards, times = (np.array([item[index] for item in moments]) for index in range(3))
        length = np.linalg.norm(towards, axis=1, keepdims=True)
        times = times[:, None]
        numbers = np.hstack([start_m + times * towards, times * length, towards / length])
        return Values(numbers, [(parts.things[thing] if thing >= 0 else "",) for *_, thing in moments])

    return Group(_GAZE, values, moment=moment)


_BEYOND = 1e-6  # How far behind a surface of the eyes the line of sight goes on, about [m].
_RAY = "MuJoCo's mj_ray from between the cameras of the eyes"
_SIGHT = "mean line of sight of the eyes"
_GAZE = (
    *(
        _column(f"gaze_{axis}_m", "m", f"{axis} of where the {_SIGHT} first meets something; empty if nothing", _RAY)
        for axis in AXES
    ),
    _column("gaze_distance_m", "m", "distance from between the eyes to there; empty if there is nothing", _RAY),
    *(
        _column(f"gaze_direction_{axis}", "", f"{axis} of the unit vector along the {_SIGHT}", "MuJoCo's cam_xmat")
        for axis in AXES
    ),
    _column(
        "gaze_at",
        "",
        "what it meets: a part of the own body or of another infant, a toy, a fixed thing",
        _RAY,
        is_text=True,
    ),
)


def _bodies_of_parts(parts: Parts) -> dict[str, list[int]]:
    anatomy, inside = parts.manifest.anatomy, dict[str, list[int]]()
    for name in parts.whole:
        own = parts.manifest.of_infant(name)
        inside[own] = [body for body, part in parts.part_of_body.items() if part == own]
    if anatomy.trunk:
        inside[TRUNK] = [parts.model.body(name).id for name in anatomy.trunk]
    return {**inside, BODY: list(parts.part_of_body)}


_KEYPOINT = "keypoint of BODY_25, {}", "OpenPose's BODY_25; MuJoCo's site_xpos"
_CENTRE = "centre of mass of the {}", "MuJoCo's xipos and cvel, weighted by mass"
_OBJECT = "centre of mass of the {}, of its outermost body", "MuJoCo's xipos and cvel"


def _place(name: str, what: str, source: str) -> list[Quantity]:
    about = what.format(name.replace("_", " "))
    return [_column(f"{name}_{axis}_m", "m", f"{axis} of the {about}", source) for axis in AXES]


def _motion(name: str, centre: tuple[str, str] = _CENTRE) -> list[Quantity]:
    what = centre[0].format(name.replace("_", " "))
    source = centre[1]
    return [
        *_place(name, *centre),
        *(
            _column(f"{name}_velocity_{axis}_m_s", "m/s", f"{axis} of the velocity of the {what}", source)
            for axis in AXES
        ),
        _column(f"{name}_speed_m_s", "m/s", f"length of the velocity of the {what}", source),
    ]


Moment = tuple[np.ndarray, ...]
_FORCE = "MuJoCo's contacts and efc_force"


def bind_contacts(env: Infant) -> Group:
    """Return which part touches what and how hard, and the force of all that is fixed on the infant: ground reaction.

    Contacts within one part do not count. A part touches what presses on it with any force.
    """
    parts = Parts.of(env)
    touching = _Touching(parts, env.data)
    columns = [
        *(_column(f"{part}_contact_n", "N", _SUM.format(_words(part)), _FORCE) for part in parts.names),
        *(_column(f"{part}_ground_z_n", "N", _UPWARD.format(_words(part)), _FORCE) for part in parts.names),
        *(_column(f"ground_reaction_{axis}_n", "N", f"{axis} of the {_GROUND}", _FORCE) for axis in "xyz"),
        *(_column(f"{part}_touches", "", _TOUCHED.format(_words(part)), _FORCE, is_text=True) for part in parts.names),
    ]
    return Group(tuple(columns), touching.values, moment=touching.moment)


_SUM = "sum of the normal forces of all contacts of the {} with anything else, its own body included"
_UPWARD = "upward force of all that is fixed (floor, mattress, furniture) on the {}"
_GROUND = "ground reaction, the force of all that is fixed on the whole body"
_TOUCHED = "what presses on the {}: parts of the own body or of other infants, toys, fixed things"


_FIELDS = ("geom", "frame", "dim", "efc_address")
"""What is kept of contacts; the last points into the forces of all constraints."""


class _Touching:
    """Contacts of one model."""

    def __init__(self, parts: Parts, data: mujoco.MjData):
        self._data, model = data, parts.model
        self._body_of_geom = skin_body_of_geoms(parts.bodies, model)
        self._count, self._things = len(parts.names), parts.things
        self._part_of_body = np.zeros(model.nbody, np.intp)
        for body, name in parts.part_of_body.items():
            self._part_of_body[body] = parts.names.index(name)
        self._thing_of_geom = np.append(parts.thing_of_geom, len(parts.things))  # The last is of what has no geom.
        self._is_fixed = np.zeros(len(parts.things) + 1, bool)
        self._is_fixed[parts.thing_of_geom] = model.body_weldid[model.geom_bodyid] == 0

    def moment(self) -> Moment:
        """Return what is kept of the contacts of this moment: `_FIELDS`, and the forces of all constraints."""
        contact = self._data.contact
        kept = contact.geom.copy(), contact.frame.copy(), contact.dim.copy(), contact.efc_address.copy()
        return (*kept, self._data.efc_force.copy())

    def values(self, fields: object, moments: Sequence[Moment]) -> Values:
        """Return forces by part, by part from what is fixed, and altogether from that; and names."""
        times, count = len(moments), self._count
        numbers, pairs = np.zeros((times, 2 * count + 3)), [()] * times
        contact, efc_force, time_of_contact = _joined(moments)
        if (forces := contact_forces(contact, efc_force, self._body_of_geom)) is not None:
            part = self._part_of_body[forces.bodies]
            other = self._thing_of_geom[contact.geom[forces.contacts]].sum(axis=1)
            other = other - part
            time = time_of_contact[forces.contacts]
            normal_n = forces.normal_forces_n[:, 0]
            pressing = (other != part) & (normal_n > 0)
            fixed = pressing & self._is_fixed[other]
            place = time * count + part
            numbers[:, :count] = _sums(place[pressing], normal_n[pressing], (times, count))
            numbers[:, count : 2 * count] = _sums(place[fixed], forces.forces_n[fixed, 2], (times, count))
            for axis in range(3):
                numbers[:, 2 * count + axis] = _sums(time[fixed], forces.forces_n[fixed, axis], (times,))
            pairs = self._pairs(time[pressing], part[pressing], other[pressing], times)
        named = {item: self._named(item) for item in set(pairs)}
        return Values(numbers, [named[item] for item in pairs])

    def _pairs(self, time: IntArray, part: IntArray, other: IntArray, times: int) -> list[tuple[int, ...]]:
        """Return for each time the pairs of a part and a thing that touch, as one number each, in order."""
        size = self._count * len(self._is_fixed)
        keys = np.unique(time * size + part * len(self._is_fixed) + other)
        ends = np.searchsorted(keys, np.arange(times + 1) * size)
        return [tuple((keys[start:end] % size).tolist()) for start, end in pairwise(ends)]

    def _named(self, pairs: tuple[int, ...]) -> tuple[str, ...]:
        names = [list[str]() for _ in range(self._count)]
        for pair in pairs:
            part, thing = divmod(pair, len(self._is_fixed))
            names[part].append(self._things[thing])
        return tuple(map(APART.join, names))


def _joined(moments: Sequence[Moment]) -> tuple[Any, FloatArray, IntArray]:
    fields = {name: np.concatenate([moment[index] for moment in moments]) for index, name in enumerate(_FIELDS)}
    counts = [len(moment[0]) for moment in moments]
    rows = np.array([len(moment[-1]) for moment in moments])
    first_row = np.cumsum(rows) - rows
    time = np.repeat(np.arange(len(moments)), counts)
    address = fields["efc_address"]
    fields["efc_address"] = np.where(address < 0, -1, address + first_row[time])
    nowhere = {"dist": np.zeros(len(time)), "pos": np.zeros((len(time), 3))}
    return SimpleNamespace(**fields, **nowhere), np.concatenate([moment[-1] for moment in moments]), time


def _sums(places: IntArray, amounts: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    return np.asarray(np.bincount(places, amounts, math.prod(shape)), np.float64).reshape(shape)


def bind_joints(env: Infant) -> Group:
    """Return the angle of each hinge of the infant, and the torque of motors or muscles about those that are moved."""
    model, inside = env.model, set(Parts.of(env).bodies.tolist())
    is_hinge = model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE
    hinges = [joint for joint in np.flatnonzero(is_hinge).tolist() if model.jnt_bodyid[joint] in inside]
    driven = set(model.actuator_trnid[env.actuation.actuators, 0].tolist())
    moved = [joint for joint in hinges if joint in driven]
    addresses, dofs = model.jnt_qposadr[hinges].astype(np.intp), model.jnt_dofadr[moved].astype(np.intp)

    def values(fields: Sequence[FloatArray], moments: object) -> Values:
        return Values(np.hstack([fields[0][:, addresses] * math.degrees(1.0), fields[1][:, dofs]]))

    names = {joint: model.joint(joint).name.rpartition(":")[2] for joint in hinges}
    angles = [
        _column(f"{names[joint]}_angle_deg", "°", f"angle of the joint {names[joint]}", "MuJoCo's qpos", _ANGLE)
        for joint in hinges
    ]
    torques = [
        _column(f"{names[joint]}_torque_nm", "N m", f"{_TORQUE} {names[joint]}", "MuJoCo's qfrc_actuator", _JOINT)
        for joint in moved
    ]
    return Group((*angles, *torques), values, (env.data.qpos, env.data.qfrc_actuator))


_JOINT = "about the joint's axis, positive towards larger angles; of the last physics step that was computed"
_ANGLE = "about the joint's axis; at time_s"
_TORQUE = "torque of motors or muscles about the joint"


def bind_actuators(env: Infant) -> Group:
    """Return what drives each muscle or motor: its activation, or the command of motors without one."""
    actuation = env.actuation
    drive = stack_terms([env.actuation.drive])
    worlds = worlds_of_one(env.data)
    names = [env.model.actuator(index).name.rpartition(":")[2] for index in actuation.actuators]

    columns = [
        _column(
            f"{name}_{actuation.drive_name}",
            "",
            f"{actuation.drive_name} of the muscle or motor {name}, as a share of the largest",
            "the actuation model",
            "at time_s",
        )
        for name in names
    ]
    return Group(
        tuple(columns),
        lambda fields, moments: Values(np.array(moments).reshape(len(moments), -1)),
        moment=lambda: np.array(drive(worlds)[0], float),
    )


def _words(name: str) -> str:
    return name.replace("_", " ")


BIND: Mapping[str, Callable[[Infant], Group]] = {
    "keypoints": bind_keypoints,
    "parts": bind_parts,
    "objects": bind_objects,
    "gaze": bind_gaze,
    "contacts": bind_contacts,
    "joints": bind_joints,
    "actuators": bind_actuators,
}
"""What looks up in an infant's model what the columns of a group read, by the group's name in `MOVEMENT_GROUPS`."""
