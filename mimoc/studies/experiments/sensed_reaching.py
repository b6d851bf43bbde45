"""Reaching with a controller that has only late and noisy proprioception."""

import copy
import math
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.mujoco_layout import TIME_CONSTANT
from mimoc.base.units import ms_to_s
from mimoc.motion.hand_movement import UNIT_M_S, Movement
from mimoc.policies.reach import GAIN_SETS, ReachController
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray, Observation

GAINS = "low"
"""Key of the gains of the hand, the same for all ages and delays: those that an infant that sits freely has anyway.
They let the hand move at half a metre per second at most, which is the choice of a speed."""
TOUCHED_M = 0.025
"""Distance of the palm's centre from the target at which a reach has arrived: the radius of a small ball."""
REACH_SHARE = 0.8  # Distance of a target from the shoulder, by the length of the arm.
INWARDS_DEG, UPWARDS_DEG = (-20.0, 40.0), (-20.0, 20.0)
"""Directions of the targets from the shoulder, by the chest: straight ahead is 0."""
AT_ONCE_S = 1e-6
"""Time constant of actuators in the controller's model of the body, which does not know that they are slow."""


@dataclass(frozen=True, slots=True)
class Reach(Movement):
    """A reach from its onset until it arrives or is given up."""

    arrived: bool
    distance_m: float  # From the hand to the target at the beginning.
    target_m: FloatArray  # The target, shape (3,), world frame.

    @property
    def away_m(self) -> FloatArray:
        """Distance of the hand from the target at regular intervals, shape (n,)."""
        return np.linalg.norm(self.path_m - self.target_m, axis=1)


class SensedController:
    """The controller of reaches, on a model of the body whose joints are at the angles and speeds that are sensed.

    It does not predict: it acts as if what arrives were the present, and as if actuators followed commands at once.
    """

    def __init__(self, env: InfantEnv, gains: str = GAINS):
        """Make a model of the body of an infant whose proprioception includes velocities, in its present pose."""
        model = copy.copy(env.model)
        slow = model.actuator_dyntype != mujoco.mjtDyn.mjDYN_NONE
        model.actuator_dynprm[slow, TIME_CONSTANT] = AT_ONCE_S
        self._felt = mujoco.MjData(model)
        self._felt.qpos[:] = env.data.qpos
        joints = [model.joint(name) for name in env.manifest.senses.proprioception.joints]
        self._angles = np.array([joint.qposadr[0] for joint in joints])
        self._speeds = np.array([joint.dofadr[0] for joint in joints])
        self._reach = ReachController(model, self._felt, env.manifest, GAIN_SETS[gains])
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


def place_in_front(env: InfantEnv, generator: np.random.Generator, share: float = REACH_SHARE) -> FloatArray:
    """Return a random place in front of the right shoulder, a *share* of the arm's length away, shape (3,), [m]."""
    shoulder_m = env.data.body("right_upper_arm").xpos
    elbow_m = env.data.body("right_lower_arm").xpos
    palm_m = env.data.body("right_hand").xipos
    arm_m = math.dist(shoulder_m, elbow_m) + math.dist(elbow_m, palm_m)
    inwards, upwards = (np.radians(generator.uniform(*ends_deg)) for ends_deg in (INWARDS_DEG, UPWARDS_DEG))
    ahead = env.data.body("chest").xmat.reshape(3, 3) @ (
        np.cos(inwards) * np.cos(upwards),
        np.sin(inwards) * np.cos(upwards),
        np.sin(upwards),
    )
    return shoulder_m + share * arm_m * ahead


def reach_once(
    env: InfantEnv,
    seed: int,
    generator: np.random.Generator,
    most_s: float,
    gains: str = GAINS,
    share: float = REACH_SHARE,
) -> Reach:
    """Let an infant, which is reset, reach once for a random target, and return its movement.

    It is given up after *most_s* of simulated time; the target is a *share* of the arm's length from the shoulder.
    """
    observation, _ = env.reset(seed=seed)
    control = SensedController(env, gains)
    step_s = ms_to_s(env.manifest.step_ms)
    hand = env.data.body(control.hand)
    target_m = place_in_front(env, generator, share)
    path_m = [hand.xipos.copy()]
    control.aim(target_m)
    while (remaining_m := math.dist(path_m[-1], target_m)) > TOUCHED_M and len(path_m) * step_s <= most_s:
        observation, *_ = env.step(control(observation))
        path_m.append(hand.xipos.copy())
    speeds = np.linalg.norm(np.diff(path_m, axis=0), axis=1) / step_s
    onset = int(np.argmax(speeds > UNIT_M_S))
    return Reach(np.array(path_m)[onset:], step_s, remaining_m <= TOUCHED_M, math.dist(path_m[0], target_m), target_m)
