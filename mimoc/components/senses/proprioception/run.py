"""Proprioception: the angles and velocities of the joints, their torques and limits, and the state of the actuators."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.components.senses.proprioception import ProprioceptionEntry
from mimoc.runtime.actuation import all_commanded, bind_actuation
from mimoc.runtime.custom_sense import TermSense
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.runtime.term import Concatenated, Field, Term
from mimoc.runtime.worlds import Worlds
from mimoc.schema.actuation import ActuationEntry

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
    available = _components(entry, bundle.manifest.actuation, model)
    components = [component for name in ("angle", *entry.include) for component in available[name]]
    high = np.repeat([component.high for component in components], [len(part.layout) for part in components])
    return TermSense(
        "proprioception",
        Concatenated(tuple(component.term for component in components)),
        [name for component in components for name in component.layout],
        -high,
        high,
        np.concatenate([component.bodies for component in components]),
    )


def _components(
    entry: ProprioceptionEntry, actuation: ActuationEntry, model: mujoco.MjModel
) -> dict[str, list[Component]]:
    """Return what can be sensed, by the name with which it is included; angles always are."""
    joints = np.array([model.joint(name).id for name in entry.joints], np.intp)
    angles, velocities = model.jnt_qposadr[joints].astype(np.intp), model.jnt_dofadr[joints].astype(np.intp)
    low, high = model.jnt_range[joints].T
    limits = Limits(angles, (low + high) / 2, (high - low) / 2 - LIMIT_MARGIN_RAD)
    sensors = np.array([model.sensor(name).id for name in entry.torque_sensors], np.intp)
    axes = [f"{name}.{axis}" for name in entry.torque_sensors for axis in "xyz"]
    loads = Field("sensordata", (model.sensor_adr[sensors][:, None] + np.arange(3)).ravel())
    bound = bind_actuation(all_commanded(actuation), model)
    actuators = [actuator.name for actuator in actuation.actuators]
    torques = ActuatorTorques(bound.actuators, model.actuator_gear[bound.actuators, 0])

    def component(term: Term, high: float, names: Sequence[str], quantity: str, unit: str, bodies: Any) -> Component:
        return Component(term, high, tuple(f"{name} {quantity} [{unit}]" for name in names), bodies)

    of_joints, on_sites = model.jnt_bodyid[joints], np.repeat(model.site_bodyid[model.sensor_objid[sensors]], 3)
    driven = model.jnt_bodyid[model.actuator_trnid[bound.actuators, 0]]
    return {
        "angle": [component(Field("qpos", angles), 4 * np.pi, entry.joints, "angle", ANGLE_UNIT, of_joints)],
        "velocity": [
            component(Field("qvel", velocities), MAX_SPEED_RAD_S, entry.joints, "velocity", VELOCITY_UNIT, of_joints)
        ],
        "torque": [component(loads, MAX_TORQUE_NM, axes, "torque", "N m", on_sites)],
        "limits": [component(limits, MAX_LIMIT, entry.joints, "limit", "1 at the limit", of_joints)],
        "actuation": [
            component(bound.drive, 1.0, actuators, bound.drive_name, "1", driven),
            component(torques, MAX_TORQUE_NM, actuators, "torque", "N m", driven),
        ],
    }
