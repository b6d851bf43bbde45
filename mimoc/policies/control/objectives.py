"""Objectives: targets of parts of the body, and the accelerations towards them."""

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.classes import described
from mimoc.base.errors import ControlError, UnknownNameError
from mimoc.base.geometry.rotations import matrix_from_quaternion
from mimoc.policies.control.dynamics import Motion
from mimoc.runtime.sense import FloatArray


@dataclass(frozen=True, slots=True)
class Gains:
    """Feedback law for an error d and velocity v: strength x (d / scale)^power towards the target, less viscosity x v.

    Errors and scales are in [m] or [rad], as the error of the objective; accelerations are in [m/s²] or [rad/s²].

    Example:
        >>> from mimoc import Gains
        >>> gentle = Gains(strength=200.0, viscosity_per_s=30.0)  # 200 (m/s²)/m, and 30 (m/s²)/(m/s) against motion.
        >>> gentle.power, gentle.cap
        (1.0, inf)
    """

    strength: float
    """Acceleration at an error of one scale, [m/s²] or [rad/s²]."""
    power: float = 1.0
    """1 is a spring; more is gentler near the target."""
    scale: float = 1.0
    """Error at which the acceleration is *strength*, [m] or [rad]."""
    cap: float = math.inf
    """Error at which the acceleration saturates, [m] or [rad]."""
    viscosity_per_s: float = 0.0
    """Deceleration per unit of velocity."""

    def __post_init__(self) -> None:
        for name, least in (("strength", 0.0), ("power", 0.0), ("scale", 1e-9), ("cap", 0.0), ("viscosity_per_s", 0.0)):
            value = getattr(self, name)
            if not value >= least or (value == math.inf and name != "cap"):
                raise ControlError(f"the {name} of gains is {value:g}; give a number of at least {least:g}")

    def acceleration(self, error: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the desired acceleration.

        Args:
            error: Vector from the present value to the target, shape (n,), [m] or [rad].
            velocity: Present velocity, shape (n,).
        """
        distance = math.sqrt(error @ error)
        if distance == 0.0:
            return -self.viscosity_per_s * velocity
        pull = self.strength * (min(distance, self.cap) / self.scale) ** self.power
        return (pull / distance) * error - self.viscosity_per_s * velocity

    def accelerations(self, errors: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the desired accelerations of n independent values, such as joint angles; all of shape (n,)."""
        pulls = self.strength * (np.minimum(np.abs(errors), self.cap) / self.scale) ** self.power
        return np.sign(errors) * pulls - self.viscosity_per_s * velocities


HOLDING = Gains(100.0, cap=0.3, viscosity_per_s=20.0)


class Posture:
    """Moves joints to angles and holds them there, as far as objectives of higher priority allow.

    Example:
        >>> import mimoc
        >>> bent = mimoc.Posture({"robot:right_elbow": -1.2})  # [rad]; all other joints stay where they are.
        >>> bent.angles_rad = {"robot:right_elbow": -0.6}  # At any time.
    """

    def __init__(
        self, angles_rad: Mapping[str, float] | None = None, joints: Sequence[str] | None = None, gains: Gains = HOLDING
    ):
        """Create the posture.

        Args:
            angles_rad: Target angles by joint; other joints keep the angles that they have when control begins.
            joints: Controlled joints, such as those of the trunk while the hands reach; None means all joints, which
                is only possible at the lowest priority.
            gains: Gains for the angle of each joint; with a strength of 0, there is only damping.

        Raises:
            ControlError: If an angle is not finite.
        """
        self.joints = None if joints is None else tuple(joints)
        self.angles_rad, self.gains = angles_rad or {}, gains

    @property
    def angles_rad(self) -> Mapping[str, float]:
        """Target angles by joint; they can be changed at any time."""
        return self._angles_rad

    @angles_rad.setter
    def angles_rad(self, angles_rad: Mapping[str, float]) -> None:
        if not isinstance(angles_rad, Mapping):
            raise ControlError(f"the angles are {described(angles_rad)}; give a dictionary of radians by joint")
        for joint, angle_rad in angles_rad.items():
            if not math.isfinite(angle_rad):
                raise ControlError(f"the angle of '{joint}' is {angle_rad}; give a finite number of radians")
        self._angles_rad = MappingProxyType({joint: float(angle) for joint, angle in angles_rad.items()})

    def members(self, joints: Sequence[str]) -> list[int]:
        """Return the indices of the controlled joints among some joints.

        Raises:
            UnknownNameError: If a controlled joint, or one with a target angle, is not among them.
        """
        for name in (*(self.joints or ()), *self._angles_rad):
            if name not in joints:
                raise UnknownNameError("joint that is allowed to move", name, joints)
        return [index for index, name in enumerate(joints) if self.joints is None or name in self.joints]

    def targets_rad(self, joints: Sequence[str], present_rad: FloatArray) -> FloatArray:
        """Return the target angle of each of n joints, shape (n,).

        Args:
            joints: Their names.
            present_rad: Target angles of joints for which none is given, shape (n,).
        """
        targets_rad = present_rad.copy()
        for name, angle_rad in self._angles_rad.items():
            if name in joints:
                targets_rad[joints.index(name)] = angle_rad
        return targets_rad


_PARALLEL = 1e-9  # Sine of the angle below which two directions do not determine an axis of rotation.


def rotation_vector(axes: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return the rotation vector, shape (3,), [rad], in the world, from axes R to wanted ones R*, columns of (3, 3).

    It is the logarithm of R* Rᵀ, at most half a turn long.
    """
    quaternion, turn = np.empty(4), np.empty(3)
    mujoco.mju_mat2Quat(quaternion, (wanted @ axes.T).ravel())
    mujoco.mju_quat2Vel(turn, quaternion, 1.0)
    return turn


def turn_towards(pointing: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return the shortest rotation vector, shape (3,), [rad], from one direction, a unit vector, to another.

    It is zero if they are equal, and about an arbitrary perpendicular axis if they are opposite.
    """
    across = _cross(pointing, wanted)
    along = float(pointing @ wanted)
    sine = math.sqrt(across @ across)
    if sine > _PARALLEL:
        return math.atan2(sine, along) / sine * across
    return np.zeros(3) if along > 0 else math.pi * directions_across(pointing)[0]


def directions_across(direction: FloatArray) -> FloatArray:
    """Return two unit vectors, shape (2, 3), that are orthogonal to a unit vector and to each other."""
    least = np.zeros(3)
    least[np.abs(direction).argmin()] = 1.0
    across = np.empty((2, 3))
    across[0] = _cross(direction, least)
    across[0] /= math.sqrt(across[0] @ across[0])
    across[1] = _cross(direction, across[0])
    return across


def _cross(left: FloatArray, right: FloatArray) -> FloatArray:
    """Return the cross product, shape (3,); of two single vectors NumPy's takes twenty times as long."""
    product = np.empty(3)
    mujoco.mju_cross(product, left, right)
    return product


REACHING = Gains(800.0, cap=0.1, viscosity_per_s=40.0)
TURNING = Gains(400.0, viscosity_per_s=40.0)
LOOKING = Gains(900.0, viscosity_per_s=60.0)
"""Default gains for gaze: with weaker ones, the dry friction of the eyes leaves errors of several degrees."""

_PLACE, _TURN = np.eye(6)[:3], np.eye(6)[3:]  # The linear and the angular part of a velocity.
_NEAREST_M = 1e-6  # Distance below which a target has no direction.


@dataclass(frozen=True, slots=True)
class TaskAcceleration:
    """Accelerations of its frame that an objective demands."""

    directions: FloatArray  # Directions of the m accelerations in the six linear and angular components, shape (m, 6).
    accelerations: FloatArray  # Accelerations, shape (m,), [m/s²] or [rad/s²].


class Objective(Protocol):
    """A target of a part of the body."""

    site: str  # Name of the controlled site, camera or body.

    def desired_acceleration(self, motion: Motion) -> TaskAcceleration:
        """Return the demanded accelerations."""
        ...

    def error(self, motion: Motion) -> float:
        """Return the error, [m] or [rad]."""
        ...


class FrameTask:
    """An objective with a target position."""

    def __init__(self, site: str, target: npt.ArrayLike, gains: Gains):
        self.site, self.target, self.gains = site, target, gains

    @property
    def target(self) -> FloatArray:
        """Target position in the world, shape (3,), [m]."""
        return self._target_m

    @target.setter
    def target(self, target: npt.ArrayLike) -> None:
        self._target_m = _finite("target", target, (3,))


class PositionTask(FrameTask):
    """Moves a site to a position.

    Example:
        >>> import mimoc
        >>> reach = mimoc.PositionTask("right_hand", target=(0.2, -0.1, 0.3))  # In the world, [m].
        >>> reach.target = (0.2, 0.1, 0.3)  # At any time.
        >>> reach.target.tolist()
        [0.2, 0.1, 0.3]
    """

    def __init__(self, site: str, target: npt.ArrayLike, gains: Gains = REACHING):
        """Create the objective.

        Args:
            site: Name of a site, a camera or a body; a body is controlled at its centre of mass.
            target: Target position in the world, shape (3,), [m]; it can be changed at any time.
            gains: Gains for the distance.

        Raises:
            ControlError: If the target is not three finite numbers.
        """
        super().__init__(site, target, gains)

    def desired_acceleration(self, motion: Motion) -> TaskAcceleration:
        """Return the acceleration of the site."""
        return TaskAcceleration(_PLACE, self.gains.acceleration(self._target_m - motion.place_m, motion.velocity[:3]))

    def error(self, motion: Motion) -> float:
        """Return the distance, [m]."""
        return float(np.linalg.norm(self._target_m - motion.place_m))


class OrientationTask:
    """Turns a site to an orientation, or points it in a direction.

    Example:
        >>> import mimoc
        >>> env = mimoc.make("nine_months.yaml")
        >>> _ = env.reset(seed=0)
        >>> infant, upright = env.unwrapped, [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> objectives = [mimoc.OrientationTask("chest", upright), mimoc.Posture()]
        >>> control = mimoc.InverseDynamics(infant.model, infant.data, infant.manifest, objectives)
        >>> control().shape
        (44,)
    """

    def __init__(
        self, site: str, orientation: npt.ArrayLike, axis: npt.ArrayLike | None = None, gains: Gains = TURNING
    ):
        """Create the objective.

        Args:
            site: Name of a site, a camera or a body.
            orientation: Target orientation of its frame in the world, as a quaternion (w, x, y, z) or a matrix with
                its axes as columns, or a target direction of one axis, shape (3,); it can be changed at any time.
            axis: Axis of its frame that is to point in the direction, shape (3,); by default the viewing direction of a
                camera, and x otherwise.
            gains: Gains for the angle.

        Raises:
            ControlError: If these are not finite, have the wrong shape, or are zero.
        """
        self.site, self.gains = site, gains
        self.axis = None if axis is None else _unit("axis", axis)
        self.orientation = orientation

    @property
    def orientation(self) -> FloatArray:
        """Target orientation, with the axes as columns, shape (3, 3), or target direction, shape (3,)."""
        return self._orientation

    @orientation.setter
    def orientation(self, orientation: npt.ArrayLike) -> None:
        if np.shape(orientation) == (3,):
            self._orientation = _unit("direction", orientation)
        elif np.shape(orientation) == (4,):
            self._orientation = matrix_from_quaternion(_unit("quaternion", orientation).tolist())
        else:
            matrix = _finite("orientation", orientation, (3, 3))
            if not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-6) or np.linalg.det(matrix) < 0:
                advice = "its columns must be orthogonal unit vectors"
                raise ControlError(f"the orientation is not a rotation matrix; {advice}")
            self._orientation = matrix

    def desired_acceleration(self, motion: Motion) -> TaskAcceleration:
        """Return the demanded angular acceleration; rotation about a target direction is left free."""
        if self._orientation.ndim == 1:
            return _demand_pointing(motion, self.axis, self._orientation, self.gains)
        turn = rotation_vector(motion.axes, self._orientation)
        return TaskAcceleration(_TURN, self.gains.acceleration(turn, motion.velocity[3:]))

    def error(self, motion: Motion) -> float:
        """Return the angle, [rad]."""
        if self._orientation.ndim == 1:
            return float(np.linalg.norm(turn_towards(_pointing(motion, self.axis), self._orientation)))
        return float(np.linalg.norm(rotation_vector(motion.axes, self._orientation)))


class GazeTask(FrameTask):
    """Points a site or a camera, such as an eye, at a position.

    Example:
        >>> import mimoc
        >>> eyes = [mimoc.GazeTask(eye, target=(0.5, 0.0, 0.3)) for eye in ("eye_left", "eye_right")]
        >>> env = mimoc.make("nine_months.yaml")
        >>> _ = env.reset(seed=0)
        >>> infant = env.unwrapped
        >>> control = mimoc.InverseDynamics(infant.model, infant.data, infant.manifest, [eyes, mimoc.Posture()])
        >>> observation, *_ = env.step(control())
    """

    def __init__(self, site: str, target: npt.ArrayLike, axis: npt.ArrayLike | None = None, gains: Gains = LOOKING):
        """Create the objective.

        Args:
            site: Name of a camera (`eye_left`), a site or a body.
            target: Target position in the world, shape (3,), [m]; it can be changed at any time.
            axis: Axis of its frame that is to point at the target, shape (3,); by default the viewing direction of a
                camera, and x otherwise.
            gains: Gains for the angle.

        Raises:
            ControlError: If these are not three finite numbers, or the axis is zero.
        """
        super().__init__(site, target, gains)
        self.axis = None if axis is None else _unit("axis", axis)

    def desired_acceleration(self, motion: Motion) -> TaskAcceleration:
        """Return the demanded angular acceleration; rotation about the pointing axis is left free."""
        return _demand_pointing(motion, self.axis, self._wanted(motion), self.gains)

    def error(self, motion: Motion) -> float:
        """Return the misalignment, [rad]."""
        return float(np.linalg.norm(turn_towards(_pointing(motion, self.axis), self._wanted(motion))))

    def _wanted(self, motion: Motion) -> FloatArray:
        away_m = self._target_m - motion.place_m
        distance_m = float(np.linalg.norm(away_m))
        return away_m / distance_m if distance_m > _NEAREST_M else _pointing(motion, self.axis)


def _pointing(motion: Motion, axis: FloatArray | None) -> FloatArray:
    return motion.axes @ (motion.pointing if axis is None else axis)


def _demand_pointing(motion: Motion, axis: FloatArray | None, wanted: FloatArray, gains: Gains) -> TaskAcceleration:
    pointing = _pointing(motion, axis)
    across = directions_across(pointing)
    turn = turn_towards(pointing, wanted)
    return TaskAcceleration(across @ _TURN, gains.acceleration(across @ turn, across @ motion.velocity[3:]))


def _finite(what: str, numbers: npt.ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    try:
        array = np.array(numbers, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != shape or not np.isfinite(array).all():
        wanted = " x ".join(map(str, shape))
        shown = textwrap.shorten(str(numbers), 60, placeholder="...")
        raise ControlError(f"the {what} is {shown}; give {wanted} finite numbers")
    array.flags.writeable = False
    return array


def _unit(what: str, numbers: npt.ArrayLike) -> FloatArray:
    vector = _finite(what, numbers, np.shape(numbers) if np.shape(numbers) == (4,) else (3,))
    length = float(np.linalg.norm(vector))
    if length == 0.0:
        raise ControlError(f"the {what} has length zero; give a vector of any other length")
    return vector / length
