"""Columns of what acts: contacts and ground reaction, angles and torques of joints, activations."""

import math
from collections.abc import Sequence
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np

from mimoc.base.units import rad_to_deg
from mimoc.components.senses.touch.contacts import contact_forces, skin_body_of_geoms
from mimoc.recording.movement_columns.anatomy import IntArray, Parts
from mimoc.recording.movement_columns.column import Column, FloatArray, Group, Values
from mimoc.runtime.infant import Infant
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import worlds_of_one

Moment = tuple[np.ndarray, ...]
APART = "; "
"""Between the names of several things that one part touches."""
_FORCE = "MuJoCo's contacts and efc_force"


def bind_contacts(env: Infant) -> Group:
    """Return which part touches what and how hard, and the force of all that is fixed on the infant: ground reaction.

    Contacts within one part do not count. A part touches what presses on it with any force.
    """
    parts = Parts.of(env)
    touching = _Touching(parts, env.data)
    columns = [
        *(Column(f"{part}_contact_n", "N", _SUM.format(_words(part)), source=_FORCE) for part in parts.names),
        *(Column(f"{part}_ground_z_n", "N", _UPWARD.format(_words(part)), source=_FORCE) for part in parts.names),
        *(Column(f"ground_reaction_{axis}_n", "N", f"{axis} of the {_GROUND}", source=_FORCE) for axis in "xyz"),
        *(
            Column(f"{part}_touches", "", _TOUCHED.format(_words(part)), source=_FORCE, is_text=True)
            for part in parts.names
        ),
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
            part, other = (
                self._part_of_body[forces.bodies],
                self._thing_of_geom[contact.geom[forces.contacts]].sum(axis=1),
            )
            other, time, normal_n = other - part, time_of_contact[forces.contacts], forces.normal_forces_n[:, 0]
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
    counts, rows = [len(moment[0]) for moment in moments], np.array([len(moment[-1]) for moment in moments])
    first_row, time = np.cumsum(rows) - rows, np.repeat(np.arange(len(moments)), counts)
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
        return Values(np.hstack([fields[0][:, addresses] * rad_to_deg(1.0), fields[1][:, dofs]]))

    names = {joint: model.joint(joint).name.rpartition(":")[2] for joint in hinges}
    angles = [
        Column(f"{names[joint]}_angle_deg", "°", f"angle of the joint {names[joint]}", _ANGLE, "MuJoCo's qpos")
        for joint in hinges
    ]
    torques = [
        Column(f"{names[joint]}_torque_nm", "N m", f"{_TORQUE} {names[joint]}", _JOINT, "MuJoCo's qfrc_actuator")
        for joint in moved
    ]
    return Group((*angles, *torques), values, (env.data.qpos, env.data.qfrc_actuator))


_JOINT = "about the joint's axis, positive towards larger angles; of the last physics step that was computed"
_ANGLE = "about the joint's axis; at time_s"
_TORQUE = "torque of motors or muscles about the joint"


def bind_actuators(env: Infant) -> Group:
    """Return what drives each muscle or motor: its activation, or the command of motors without one."""
    actuation, drive, worlds = env.actuation, stack_terms([env.actuation.drive]), worlds_of_one(env.data)
    names = [env.model.actuator(index).name.rpartition(":")[2] for index in actuation.actuators]

    columns = [
        Column(
            f"{name}_{actuation.drive_name}",
            "",
            f"{actuation.drive_name} of the muscle or motor {name}, as a share of the largest",
            "at time_s",
            "the actuation model",
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
