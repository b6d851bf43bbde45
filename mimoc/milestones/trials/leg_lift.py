"""Lifting both legs, lying on the back."""

from collections.abc import Iterator

import mujoco

from mimoc.milestones.infant import SIDES, Infant
from mimoc.milestones.trial import Attempt, Trial, steady
from mimoc.milestones.upright import rise_deg

LIFTING_S, HELD_S = 3.0, 1.0
RAISED_DEG = 60.0
"""How far the thighs have to point up from level."""
HIPS_DEG = -80.0


def _lifting(infant: Infant) -> Iterator[Attempt]:
    """Yield one attempt, with hips and knees as straight at the start as they go."""
    if not infant.has("left_lower_leg", "right_lower_leg"):
        return
    legs = [(infant.model.body(f"{side}_upper_leg").id, infant.model.body(f"{side}_lower_leg").id) for side in SIDES]
    data = mujoco.MjData(infant.model)
    infant.place(data, -90.0, {"{side}_hip1": 0.0, "{side}_knee": 0.0})

    def check(data: mujoco.MjData) -> str:
        return "legs too low" if min(rise_deg(data, hip, knee) for hip, knee in legs) < RAISED_DEG else ""

    target = steady(infant.turned(data, {"{side}_hip1": HIPS_DEG}))
    yield Attempt(infant, data.qpos.copy(), target, LIFTING_S, check, LIFTING_S - HELD_S)


LEG_LIFT = Trial("leg_lift", "lying on its back, lifts both stretched legs by 60° for 1 s", _lifting)
