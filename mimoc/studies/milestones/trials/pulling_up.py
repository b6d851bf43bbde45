"""Pulling up to stand: hands on a rail lead the trunk, the legs lift it."""

from collections.abc import Iterator

import mujoco
import numpy as np

from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.milestones.trial import Attempt, Trial
from mimoc.studies.milestones.trials.standing import FEET, VERTICAL, stance

RISING_S, RISEN_S, HELD_S = 3.0, 5.0, 1.0
"""How long the trunk is led, when the trial ends, and how long the infant has to be up by then."""
SQUAT_KNEE_DEG = -100.0
LEAN = 0.3
"""Where the centre of mass stands over the feet at the start and at the end: 0 over the ankles, 1 over the toes."""
LEAST_HEIGHT = 0.9
"""Height of the hips from which on the infant is up, by that of standing with knees as straight as they go."""


def _pulling_up(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield one attempt to rise from a squat.

    The rail, at the height of the shoulders, gives balance: it turns the trunk and carries it forward with the feet
    below it, but leaves it free to sink or to rise.
    """
    if not infant.has(*FEET):
        return
    squat, stand = (stance(infant, knee_deg, LEAN) for knee_deg in (SQUAT_KNEE_DEG, 0.0))
    start, end = squat.qpos[infant.angles].copy(), stand.qpos[infant.angles].copy()
    led = infant.fixed([dof for dof in infant.trunk_dofs() if dof != VERTICAL])
    forward_m = float(squat.body("left_foot").xpos[0] - stand.body("left_foot").xpos[0])
    pitches = [_pitch_rad(data) for data in (squat, stand)]
    forbidden = infant.parts_without(FEET)

    def lead(data: mujoco.MjData, time_s: float) -> None:
        share = min(time_s / RISING_S, 1.0)
        rate_1_s = 1.0 / RISING_S if share < 1.0 else 0.0
        half = (pitches[0] + share * (pitches[1] - pitches[0])) / 2
        data.qpos[:2] = (share * forward_m, 0.0)
        data.qpos[3:7] = (np.cos(half), 0.0, np.sin(half), 0.0)
        data.qvel[:2] = (rate_1_s * forward_m, 0.0)
        data.qvel[3:6] = (0.0, rate_1_s * (pitches[1] - pitches[0]), 0.0)

    def check(data: mujoco.MjData) -> str:
        if part := infant.touching(data, forbidden):
            return f"{part} touches the floor"
        return "" if data.qpos[VERTICAL] >= LEAST_HEIGHT * stand.qpos[VERTICAL] else "does not get up"

    yield Attempt(
        led,
        squat.qpos.copy(),
        lambda data, time_s: start + min(time_s / RISING_S, 1.0) * (end - start),
        RISEN_S,
        check,
        RISEN_S - HELD_S,
        apparatus=lead,
    )


def _pitch_rad(data: mujoco.MjData) -> float:
    """Return the rotation of the hip about y."""
    return float(2 * np.arctan2(data.qpos[5], data.qpos[3]))


PULL_TO_STAND = Trial("pull_to_stand", "rises from a squat to standing with its legs, balance given", _pulling_up)
