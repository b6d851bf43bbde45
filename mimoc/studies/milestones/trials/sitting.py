"""Sitting without support."""

from collections.abc import Iterator, Mapping

import mujoco

from mimoc.studies.milestones.infant import TrialInfant, bisect, tilt_deg
from mimoc.studies.milestones.trial import PUSHES, Attempt, Trial

SITTING_S = 10.0
MOST_TILT_DEG = 45.0
SEAT = ("hip", "left_upper_leg", "right_upper_leg")
KNEES_DEG = (-60.0, -40.0, -20.0)
"""Knees of the postures that are tried."""
LEANS = (0.3, 0.4)
"""Where the centre of mass stands in the postures that are tried: 0 over the seat, 1 over the heels.

Chosen while looking at the ages. Upright, closer to the seat, a trunk balances without strength, so that even a
month-old infant sits; that takes control without noise and delay. Further forward, the trunk has to be strong.
"""


def _sitting(infant: TrialInfant) -> Iterator[Attempt]:
    forbidden = infant.parts_without(SEAT[1:]) - {infant.model.body("hip").id}
    for knee_deg in KNEES_DEG:
        for lean in LEANS:
            yield Attempt(
                infant,
                seat(infant, knee_deg, lean),
                SITTING_S,
                lambda data: slumped(infant, data, forbidden),
                pushes=PUSHES,
                strategy=f"knees {knee_deg:g}°, weight {lean:g} of the way from seat to heels",
            )


def seat(infant: TrialInfant, knee_deg: float, lean: float) -> mujoco.MjData:
    """Return an infant sitting with seat and heels on the floor, its centre of mass over some point between them.

    The tilt of the pelvis, and the hips that bring the heels to the floor, are found by bisection.
    """

    def heels_down(pitch_deg: float) -> mujoco.MjData:
        return bisect(
            *infant.range_deg("left_hip1"),
            lambda hip_deg: infant.placed(pitch_deg, _sitting_angles(pitch_deg, hip_deg, knee_deg)),
            lambda data: infant.lowest_m(data, "hip") > infant.lowest_m(data, "left_foot"),
        )

    return bisect(LEAST_PITCH_DEG, MOST_PITCH_DEG, heels_down, lambda data: _lean(data) > lean)


LEAST_PITCH_DEG, MOST_PITCH_DEG = -30.0, 40.0


def _lean(data: mujoco.MjData) -> float:
    """Return where the centre of mass stands: 0 over the middle of the pelvis, 1 over the ankles."""
    seat_m, heels_m = data.body("hip").xpos[0], data.body("left_foot").xpos[0]
    return float((data.subtree_com[1, 0] - seat_m) / (heels_m - seat_m))


def slumped(infant: TrialInfant, data: mujoco.MjData, forbidden: frozenset[int]) -> str:
    """Return whether arms, trunk or head touch the floor, or the trunk or the head is tilted too far."""
    if touching := infant.touching(data, forbidden):
        return touching
    if tilt_deg(data, infant.pushed) > MOST_TILT_DEG:
        return "trunk tilted"
    return "head tilted" if tilt_deg(data, infant.model.body("head").id) > MOST_TILT_DEG else ""


def _sitting_angles(pitch_deg: float, hip_deg: float, knee_deg: float) -> Mapping[str, float]:
    return {
        "{side}_hip1": hip_deg,
        "{side}_hip2": -35.0,
        "{side}_knee": knee_deg,
        "{side}_shoulder_ad_ab": 20.0,
        "{side}_elbow": -60.0,
        "head_tilt": -pitch_deg,
    }


SITTING = Trial("sit", "sits without support for 10 s", _sitting, ("left_foot", "right_foot"), "fitted")
