"""Postures that infants hold: seated, prone on the forearms, on hands and knees, standing; and when one is lost."""

from collections.abc import Callable, Mapping

import mujoco
import numpy as np

from mimoc.policies.control.infant import DrivenInfant
from mimoc.schema.names import SIDES

BISECTIONS = 12


def bisect(
    low: float, high: float, place: Callable[[float], mujoco.MjData], is_too_high: Callable[[mujoco.MjData], bool]
) -> mujoco.MjData:
    """Return the posture of the value from which on something is too high, by halving an interval again and again."""
    for _ in range(BISECTIONS - 1):
        middle = (low + high) / 2
        low, high = (low, middle) if is_too_high(place(middle)) else (middle, high)
    return place((low + high) / 2)


def tilt_deg(data: mujoco.MjData, body: int) -> float:
    """Return the angle between a body's own upward axis and the vertical."""
    return float(np.degrees(np.arccos(np.clip(data.xmat[body, 8], -1.0, 1.0))))


def elevation_deg(data: mujoco.MjData, body: int) -> float:
    """Return how far a body faces up: 90 degrees for straight up, -90 for straight down."""
    return float(np.degrees(np.arcsin(np.clip(data.xmat[body, 6], -1.0, 1.0))))


def rise_deg(data: mujoco.MjData, start: int, end: int) -> float:
    """Return the elevation of the line from one body's origin to another's: 90 degrees for straight up."""
    line_m = data.xpos[end] - data.xpos[start]
    return float(np.degrees(np.arctan2(line_m[2], np.hypot(line_m[0], line_m[1]))))


MAX_TILT_DEG = 45.0
SEAT = ("hip", "left_upper_leg", "right_upper_leg")
FEET = ("left_foot", "right_foot")
SUPPORTS = ("left_hand", "right_hand", "left_upper_leg", "right_upper_leg")
"""Parts that may touch the floor, with all that hangs on them; thighs, because they end in the knees."""
PRONE_UP_DEG = 45.0  # How far the face has to be turned up from straight down: "head up 45 degrees" of Denver II.
MIN_PITCH_DEG, MAX_PITCH_DEG = -30.0, 40.0  # Range of the pitch of the pelvis in which a seat is looked for.


SEATED_ARMS_DEG: Mapping[str, float] = {"{side}_shoulder_ad_ab": 20.0, "{side}_elbow": -60.0}
STANDING_LIMBS_DEG: Mapping[str, float] = {"{side}_elbow": -15.0}
"""Angles of arms in the trials, by the names of joints as for `DrivenInfant.placed`."""


def seat(
    infant: DrivenInfant, knee_deg: float, lean: float, arms_deg: Mapping[str, float] = SEATED_ARMS_DEG
) -> mujoco.MjData:
    """Return an infant sitting with seat and heels on the floor, its centre of mass over some point between them.

    The tilt of the pelvis, and the hips that bring the heels to the floor, are found by bisection.
    """
    data = mujoco.MjData(infant.model)

    def heels_down(pitch_deg: float) -> mujoco.MjData:
        return bisect(
            *infant.range_deg("left_hip1"),
            lambda hip_deg: infant.placed(
                pitch_deg,
                {
                    "{side}_hip1": hip_deg,
                    "{side}_hip2": -35.0,
                    "{side}_knee": knee_deg,
                    **arms_deg,
                    "head_tilt": -pitch_deg,
                },
                into=data,
            ),
            lambda data: infant.lowest_m(data, "hip") > infant.lowest_m(data, "left_foot"),
        )

    return bisect(MIN_PITCH_DEG, MAX_PITCH_DEG, heels_down, lambda data: _lean_over_seat(infant, data) > lean)


def _lean_over_seat(infant: DrivenInfant, data: mujoco.MjData) -> float:
    """Return where the centre of mass stands: 0 over the middle of the pelvis, 1 over the ankles."""
    seat_m, heels_m = data.xpos[infant.body("hip"), 0], data.xpos[infant.body("left_foot"), 0]
    return float((data.subtree_com[infant.root, 0] - seat_m) / (heels_m - seat_m))


def slumped(infant: DrivenInfant, data: mujoco.MjData, forbidden: frozenset[int]) -> str:
    """Return whether arms, trunk or head touch the floor, or the trunk or the head is tilted too far."""
    if touching := infant.touching(data, forbidden):
        return touching
    if tilt_deg(data, infant.pushed) > MAX_TILT_DEG:
        return "trunk tilted"
    return "head tilted" if tilt_deg(data, infant.body("head")) > MAX_TILT_DEG else ""


def stance(
    infant: DrivenInfant, knee_deg: float, lean: float, limbs_deg: Mapping[str, float] = STANDING_LIMBS_DEG
) -> mujoco.MjData:
    """Return an infant standing with flat soles on the floor, its centre of mass over some point of its feet.

    The hips bend half as far as the knees, or as far as a young hip is bent anyway; the ankles, and with them the lean
    of the whole infant, are found by bisection. The other joints are as *limbs_deg* says.
    """
    knee = float(np.clip(knee_deg, *infant.range_deg("left_knee")))
    hip = min(knee_deg / 2, infant.range_deg("left_hip1")[1])
    data = mujoco.MjData(infant.model)

    def placed(ankle: float) -> mujoco.MjData:
        angles_deg = {"{side}_hip1": hip, "{side}_knee": knee, "{side}_foot1": ankle, **limbs_deg}
        return infant.placed(ankle + knee - hip, angles_deg, into=data)

    return bisect(*infant.range_deg("left_foot1"), placed, lambda data: _lean_over_feet(infant, data) > lean)


def _lean_over_feet(infant: DrivenInfant, data: mujoco.MjData) -> float:
    """Return where the centre of mass stands over the feet: 0 over the ankles, 1 over the joints of the toes."""
    ankle, toes = (
        np.mean([data.xpos[infant.body(f"{side}_{part}"), 0] for side in SIDES]) for part in ("foot", "toes")
    )
    return float((data.subtree_com[infant.root, 0] - ankle) / (toes - ankle))


def fallen(infant: DrivenInfant, data: mujoco.MjData, forbidden: frozenset[int]) -> str:
    """Return whether a body that must not touch the floor does, or the trunk is tilted too far."""
    tilted = "trunk tilted" if tilt_deg(data, infant.pushed) > MAX_TILT_DEG else ""
    return infant.touching(data, forbidden) or tilted


def kneel(infant: DrivenInfant, elbow_deg: float, thigh_deg: float) -> mujoco.MjData:
    """Return an infant on hands and knees, its shanks flat on the floor and its arms upright.

    The pitch of the trunk that brings hands and knees to the floor together is found by bisection.
    """
    return bisect(
        50.0,
        110.0,
        lambda pitch_deg: infant.placed(
            pitch_deg,
            {
                "{side}_hip1": -pitch_deg - thigh_deg,
                "{side}_knee": -90.0 - thigh_deg,
                "{side}_foot1": -55.0,
                "{side}_shoulder_horizontal": 80.0,
                "{side}_shoulder_ad_ab": pitch_deg,
                "{side}_elbow": elbow_deg,
                "{side}_hand2": 80.0,
                "head_tilt": -30.0,
            },
        ),
        lambda data: infant.lowest_m(data, "left_hand") <= infant.lowest_m(data, "left_lower_leg"),
    )


def on_forearms(infant: DrivenInfant) -> mujoco.MjData:
    """Return an infant on thighs and forearms, which carry the chest; the pitch of its trunk is found by bisection."""
    return bisect(
        30.0,
        95.0,
        lambda pitch_deg: infant.placed(pitch_deg, {"{side}_hip1": 88.0 - pitch_deg, **FOREARMS_DEG}),
        lambda data: infant.lowest_m(data, "left_lower_arm") <= infant.lowest_m(data, "left_upper_leg"),
    )


def drooped(infant: DrivenInfant, data: mujoco.MjData) -> str:
    """Return whether the head of an infant that lies prone touches the floor, or its face is not turned up enough."""
    head = infant.body("head")
    low = "" if elevation_deg(data, head) >= PRONE_UP_DEG - 90.0 else "head too low"
    return infant.touching(data, frozenset({head})) or low


FOREARMS_DEG = {
    "{side}_knee": -10.0,
    "{side}_foot1": -50.0,
    "{side}_shoulder_horizontal": 80.0,
    "{side}_shoulder_ad_ab": 60.0,
    "{side}_elbow": -120.0,
    "head_tilt": -60.0,
}
