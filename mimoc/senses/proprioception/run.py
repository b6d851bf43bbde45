"""Proprioception: the angles and velocities of the joints, their torques and limits, and the state of the actuators."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import mujoco
import numpy as np

from mimoc.actuation.binding import all_commanded, bind_actuation
from mimoc.actuation.spec import ActuationEntry
from mimoc.bundle.io import Bundle
from mimoc.runtime.term import Concatenated, Field, Term
from mimoc.runtime.worlds import Worlds
from mimoc.senses.custom import TermSense
from mimoc.senses.proprioception import ProprioceptionEntry
from mimoc.senses.sense import FloatArray, IntArray

LIMIT_MARGIN_RAD = 0.035
"""Distance from its limit at which a joint begins to sense it (MIMo v2)."""

MAX_SPEED_RAD_S = 1e3
MAX_TORQUE_NM = 1e3
MAX_LIMIT = 1e2
"""Bounds of the observation at every age, far beyond what a stable simulation reaches."""
ANGLE_UNIT, VELOCITY_UNIT = "rad", "rad/s"
"""By which angles and velocities are known in the layout."""


@dataclass(frozen=True)
class Limits(Term):
    """How far each joint is in the margin before a limit: 0 until there, 1 at the limit, above 1 beyond, shape (k, n).

    With the angle q, the middle m of the joint's range and the reach r from there to a margin: max(|q - m| - r, 0) in
    margins.
    """

    addresses: IntArray
    """Of the joints in `qpos`, shape (n,)."""
    middle_rad: FloatArray
    reach_rad: FloatArray

    def __call__(self, worlds: Worlds) -> Any:
        """Return the proximity of the limits now."""
        xp = worlds.xp
        beyond = xp.abs(xp.take(worlds.qpos, self.addresses, axis=1) - self.middle_rad) - self.reach_rad
        return xp.maximum(beyond, 0.0) / LIMIT_MARGIN_RAD


@dataclass(frozen=True)
class ActuatorTorques(Term):
    """The torque of each actuator about its joint, shape (k, n), in [N m]."""

    actuators: IntArray
    gears: FloatArray

    def __call__(self, worlds: Worlds) -> Any:
        """Return the torques of the last physics step."""
        return worlds.xp.take(worlds.actuator_force, self.actuators, axis=1) * self.gears


class Component(NamedTuple):
    """One of the quantities that are sensed, for each of n joints, sensor axes or actuators."""

    term: Term
    high: float
    """Largest value; the least is its negative."""
    layout: tuple[str, ...]
    bodies: IntArray
    """The body in which each number is measured, shape (n,)."""


def bind(entry: ProprioceptionEntry, model: mujoco.MjModel, bundle: Bundle) -> TermSense:
    """Find the joints, sensors and actuators of *entry* in *model*."""
    included = [COMPONENTS[name](entry, bundle.manifest.actuation, model) for name in entry.include]
    components = [_angles(entry, model), *(component for components in included for component in components)]
    high = np.repeat([component.high for component in components], [len(part.layout) for part in components])
    return TermSense(
        "proprioception",
        Concatenated(tuple(component.term for component in components)),
        [name for component in components for name in component.layout],
        -high,
        high,
        np.concatenate([component.bodies for component in components]),
    )


def _angles(entry: ProprioceptionEntry, model: mujoco.MjModel) -> Component:
    joints = _ids(model, entry.joints)
    term = Field("qpos", model.jnt_qposadr[joints].astype(np.intp))
    return Component(term, 4 * np.pi, _names(entry.joints, "angle", ANGLE_UNIT), model.jnt_bodyid[joints])


def _velocities(entry: ProprioceptionEntry, actuation: ActuationEntry, model: mujoco.MjModel) -> list[Component]:
    joints = _ids(model, entry.joints)
    term = Field("qvel", model.jnt_dofadr[joints].astype(np.intp))
    layout = _names(entry.joints, "velocity", VELOCITY_UNIT)
    return [Component(term, MAX_SPEED_RAD_S, layout, model.jnt_bodyid[joints])]


def _torques(entry: ProprioceptionEntry, actuation: ActuationEntry, model: mujoco.MjModel) -> list[Component]:
    sensors = [model.sensor(name) for name in entry.torque_sensors]
    addresses = np.concatenate([sensor.adr[0] + np.arange(3) for sensor in sensors])
    axes = tuple(f"{name}.{axis}" for name in entry.torque_sensors for axis in "xyz")
    bodies = np.repeat(model.site_bodyid[[sensor.objid[0] for sensor in sensors]], 3)
    return [Component(Field("sensordata", addresses), MAX_TORQUE_NM, _names(axes, "torque", "N m"), bodies)]


def _limits(entry: ProprioceptionEntry, actuation: ActuationEntry, model: mujoco.MjModel) -> list[Component]:
    joints = _ids(model, entry.joints)
    low, high = model.jnt_range[joints].T
    reach_rad = (high - low) / 2 - LIMIT_MARGIN_RAD
    term = Limits(model.jnt_qposadr[joints].astype(np.intp), (low + high) / 2, reach_rad)
    return [Component(term, MAX_LIMIT, _names(entry.joints, "limit", "1 at the limit"), model.jnt_bodyid[joints])]


def _actuation(entry: ProprioceptionEntry, actuation: ActuationEntry, model: mujoco.MjModel) -> list[Component]:
    """Return what drives each actuator, and the torque that it makes of that."""
    bound = bind_actuation(all_commanded(actuation), model)
    names = tuple(actuator.name for actuator in actuation.actuators)
    bodies = model.jnt_bodyid[model.actuator_trnid[bound.actuators, 0]]
    torques = ActuatorTorques(bound.actuators, model.actuator_gear[bound.actuators, 0])
    return [
        Component(bound.drive, 1.0, _names(names, bound.drive_name, "1"), bodies),
        Component(torques, MAX_TORQUE_NM, _names(names, "torque", "N m"), bodies),
    ]


COMPONENTS: Mapping[str, Callable[[ProprioceptionEntry, ActuationEntry, mujoco.MjModel], list[Component]]] = {
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
