"""Proprioception: the angles and velocities of the joints, their torques and limits, and the state of the actuators."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
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

# These three bound the observation at every age; they are far beyond what a stable simulation reaches.
MAX_SPEED_RAD_S = 1e3
MAX_TORQUE_NM = 1e3
MAX_LIMIT = 1e2

ANGLE_UNIT, VELOCITY_UNIT = "rad", "rad/s"  # Angles and velocities are known by them in the layout.


@dataclass(frozen=True)
class Limits(Term):
    """How far each joint is in the margin before a limit: 0 until there, 1 at the limit, above 1 beyond, shape (k, n).

    With the angle q, the middle m of the joint's range and the reach r from there to a margin: max(|q - m| - r, 0) in
    margins.
    """

    addresses: IntArray  # Addresses of the joints in `qpos`, shape (n,).
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
    angles = model.jnt_qposadr[joints].astype(np.intp)
    velocities = model.jnt_dofadr[joints].astype(np.intp)
    low, high = model.jnt_range[joints].T
    limits = Limits(angles, (low + high) / 2, (high - low) / 2 - LIMIT_MARGIN_RAD)
    sensors = np.array([model.sensor(name).id for name in entry.torque_sensors], np.intp)
    axes = [f"{name}.{axis}" for name in entry.torque_sensors for axis in "xyz"]
    loads = Field("sensordata", (model.sensor_adr[sensors][:, None] + np.arange(3)).ravel())
    bound = bind_actuation(all_commanded(actuation), model)
    actuators = [actuator.name for actuator in actuation.actuators]
    torques = ActuatorTorques(bound.actuators, model.actuator_gear[bound.actuators, 0])
    bodies_of_sensors = model.site_bodyid[model.sensor_objid[sensors]]
    joints_of_actuators = model.actuator_trnid[bound.actuators, 0]
    of_joints = partial(_component, names=entry.joints, bodies=model.jnt_bodyid[joints])
    of_axes = partial(_component, names=axes, bodies=np.repeat(bodies_of_sensors, 3))
    of_actuators = partial(_component, names=actuators, bodies=model.jnt_bodyid[joints_of_actuators])
    return {
        "angle": [of_joints(Field("qpos", angles), 4 * np.pi, f"angle [{ANGLE_UNIT}]")],
        "velocity": [of_joints(Field("qvel", velocities), MAX_SPEED_RAD_S, f"velocity [{VELOCITY_UNIT}]")],
        "torque": [of_axes(loads, MAX_TORQUE_NM, "torque [N m]")],
        "limits": [of_joints(limits, MAX_LIMIT, "limit [1 at the limit]")],
        "actuation": [
            of_actuators(bound.drive, 1.0, f"{bound.drive_name} [1]"),
            of_actuators(torques, MAX_TORQUE_NM, "torque [N m]"),
        ],
    }


def _component(term: Term, high: float, quantity: str, names: Sequence[str], bodies: Any) -> Component:
    return Component(term, high, tuple(f"{name} {quantity}" for name in names), bodies)


@dataclass(frozen=True)
class ProprioceptionNoise(Noise):
    """Adds a smooth error to each angle, and the error's rate to each velocity; torques and limits are exact."""

    deviation_rad: FloatArray  # Standard deviation of an angle, shape (1,).
    error_indices: IntArray
    """For each number of a sample, the index of its error in the state: of n angles first, then of n velocities."""
    divisors: FloatArray
    """Each number's error is divided by this: 1 for angles, the time constant for velocities, infinity for others."""
    count: int  # Number of angles, n.
    low_pass: Smooth

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, size), and its errors, shape (k, 2 n); see `Smooth`."""
        drawn = draw.normals((sample.shape[0], 2 * self.count))
        state = self.low_pass(draw.xp, state, draw.elapsed_s, drawn)
        errors = draw.xp.take(state, self.error_indices, axis=1) / self.divisors
        return sample + self.deviation_rad * errors, state


def bind_noise(amount_deg: float, sense: Sense, low_pass_s: float) -> ProprioceptionNoise:
    """Return the noise of a sense of proprioception; its velocities are in the order of its angles, if it has any."""
    angles, velocities = (
        np.flatnonzero([name.endswith(f"[{unit}]") for name in sense.layout]) for unit in (ANGLE_UNIT, VELOCITY_UNIT)
    )
    error_indices = np.zeros(len(sense.layout), np.intp)
    error_indices[angles] = np.arange(len(angles))
    error_indices[velocities] = len(angles) + np.arange(len(velocities))
    divisors = np.full(len(sense.layout), np.inf)
    divisors[angles] = 1.0
    divisors[velocities] = low_pass_s
    return ProprioceptionNoise(
        np.array([math.radians(amount_deg)]), error_indices, divisors, len(angles), Smooth(low_pass_s)
    )
