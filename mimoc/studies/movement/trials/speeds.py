"""How fast hands and feet of an awake infant move, as seen from above and measured in lengths of its trunk."""

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.runtime.sense import FloatArray
from mimoc.studies.movement.trial import MovementTrial, Subject, Values
from mimoc.studies.movement.trials.posture import SIDES, awake

FRAMES_HZ = 30.0  # Rate of the recordings of real infants; taken, as it is not given.
ENDS = {"hand": "hand", "foot": "toes"}
"""The bodies that begin at the points that are seen: the wrist for the hand, and the roots of the toes."""
POINTS = tuple(f"{side}_{body}" for body in ENDS.values() for side in SIDES)
PERCENTILE = 95


def places(data: mujoco.MjData) -> FloatArray:
    """Return where both hands and both feet are as seen from above, by the length of the trunk, shape (4, 2).

    The origin is the middle of the hips and the first axis points from there to the middle of the shoulders, so that
    way and turns of the trunk do not count.
    """

    def middle(body: str) -> FloatArray:
        return np.mean([data.body(f"{side}_{body}").xpos[:2] for side in SIDES], axis=0)

    hips, up = middle("upper_leg"), middle("upper_arm") - middle("upper_leg")
    axes = np.array([up, (-up[1], up[0])]) / (up @ up)
    return np.array([axes @ (data.body(point).xpos[:2] - hips) for point in POINTS])


def speeds(trace: FloatArray, step_s: float) -> FloatArray:
    """Return the speeds of points by the central differences of a recording, shape (frames - 2, points).

    Their places after each physics step have the shape (steps, points, 2).
    """
    count, points, _ = trace.shape
    times_s = np.arange(0.0, (count - 1) * step_s, 1 / FRAMES_HZ)
    flat = trace.reshape(count, -1)
    frames = np.array([np.interp(times_s, np.arange(count) * step_s, column) for column in flat.T]).T
    velocities = (frames[2:] - frames[:-2]).reshape(-1, points, 2) * FRAMES_HZ / 2
    return np.asarray(np.linalg.norm(velocities, axis=2), np.float64)


def _measure(subject: Subject) -> Values:
    trace = np.array([places(data) for data in awake(subject.infant)])
    seen = speeds(trace, subject.infant.model.opt.timestep)
    hands, feet = (float(np.percentile(part, PERCENTILE)) for part in (seen[:, :2], seen[:, 2:]))
    return {"speed_hand": hands, "speed_foot": feet}


SPEEDS = MovementTrial(
    "speeds",
    "awake on its back, moves at random: 95th percentile of the speeds of hands and feet, in trunk lengths a second",
    _measure,
    (0.0, 1.0, 3.0, 6.0),
    tuple(Quantity(f"speed_{name}", f"Awake: speed of the {name}, in trunk lengths", "1/s") for name in ENDS),
    (*POINTS, "left_upper_leg", "right_upper_leg", "left_upper_arm", "right_upper_arm"),
    held_out=True,
)
