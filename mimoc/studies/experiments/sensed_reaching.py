"""Reaching with a controller that knows the body only by late and noisy proprioception."""

import copy
import math
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.control import GAIN_SETS
from mimoc.control.reaching import ReachController
from mimoc.mujoco_layout import TIME_CONSTANT
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import FloatArray, Observation
from mimoc.studies.experiments.smoothness import (
    UNIT_M_S,
    log_dimensionless_jerk,
    movement_units,
    path_ratio,
    spectral_arc_length,
)
from mimoc.units import ms_to_s

GAINS = GAIN_SETS["low"]
"""Gains of the hand, the same for all ages and delays: those that an infant that sits freely has anyway. They let the
hand move at half a metre per second at most, which is the choice of a speed."""
TOUCHED_M = 0.025
"""Distance of the palm's centre from the target at which a reach has arrived: the radius of a small ball."""
REACH_SHARE = 0.8
"""Distance of a target from the shoulder, by the length of the arm."""
INWARDS_DEG, UPWARDS_DEG = (-20.0, 40.0), (-20.0, 20.0)
"""Directions of the targets from the shoulder, by the chest: straight ahead is 0."""
AT_ONCE_S = 1e-6
"""Time constant of actuators in the controller's model of the body, which does not know that they are slow."""


@dataclass(frozen=True, slots=True)
class Reach:
    """A reach from its onset until it arrives or is given up."""

    arrived: bool
    step_s: float
    """Control step."""
    distance_m: float
    """From the hand to the target at the beginning."""
    path_m: FloatArray
    """Positions of the hand, shape (n, 3), world frame."""

    @property
    def duration_s(self) -> float:
        """Time from onset to the end."""
        return (len(self.path_m) - 1) * self.step_s

    @property
    def speed_m_s(self) -> FloatArray:
        """Speed of the hand in each control step, shape (n - 1,)."""
        return np.linalg.norm(np.diff(self.path_m, axis=0), axis=1) / self.step_s

    @property
    def units(self) -> int:
        """Number of movement units."""
        return movement_units(self.path_m, self.step_s)

    @property
    def path_ratio(self) -> float:
        """Length of the path by the straight distance."""
        return path_ratio(self.path_m)

    @property
    def jerk(self) -> float:
        """Log dimensionless jerk; higher is smoother."""
        return log_dimensionless_jerk(self.path_m, self.step_s)

    @property
    def arc_length(self) -> float:
        """Spectral arc length; higher is smoother."""
        return spectral_arc_length(self.path_m, self.step_s)


class SensedController:
    """The controller of reaches, on a model of the body whose joints are at the angles and speeds that are sensed.

    It does not predict: it acts as if what arrives were the present, and as if actuators followed commands at once.
    """

    def __init__(self, env: InfantEnv):
        """Make a model of the body of an infant whose proprioception includes velocities, in its present pose."""
        model = copy.copy(env.model)
        slow = model.actuator_dyntype != mujoco.mjtDyn.mjDYN_NONE
        model.actuator_dynprm[slow, TIME_CONSTANT] = AT_ONCE_S
        self._felt = mujoco.MjData(model)
        self._felt.qpos[:] = env.data.qpos
        joints = [model.joint(name) for name in env.manifest.senses.proprioception.joints]
        self._angles = np.array([joint.qposadr[0] for joint in joints])
        self._speeds = np.array([joint.dofadr[0] for joint in joints])
        self._reach = ReachController(model, self._felt, env.manifest, GAINS)
        self.hand = self._reach.hands[0]
        """Body of the hand that reaches."""

    def aim(self, target_m: FloatArray) -> None:
        """Set the target of the hand, shape (3,), [m]."""
        self._reach.aim([target_m])

    def __call__(self, observation: Observation) -> npt.NDArray[np.float32]:
        """Return the action for what is observed."""
        sensed = observation["proprioception"]
        count = len(self._angles)
        self._felt.qpos[self._angles], self._felt.qvel[self._speeds] = sensed[:count], sensed[count : 2 * count]
        return self._reach()


def place_in_front(env: InfantEnv, generator: np.random.Generator) -> FloatArray:
    """Return a random place in front of the right shoulder, as toys are shown to infants, shape (3,), [m].

    It is `REACH_SHARE` of the arm's length away: the same places, by the size of the arm, at all ages.
    """
    shoulder_m, elbow_m, palm_m = (
        env.data.body("right_upper_arm").xpos,
        env.data.body("right_lower_arm").xpos,
        env.data.body("right_hand").xipos,
    )
    arm_m = math.dist(shoulder_m, elbow_m) + math.dist(elbow_m, palm_m)
    inwards, upwards = (np.radians(generator.uniform(*ends_deg)) for ends_deg in (INWARDS_DEG, UPWARDS_DEG))
    ahead = env.data.body("chest").xmat.reshape(3, 3) @ (
        np.cos(inwards) * np.cos(upwards),
        np.sin(inwards) * np.cos(upwards),
        np.sin(upwards),
    )
    return shoulder_m + REACH_SHARE * arm_m * ahead


def reach_once(env: InfantEnv, seed: int, generator: np.random.Generator, most_s: float) -> Reach:
    """Let an infant reach once for a random target, and return its movement.

    Args:
        env: The infant, which is reset.
        seed: Seed of its noise.
        generator: Source of the target.
        most_s: Simulated time after which the reach is given up.
    """
    observation, _ = env.reset(seed=seed)
    control, step_s = SensedController(env), ms_to_s(env.manifest.step_ms)
    hand = env.data.body(control.hand)
    target_m, path_m = place_in_front(env, generator), [hand.xipos.copy()]
    control.aim(target_m)
    while (remaining_m := math.dist(path_m[-1], target_m)) > TOUCHED_M and len(path_m) * step_s <= most_s:
        observation, *_ = env.step(control(observation))
        path_m.append(hand.xipos.copy())
    speeds = np.linalg.norm(np.diff(path_m, axis=0), axis=1) / step_s
    onset = int(np.argmax(speeds > UNIT_M_S))
    return Reach(remaining_m <= TOUCHED_M, step_s, math.dist(path_m[0], target_m), np.array(path_m)[onset:])
