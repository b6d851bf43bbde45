"""Inverse dynamics: joint torques for several objectives at once, in order of priority."""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.classes import check_class
from mimoc.base.errors import ControlError
from mimoc.bundle.manifest import Manifest
from mimoc.policies.control.actuators import Plant
from mimoc.policies.control.dynamics import (
    HELD,
    ContactConstraints,
    Dynamics,
    JointLimit,
    LinearDemand,
    Motion,
    dynamics,
    find_frame,
    joined,
    size_of,
    solve_within_limits,
)
from mimoc.policies.control.infant import DrivenJoints
from mimoc.policies.control.objectives import Objective, Posture
from mimoc.runtime.sense import FloatArray

BRAKING_PER_S = 20.0  # How fast a joint may approach the end of its range, by the way that is left.
MARGIN_RAD = 0.02  # How far from the end it is to stop.


class _Stops:
    """Accelerations with which n hinges still stop before the ends of their ranges."""

    def __init__(self, joints: DrivenJoints):
        low_rad, high_rad = joints.model.jnt_range[joints.joints].T
        limited = joints.model.jnt_limited[joints.joints] != 0
        margin_rad = np.minimum(MARGIN_RAD, (high_rad - low_rad) / 4)
        self._joints = joints
        self._low_rad = np.where(limited, low_rad + margin_rad, -np.inf)
        self._high_rad = np.where(limited, high_rad - margin_rad, np.inf)

    def accelerations(self, data: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
        """Return the least and the largest of each, shape (n,) each.

        They are those of a critically damped spring, so that a joint that keeps to them never passes its end.
        """
        angles_rad = data.qpos[self._joints.angles]
        braking = -2.0 * BRAKING_PER_S * data.qvel[self._joints.dofs]
        least = BRAKING_PER_S**2 * (self._low_rad - angles_rad) + braking
        return least, BRAKING_PER_S**2 * (self._high_rad - angles_rad) + braking


Objectives = Sequence[Objective | Posture | Sequence[Objective]]
"""Objectives, the most important first; those in a nested sequence share one priority."""


class InverseDynamics:
    """A controller: each call returns the action that its objectives require in the infant's present state.

    An objective never disturbs those before it, and the remaining degrees of freedom follow the posture. Joints stop
    before the ends of their ranges, and torques do not exceed the infant's strength. The controller only reads the
    model and the data: their environment can be reset and set to any state. When the environment has changed its
    scene, it has another model, which must be passed to `bind`.

    Example:
        >>> import mimoc
        >>> env = mimoc.make("nine_months.yaml")
        >>> _ = env.reset(seed=0)
        >>> infant, reach = env.unwrapped, mimoc.PositionTask("right_hand", target=(0.2, -0.1, 0.3))
        >>> control = mimoc.InverseDynamics(infant.model, infant.data, infant.manifest, [reach, mimoc.Posture()])
        >>> observation, reward, *_ = env.step(control())
        >>> len(control.errors())  # That of the hand, [m].
        1
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        manifest: Manifest,
        objectives: Objectives = (),
        joints: Sequence[str] | None = None,
        loose: Sequence[str] = (),
    ):
        """Bind objectives to an infant.

        Args:
            model: The infant and its world, such as `env.unwrapped.model`.
            data: Its state, which each call reads, such as `env.unwrapped.data`.
            manifest: Manifest of its bundle, such as `env.unwrapped.manifest`; it must have motors or muscles.
            objectives: `Reach`, `Align`, `LookAt`, or the `Posture` of some joints, the most important first; those in
                a list or tuple share one priority. A `Posture` of all joints must be last, and is added if missing.
            joints: Joints that are controlled; all others stay at rest. None means all commanded joints. In a world
                with others, they are named as those of an infant that is alone, also in a `Posture`.
            loose: Bodies that may slide on the ground, such as the feet of a sitting infant.

        Raises:
            ControlError: If the infant has servos, or an objective comes after the posture of all joints.
            UnknownNameError: If a site, camera, body or joint does not exist.
            TypeError: If the model is none.
        """
        check_class("InverseDynamics", model, "a model, such as env.unwrapped.model", mujoco.MjModel)
        self._manifest = manifest
        self._levels, self._posture = _in_order(objectives)
        self._chosen = None if joints is None else tuple(dict.fromkeys([joints] if isinstance(joints, str) else joints))
        self._loose = tuple(loose)
        self.bind(model, data)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the controlled joints."""
        return self._joints.names

    def __call__(self) -> npt.NDArray[np.float32]:
        """Return the action for the present state, one command for each actuator of the action."""
        plant = self._plant
        plant.look(self._observed)
        limits_nm = plant.rest()
        if not plant.is_finite:
            return plant.action(np.zeros(len(limits_nm)))
        now = dynamics(plant.model, self._data, self._joints.dofs, self._supports.jacobian(self._data))
        torques_nm = plant.strength_nm * self._shares(now)
        return plant.action(np.clip(torques_nm, limits_nm[:, 0], limits_nm[:, 1]))

    def bind(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Look up all names in a model: at the start, and whenever the environment has changed its scene.

        Raises:
            UnknownNameError: If a site, camera, body or joint does not exist.
        """
        manifest, self._observed = self._manifest, data
        self._plant = Plant(model, manifest, self._chosen)
        self._data, self._joints = self._plant.data, self._plant.joints
        self._stops = _Stops(self._joints)
        self._present_rad = data.qpos[self._joints.angles]
        postures = [level for level in (*self._levels, self._posture) if isinstance(level, Posture)]
        objectives = [item for level in self._levels if not isinstance(level, Posture) for item in level]
        self._frames = {objective: find_frame(objective.site, model, manifest.prefix) for objective in objectives}
        self._members = {posture: posture.members(self.joints) for posture in postures}
        loose = [find_frame(name, model, manifest.prefix).body for name in self._loose]
        self._supports = ContactConstraints(model, manifest, [frame.body for frame in self._frames.values()], loose)

    def errors(self) -> tuple[float, ...]:
        """Return the present error of each objective, [m] or [rad], in order, without postures."""
        self._plant.look(self._observed)
        return tuple(objective.error(self._motion(objective)) for objective in self._frames)

    def _motion(self, objective: Objective) -> Motion:
        return self._frames[objective].motion(self._plant.model, self._data)

    def _shares(self, now: Dynamics) -> FloatArray:
        """Return each joint's torque as a fraction of its strength, shape (n,), before clipping."""
        turning = now.joint_limit(self._plant.strength_nm)
        wanted = self._wanted(now)
        linear_demands = [
            self._hold(level, turning) if isinstance(level, Posture) else joined([wanted[item] for item in level])
            for level in self._levels
        ]
        least, largest = self._stops.accelerations(self._data)
        return solve_within_limits(turning, least, largest, linear_demands, self._hold(self._posture, turning))

    def _hold(self, posture: Posture, turning: JointLimit) -> LinearDemand:
        members = self._members[posture]
        errors_rad = posture.targets_rad(self.joints, self._present_rad) - self._data.qpos[self._joints.angles]
        wanted = posture.gains.accelerations(errors_rad, self._data.qvel[self._joints.dofs])
        return turning.demand(members, wanted[members])

    def _wanted(self, now: Dynamics) -> dict[Objective, LinearDemand]:
        """Return the accelerations that each objective demands, without those whose frame is held by the world."""
        motions = {objective: self._motion(objective) for objective in self._frames}
        demands = {objective: objective.desired_acceleration(motion) for objective, motion in motions.items()}
        if not demands:
            return {}
        jacobians = [demand.directions @ motions[objective].jacobian for objective, demand in demands.items()]
        response, unheld, drift = now.response(np.concatenate(jacobians), self._plant.strength_nm)
        linear_demands, first = {}, 0
        for objective, demand in demands.items():
            rows = slice(first, first := first + len(demand.accelerations))
            wanted = demand.accelerations - demand.directions @ motions[objective].drift - drift[rows]
            is_held = size_of(response[rows]) <= HELD * size_of(unheld[rows])
            linear_demands[objective] = LinearDemand(response[rows] * (not is_held), wanted)
        return linear_demands


def _in_order(objectives: Objectives) -> tuple[list[tuple[Objective, ...] | Posture], Posture]:
    if not isinstance(objectives, Sequence):
        raise ControlError("objectives come as a list, the most important first; write [objective] for one")
    levels: list[Any] = [tuple(level) if isinstance(level, list) else level for level in objectives]
    levels = [level if isinstance(level, (tuple, Posture)) else (level,) for level in levels if level != ()]
    posture = levels.pop() if levels and _is_whole(levels[-1]) else Posture()
    if any(map(_is_whole, levels)):
        raise ControlError("a Posture of all joints leaves nothing free; make it the last objective")
    if any(isinstance(objective, Posture) for level in levels if isinstance(level, tuple) for objective in level):
        raise ControlError("a Posture shares its priority with nothing; take it out of the list that it is in")
    return levels, posture


def _is_whole(level: object) -> bool:
    return isinstance(level, Posture) and level.joints is None
