"""Rolling over from the back to the belly."""

from collections.abc import Iterator

import mujoco

from mimoc.studies.milestones.infant import SIDES, TrialInfant, elevation_deg
from mimoc.studies.milestones.trial import Attempt, Trial

ROLLING_S, PRONE_S = 5.0, 0.5
GATHERING_S = 1.0
"""How long the infant draws up its legs before it turns."""
FACE_DOWN_DEG = -60.0
"""How far the front of the chest has to be turned down; 0 is lying on the side."""
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
TRUNK_DEG = {"hip_rot1": 18.0, "head_swivel": 60.0}
"""The twist of trunk and head when rolling to the left."""


def _rolling(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield attempts to roll to the left and to the right."""
    if not infant.has("left_hand", "right_hand", "left_foot", "right_foot"):
        return
    for near, far in (SIDES, SIDES[::-1]):
        yield _attempt(infant, near, far)


def _attempt(infant: TrialInfant, near: str, far: str) -> Attempt:
    data = mujoco.MjData(infant.model)
    infant.place(data, -90.0, LYING_DEG)
    turn = 1.0 if near == "left" else -1.0
    thrown = {pattern.format(near=near, far=far): angle for pattern, angle in THROWN_DEG.items()}
    thrown |= {name: turn * angle for name, angle in TRUNK_DEG.items()}
    phases = [infant.turned(data, GATHERED_DEG), infant.turned(data, thrown)]

    def check(data: mujoco.MjData) -> str:
        return "" if elevation_deg(data, infant.pushed) <= FACE_DOWN_DEG else "not on its belly"

    return Attempt(
        infant,
        data.qpos.copy(),
        lambda data, time_s: phases[int(time_s >= GATHERING_S)],
        ROLLING_S,
        check,
        ROLLING_S - PRONE_S,
        strategy=f"to the {near}",
    )


ROLL_OVER = Trial("roll_over", "rolls over from its back to its belly within 5 s", _rolling)
