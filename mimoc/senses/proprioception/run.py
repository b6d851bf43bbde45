"""Proprioception: the angles and velocities of the joints, their torques and limits, and the state of the actuators."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.actuation.binding import bind_actuation
from mimoc.actuation.commands import all_commanded
from mimoc.actuation.spec import ActuationEntry
from mimoc.bundle.io import Bundle
from mimoc.senses.proprioception.spec import ProprioceptionEntry
from mimoc.senses.sense import FloatArray, IntArray, Sample, Vector

LIMIT_MARGIN_RAD = 0.035
"""Distance from its limit at which a joint begins to sense it (MIMo v2)."""

MAX_SPEED_RAD_S = 1e3
MAX_TORQUE_NM = 1e3
MAX_LIMIT = 1e2
"""Bounds of the observation at every age, far beyond what a stable simulation reaches."""
ANGLE_UNIT, VELOCITY_UNIT = "rad", "rad/s"
"""By which angles and velocities are known in the layout."""


@dataclass(frozen=True)
class Component:
    """One of the quantities that are sensed, for every joint, sensor or actuator."""

    read: Callable[..., FloatArray]
    """Returns it from data and the constants; each may have a leading axis of infants."""
    addresses: IntArray
    """Where `read` looks; infants for whom this is the same can be read at once."""
    high: FloatArray
    """Largest value, shape (n,); the least is its negative."""
    layout: tuple[str, ...]
    bodies: IntArray
    """The body in which each number is measured, shape (n,)."""
    constants: tuple[FloatArray, ...] = ()
    """What `read` needs of this infant, each of shape (m,)."""


class Proprioception(Vector):
    """Joint angles, then the other components in their order, shape (n,)."""

    def __init__(self, components: Sequence[Component]):
        """Join some components."""
        layout = [name for component in components for name in component.layout]
        high = np.concatenate([component.high for component in components])
        bodies = np.concatenate([component.bodies for component in components])
        super().__init__("proprioception", layout, -high, high, bodies)
        self.components = tuple(components)
        self.expression = tuple(tuple(component.addresses.tolist()) for component in components)
        self.constants = tuple(each for component in components for each in component.constants)
        ends = np.cumsum([len(component.constants) for component in components]).tolist()
        self._reads = [
            (component.read, slice(end - len(component.constants), end))
            for component, end in zip(components, ends, strict=True)
        ]

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return all components."""
        return self.measure(data, *self.constants)

    def measure(self, data: Any, *constants: FloatArray) -> Sample:
        """Return all components of an infant, or of many."""
        return np.concatenate([read(data, *constants[own]) for read, own in self._reads], -1)


def bind(entry: ProprioceptionEntry, model: mujoco.MjModel, bundle: Bundle) -> Proprioception:
    """Find the joints, sensors and actuators of *entry* in *model*."""
    actuation = bundle.manifest.actuation
    included = [COMPONENTS[name](entry, actuation, model) for name in entry.include]
    return Proprioception([_angles(entry, model), *included])


def _angles(entry: ProprioceptionEntry, model: mujoco.MjModel) -> Component:
    joints = _ids(model, entry.joints)
    addresses = model.jnt_qposadr[joints]
    return Component(
        lambda data: data.qpos.take(addresses, -1),
        addresses,
        np.full(len(addresses), 4 * np.pi),
        _names(entry.joints, "angle", ANGLE_UNIT),
        model.jnt_bodyid[joints],
    )


def _velocities(entry: ProprioceptionEntry, actuation: ActuationEntry, model: mujoco.MjModel) -> Component:
    joints = _ids(model, entry.joints)
    addresses = model.jnt_dofadr[joints]
    return Component(
        lambda data: data.qvel.take(addresses, -1),
        addresses,
        np.full(len(addresses), MAX_SPEED_RAD_S),
        _names(entry.joints, "velocity", VELOCITY_UNIT),
        model.jnt_bodyid[joints],
    )


def _torques(entry: ProprioceptionEntry, actuation: ActuationEntry, model: mujoco.MjModel) -> Component:
    addresses = np.concatenate([model.sensor(name).adr[0] + np.arange(3) for name in entry.torque_sensors])
    sensors = tuple(f"{name}.{axis}" for name in entry.torque_sensors for axis in "xyz")
    return Component(
        lambda data: data.sensordata.take(addresses, -1),
        addresses,
        np.full(len(addresses), MAX_TORQUE_NM),
        _names(sensors, "torque", "N m"),
        np.repeat(model.site_bodyid[[model.sensor(name).objid[0] for name in entry.torque_sensors]], 3),
    )


def _limits(entry: ProprioceptionEntry, actuation: ActuationEntry, model: mujoco.MjModel) -> Component:
    joints = _ids(model, entry.joints)
    addresses = model.jnt_qposadr[joints]
    low, high = model.jnt_range[joints].T
    middle, reach = (low + high) / 2, (high - low) / 2 - LIMIT_MARGIN_RAD

    def read(data: Any, middle: FloatArray, reach: FloatArray) -> FloatArray:
        """Return 0 until the margin, 1 at the limit, above 1 beyond."""
        beyond = np.abs(data.qpos.take(addresses, -1) - middle) - reach
        return np.maximum(beyond, 0.0) / LIMIT_MARGIN_RAD

    return Component(
        read,
        addresses,
        np.full(len(addresses), MAX_LIMIT),
        _names(entry.joints, "limit", "1 at the limit"),
        model.jnt_bodyid[joints],
        (middle, reach),
    )


def _actuation(entry: ProprioceptionEntry, actuation: ActuationEntry, model: mujoco.MjModel) -> Component:
    bound = bind_actuation(all_commanded(actuation), model)
    names = tuple(actuator.name for actuator in actuation.actuators)
    ids = bound.actuators
    gears = model.actuator_gear[ids, 0].copy()
    drive: Any = bound.drive

    def read(data: Any, gears: FloatArray) -> FloatArray:
        """Return what drives each actuator, then the torque that it makes of that."""
        return np.concatenate(
            [getattr(data, drive.name).take(drive.addresses, -1), data.actuator_force.take(ids, -1) * gears], -1
        )

    return Component(
        read,
        ids,
        np.repeat([1.0, MAX_TORQUE_NM], len(ids)),
        _names(names, bound.drive_name, "1") + _names(names, "torque", "N m"),
        np.tile(model.jnt_bodyid[model.actuator_trnid[ids, 0]], 2),
        (gears,),
    )


COMPONENTS: Mapping[str, Callable[[ProprioceptionEntry, ActuationEntry, mujoco.MjModel], Component]] = {
    "velocity": _velocities,
    "torque": _torques,
    "limits": _limits,
    "actuation": _actuation,
}
"""What can be sensed besides angles."""


def _ids(model: mujoco.MjModel, joints: tuple[str, ...]) -> IntArray:
    return np.array([model.joint(name).id for name in joints], np.intp)


def _names(things: tuple[str, ...], quantity: str, unit: str) -> tuple[str, ...]:
    return tuple(f"{thing} {quantity} [{unit}]" for thing in things)
