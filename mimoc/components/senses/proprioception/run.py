"""Proprioception: the angles and velocities of the joints, their torques and limits, and the state of the actuators."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.components.senses.proprioception import ProprioceptionEntry
from mimoc.runtime.actuation import all_commanded, bind_actuation
from mimoc.runtime.noise import Draw, Noise, Smooth
from mimoc.runtime.sense import FloatArray, IntArray, Sense, TermSense
from mimoc.runtime.term import Concatenated, Field, Term
from mimoc.runtime.worlds import Worlds
from mimoc.schema.actuation import ActuationEntry

LIMIT_MARGIN_RAD = 0.035  # Distance from its limit at which a joint begins to sense it (MIMo v2).

MAX_SPEED_RAD_S = 1e3
MAX_TORQUE_NM = 1e3
MAX_LIMIT = 1e2  # Bounds of the observation at every age, far beyond what a stable simulation reaches.
ANGLE_UNIT, VELOCITY_UNIT = "rad", "rad/s"  # By which angles and velocities are known in the layout.


@dataclass(frozen=True)
class Limits(Term):
    """How far each joint is in the margin before a limit: 0 until there, 1 at the limit, above 1 beyond, shape (k, n).

    With the angle q, the middle m of the joint's range and the reach r from there to a margin: max(|q - m| - r, 0) in
    margins.
    """

    addresses: IntArray  # Of the joints in `qpos`, shape (n,).
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
    high: float  # Largest value; the least is its negative.
    layout: tuple[str, ...]
    bodies: IntArray  # The body in which each number is measured, shape (n,).


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


@dataclass(frozen=True)
class ProprioceptionNoise(Noise):
    """Adds a smooth error to each angle, and the error's rate to each velocity; torques and limits are exact."""

    deviation_rad: FloatArray  # Standard deviation of an angle, shape (1,).
    errors: IntArray
    """Of each number of a sample, the place of its error among those of n angles, then those of their velocities."""
    per: FloatArray
    """By what the error there is divided: 1 of angles, the time constant of velocities, and infinity of all else."""
    count: int  # Number of angles, n.
    low_pass: Smooth

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, size), and its errors, shape (k, 2 n); see `Smooth`."""
        drawn = draw.normals((sample.shape[0], 2 * self.count))
        state = self.low_pass(draw.xp, state, draw.elapsed_s, drawn)
        return sample + self.deviation_rad * (draw.xp.take(state, self.errors, axis=1) / self.per), state


def bind_noise(amount_deg: float, sense: Sense, low_pass_s: float) -> ProprioceptionNoise:
    """Return the noise of a sense of proprioception; its velocities are in the order of its angles, if it has any."""
    angles, velocities = (
        np.flatnonzero([name.endswith(f"[{unit}]") for name in sense.layout]) for unit in (ANGLE_UNIT, VELOCITY_UNIT)
    )
    errors, per = np.zeros(len(sense.layout), np.intp), np.full(len(sense.layout), np.inf)
    errors[angles], per[angles] = np.arange(len(angles)), 1.0
    errors[velocities], per[velocities] = len(angles) + np.arange(len(velocities)), low_pass_s
    return ProprioceptionNoise(np.array([math.radians(amount_deg)]), errors, per, len(angles), Smooth(low_pass_s))
