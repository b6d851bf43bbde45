"""Lifting the head, on the belly, on the back and while pulled to sit; and rolling over."""

from collections.abc import Iterator

import mujoco
import numpy as np

from mimoc.base.units import deg_to_rad
from mimoc.policies.control.holding.driven import SIDES, elevation_deg
from mimoc.policies.control.holding.postures import drooped, on_forearms
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.milestones.trial import Attempt, Trial

PRONE_S = 3.0
RAISED_S = 3.0
MOST_LAG_DEG = 20.0  # How far the head may stay behind the trunk while it is raised.
SUPINE_S, SUPINE_HELD_S = 3.0, 1.0
SUPINE_RAISED_DEG = 45.0  # How far the face has to be turned forward from straight up.


def _prone(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield attempts to keep a head up that somebody else lifted: with arms at the sides, then on the forearms."""

    def check(data: mujoco.MjData) -> str:
        return drooped(infant, data)

    flat = infant.placed(90.0, {"{side}_foot1": -50.0, "head_tilt": -65.0})
    yield Attempt(infant, flat, PRONE_S, check, strategy="arms at the sides")
    if infant.has("left_lower_arm", "left_upper_leg"):
        yield Attempt(infant, on_forearms(infant), PRONE_S, check, strategy="on the forearms")


def _raised(infant: TrialInfant) -> Iterator[Attempt]:
    held = infant.fixed(infant.trunk_dofs())
    tilt = int(infant.model.joint("robot:head_tilt").qposadr[0])
    start = infant.placed(-90.0, {"{side}_hip1": -40.0, "{side}_knee": -40.0})

    def raise_trunk(data: mujoco.MjData, time_s: float) -> None:
        """Turn the trunk about the hip, from lying to upright, at an even rate."""
        rate_rad_s = deg_to_rad(90.0) / RAISED_S
        half = (deg_to_rad(-90.0) + rate_rad_s * time_s) / 2
        data.qpos[:7] = (*start.qpos[:3], np.cos(half), 0.0, np.sin(half), 0.0)
        data.qvel[:6] = (0.0, 0.0, 0.0, 0.0, rate_rad_s, 0.0)

    def check(data: mujoco.MjData) -> str:
        lag_deg = -float(np.degrees(data.qpos[tilt]))
        return f"head lags by {lag_deg:.0f}°" if lag_deg > MOST_LAG_DEG else ""

    yield Attempt(held, start, RAISED_S, check, goal_deg={"head_tilt": 10.0}, apparatus=raise_trunk)


def _supine(infant: TrialInfant) -> Iterator[Attempt]:
    head = infant.model.body("head").id
    start = infant.placed(-90.0, {"{side}_hip1": -50.0, "{side}_knee": -70.0})

    def check(data: mujoco.MjData) -> str:
        return "" if elevation_deg(data, head) <= 90.0 - SUPINE_RAISED_DEG else "head too low"

    yield Attempt(infant, start, SUPINE_S, check, SUPINE_S - SUPINE_HELD_S, {"head_tilt": 60.0})


PRONE_HEAD = Trial("prone_head", "lying on its belly, keeps the head up by 45° for 3 s", _prone, basis="fitted")
HEAD_LAG = Trial("no_head_lag", "raised to sitting in 3 s, the head lags by less than 20°", _raised)
SUPINE_HEAD = Trial("supine_head", "lying on its back, lifts the head to 45° for 1 s", _supine)

ROLLING_S, ROLLED_S = 5.0, 0.5
ENDS = ("left_hand", "right_hand", "left_foot", "right_foot")
GATHERING_S = 1.0  # How long the infant draws up its legs before it turns.
FACE_DOWN_DEG = -60.0  # How far the front of the chest has to be turned down; 0 is lying on the side.
LYING_DEG = {"{side}_hip1": -30.0, "{side}_knee": -40.0, "{side}_elbow": -20.0}
GATHERED_DEG = {"{side}_hip1": -110.0, "{side}_knee": -90.0}
THROWN_DEG = {
    "{far}_hip1": -110.0,
    "{far}_hip2": 17.0,
    "{far}_knee": -30.0,
    "{far}_shoulder_horizontal": 118.0,
    "{far}_shoulder_ad_ab": 90.0,
    "{far}_elbow": 0.0,
    "{near}_hip1": 0.0,
    "{near}_knee": 0.0,
    "{near}_shoulder_ad_ab": 180.0,
    "{near}_elbow": 0.0,
}
"""The far arm and leg thrown across the body, the near ones out of their way: stretched, the arm beside the head."""
TRUNK_DEG = {"hip_rot1": 18.0, "head_swivel": 60.0}  # The twist of trunk and head when rolling to the left.


def _rolling(infant: TrialInfant) -> Iterator[Attempt]:
    for near, far in (SIDES, SIDES[::-1]):
        yield _attempt(infant, near, far)


def _attempt(infant: TrialInfant, near: str, far: str) -> Attempt:
    start = infant.placed(-90.0, LYING_DEG)
    turn = 1.0 if near == "left" else -1.0
    thrown = {pattern.format(near=near, far=far): angle for pattern, angle in THROWN_DEG.items()}
    thrown |= {name: turn * angle for name, angle in TRUNK_DEG.items()}
    phases = [infant.turned(start, angles_deg) for angles_deg in (GATHERED_DEG, thrown)]

    def check(data: mujoco.MjData) -> str:
        return "" if elevation_deg(data, infant.pushed) <= FACE_DOWN_DEG else "not on its belly"

    return Attempt(
        infant,
        start,
        ROLLING_S,
        check,
        ROLLING_S - ROLLED_S,
        target=lambda data, time_s: phases[int(time_s >= GATHERING_S)],
        strategy=f"to the {near}",
        side=near,
    )


ROLL_OVER = Trial("roll_over", "rolls over from its back to its belly within 5 s", _rolling, ENDS, sided=True)
