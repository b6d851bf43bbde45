"""Sitting, standing alone, half a squat, and pulling up to stand: hands on a rail lead the trunk, the legs lift it."""

from collections.abc import Iterator

import mujoco
import numpy as np

from mimoc.policies.control.holding.postures import FEET, SEAT, fallen, seat, slumped, stance
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.milestones.trial import PUSHES, Attempt, Trial

STANDING_S = 10.0
KNEES_DEG = (0.0, -20.0, -40.0)
"""Knees of the postures that are tried, straight and bent; what a young joint cannot stretch stays bent."""
LEANS = (0.2, 0.3, 0.4)
"""Where the centre of mass stands over the feet in the postures that are tried: 0 over the ankle, 1 over the toes."""


def _standing(infant: TrialInfant) -> Iterator[Attempt]:
    forbidden = infant.parts_without(FEET)
    for knee_deg in KNEES_DEG:
        for lean in LEANS:
            yield Attempt(
                infant,
                stance(infant, knee_deg, lean),
                STANDING_S,
                lambda data: fallen(infant, data, forbidden),
                pushes=PUSHES,
                strategy=f"knees {knee_deg:g}°, weight {lean:g} of the way from ankle to toes",
            )


def _half_squat(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield one attempt, with hands that keep the trunk upright and let it only sink or rise."""
    start = stance(infant, SQUAT_KNEE_DEG, 0.3)
    forbidden = infant.parts_without(FEET)

    def check(data: mujoco.MjData) -> str:
        sunk = "" if data.qpos[VERTICAL] > LEAST_SQUAT * start.qpos[VERTICAL] else "sinks"
        return infant.touching(data, forbidden) or sunk

    yield Attempt(_balanced(infant), start, STANDING_S, check, strategy=f"knees {SQUAT_KNEE_DEG:g}°")


def _balanced(infant: TrialInfant) -> TrialInfant:
    """Return an infant whose trunk is held but for going up and down."""
    return infant.fixed([dof for dof in infant.trunk_dofs() if dof != VERTICAL])


SQUAT_KNEE_DEG = -60.0
LEAST_SQUAT = 0.85  # Height of the hips below which the squat is lost, by that at its start.
VERTICAL = 2  # The degree of freedom in which the hip goes up and down.

STANDING = Trial("stand", "stands alone for 10 s", _standing, FEET, "fitted")
HALF_SQUAT = Trial("half_squat", "carries its weight in a half squat for 10 s, balance given", _half_squat, FEET)

RISING_S, RISEN_S, HELD_S = 3.0, 5.0, 1.0
"""How long the trunk is led, when the trial ends, and how long the infant has to be up by then."""
DEEP_KNEE_DEG = -100.0
LEAN = 0.3
"""Where the centre of mass stands over the feet at the start and at the end: 0 over the ankles, 1 over the toes."""
LEAST_HEIGHT = 0.9
"""Height of the hips from which on the infant is up, by that of standing with knees as straight as they go."""


def _pulling_up(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield one attempt to rise from a squat.

    The rail, at the height of the shoulders, gives balance: it turns the trunk and carries it forward with the feet
    below it, but leaves it free to sink or to rise.
    """
    squat, stand = (stance(infant, knee_deg, LEAN) for knee_deg in (DEEP_KNEE_DEG, 0.0))
    start, end = squat.qpos[infant.angles].copy(), stand.qpos[infant.angles].copy()
    forward_m = float(squat.body("left_foot").xpos[0] - stand.body("left_foot").xpos[0])
    pitches = [float(2 * np.arctan2(data.qpos[5], data.qpos[3])) for data in (squat, stand)]
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
        low = "" if data.qpos[VERTICAL] >= LEAST_HEIGHT * stand.qpos[VERTICAL] else "does not get up"
        return infant.touching(data, forbidden) or low

    yield Attempt(
        _balanced(infant),
        squat,
        RISEN_S,
        check,
        RISEN_S - HELD_S,
        target=lambda data, time_s: start + min(time_s / RISING_S, 1.0) * (end - start),
        apparatus=lead,
    )


PULL_TO_STAND = Trial("pull_to_stand", "rises from a squat to standing with its legs, balance given", _pulling_up, FEET)

SITTING_S = 10.0
SITTING_KNEES_DEG = (-60.0, -40.0, -20.0)  # Knees of the postures that are tried.
SITTING_LEANS = (0.3, 0.4)
"""Where the centre of mass stands in the postures that are tried: 0 over the seat, 1 over the heels.

Chosen while looking at the ages. Upright, closer to the seat, a trunk balances without strength, so that even a
month-old infant sits; that takes control without noise and delay. Further forward, the trunk has to be strong.
"""


def _sitting(infant: TrialInfant) -> Iterator[Attempt]:
    forbidden = infant.parts_without(SEAT[1:]) - {infant.model.body("hip").id}
    for knee_deg in SITTING_KNEES_DEG:
        for lean in SITTING_LEANS:
            yield Attempt(
                infant,
                seat(infant, knee_deg, lean),
                SITTING_S,
                lambda data: slumped(infant, data, forbidden),
                pushes=PUSHES,
                strategy=f"knees {knee_deg:g}°, weight {lean:g} of the way from seat to heels",
            )


SITTING = Trial("sit", "sits without support for 10 s", _sitting, ("left_foot", "right_foot"), "fitted")
