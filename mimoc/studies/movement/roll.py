"""Rolling from the back to the belly, by a sequence of postures that a search makes up for each infant.

The search is the cross-entropy method: sequences are drawn around a mean, the best of them move it and narrow what is
drawn next, until one rolls the infant or the draws are used up. What no draw does may still be possible.
"""

from dataclasses import dataclass, field

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.policies.control.postures import elevation_deg
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.studies.milestones.trial import TrialInfant
from mimoc.studies.movement.trial import Drive, MovementTrial, Subject, Values, again, settled

POSTURES, POSTURE_S, MOVING_S = 3, 1.0, 0.4
"""How many postures follow one another, how long each is asked for, and how long the target takes to get to it."""
ROLLING_S = 4.0  # The last posture is kept for one second more.
EVERY_S = 0.02  # How often a command is sent.
STIFFNESS, DAMPING_S = 4.0, 0.06
"""Shares of strength asked for each radian that a joint is off its target, and for each rad/s less by this time."""
EXCEPT = ("_eye_", "_hand", "_finger", "_foot", "_toes", "_th", "_ff", "_mf", "_rf", "_lf")
"""Joints with these in their names, of eyes, hands and feet, are left quiet."""
ROLLED_DEG = 60.0  # How far chest and hips face down at the end on the belly; 0 is on the side.
DRAWS, KEPT, ROUNDS = 40, 8, 60
SPREAD, MIN_SPREAD, SMOOTHING = 0.6, 0.1, 0.7
"""Spread of draws in half ranges of a joint, at first and at least, and how far the kept ones move mean and spread."""
SEEDS = 3  # Searches, one after the other, until one rolls the infant: what one misses, another may hit on.


@dataclass
class Roller:
    """Plays sequences of postures with an infant that lies on its back."""

    infant: TrialInfant
    start: mujoco.MjData = field(init=False)
    moved: IntArray = field(init=False)  # Indices of the driven hinges that move, shape (m,).

    def __post_init__(self) -> None:
        self.start = settled(self.infant)
        names = self.infant.joint_names
        moved = [slot for slot, name in enumerate(names) if not any(part in f"_{name}" for part in EXCEPT)]
        self.moved = np.array(moved, np.intp)
        self._low, self._high = self.infant.model.jnt_range[self.infant.joints[self.moved]].T

    def play(self, sequence: FloatArray) -> float:
        """Return how far chest and hips face down at the end, in [deg], the lesser: -90 on the back, 90 on the belly.

        Angles are from -1 to 1 for the ends of their ranges, shape (postures * joints,).
        """
        infant, model = self.infant, self.infant.model
        data = again(infant, self.start, moving=False)
        drive = Drive(infant)
        angles, dofs = infant.angles[self.moved], infant.dofs[self.moved]
        middle = (self._low + self._high) / 2
        half = (self._high - self._low) / 2
        postures = [data.qpos[angles].copy(), *(middle + half * sequence.reshape(POSTURES, -1))]
        shares = np.zeros(len(infant.joints))
        every = round(EVERY_S / model.opt.timestep)
        for command in range(round(ROLLING_S / EVERY_S)):
            time_s = command * EVERY_S
            number = min(int(time_s / POSTURE_S), POSTURES - 1)
            share = min((time_s - number * POSTURE_S) / MOVING_S, 1.0)
            target = postures[number] + share * (postures[number + 1] - postures[number])
            shares[self.moved] = STIFFNESS * (target - data.qpos[angles] - DAMPING_S * data.qvel[dofs])
            data.ctrl[:] = drive.controls(data, np.clip(shares, -1.0, 1.0))
            mujoco.mj_step(model, data, every)
        return min(-elevation_deg(data, body) for body in (infant.pushed, model.body("hip").id))


def search_roll(infant: TrialInfant, rounds: int = ROUNDS, seed: int = 0) -> tuple[float, int]:
    """Return how far the best sequence turns an infant down, in [deg], and how many were tried."""
    roller, random = Roller(infant), np.random.default_rng(seed)
    mean, best_deg = np.zeros(POSTURES * len(roller.moved)), -90.0
    spread = np.full(len(mean), SPREAD)
    for count in range(1, rounds + 1):
        draws = np.clip(mean + spread * random.standard_normal((DRAWS, len(mean))), -1.0, 1.0)
        downs = np.array([roller.play(draw) for draw in draws])
        best_deg = max(best_deg, float(downs.max()))
        if best_deg >= ROLLED_DEG:
            return best_deg, count * DRAWS
        kept = draws[np.argsort(downs)[-KEPT:]]
        mean += SMOOTHING * (kept.mean(axis=0) - mean)
        spread = np.maximum(spread + SMOOTHING * (kept.std(axis=0) - spread), MIN_SPREAD)
    return best_deg, rounds * DRAWS


def _measure(subject: Subject) -> Values:
    best_deg, tried = -90.0, 0
    for seed in range(SEEDS):
        down_deg, count = search_roll(subject.infant, seed=seed)
        best_deg, tried = max(best_deg, down_deg), tried + count
        if best_deg >= ROLLED_DEG:
            break
    return {"roll_deg": best_deg, "roll_tried": float(tried)}


ROLL = MovementTrial(
    "roll",
    "rolls from its back towards its belly by three postures that a search makes up: how far it faces down after 4 s",
    _measure,
    (2.0, 5.0, 6.0),
    (Quantity("roll_deg", "Rolling: faces down by", "deg"), Quantity("roll_tried", "Rolling: movements tried")),
    ("hip", "head", "left_upper_arm", "right_upper_arm", "left_upper_leg", "right_upper_leg"),
    held_out=True,
    on_request=True,
)
