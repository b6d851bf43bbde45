"""Holding an arm out, with the trunk held, and lifting both legs, lying on the back."""

from collections.abc import Iterator

import mujoco

from mimoc.studies.milestones.infant import SIDES, TrialInfant, rise_deg
from mimoc.studies.milestones.trial import Attempt, Trial, steady

ARM_S, ARM_HELD_S = 6.0, 3.0
LOWEST_DEG = -20.0
"""How far the hand may be below the shoulder, as the elevation of the line from shoulder to hand."""
CLEARANCE_M = 0.2
LIFTING_S, HELD_S = 3.0, 1.0
RAISED_DEG = 60.0
"""How far the thighs have to point up from level."""
HIPS_DEG = -80.0


def _arm_out(infant: TrialInfant) -> Iterator[Attempt]:
    held = infant.fixed([*infant.trunk_dofs(), *infant.dofs_of("head")])
    for side in reversed(SIDES):
        if infant.has(f"{side}_upper_arm", f"{side}_hand"):
            yield _attempt(held, side)


def _attempt(infant: TrialInfant, side: str) -> Attempt:
    shoulder, hand = (infant.model.body(f"{side}_{part}").id for part in ("upper_arm", "hand"))
    data = mujoco.MjData(infant.model)
    infant.place(data, 0.0, {"{side}_hip1": -60.0, "{side}_knee": -60.0, "{side}_elbow": -20.0}, CLEARANCE_M)
    stretched_deg = {"shoulder_horizontal": 85.0, "shoulder_ad_ab": 85.0, "elbow": 0.0}
    target = infant.turned(data, {f"{side}_{name}": angle_deg for name, angle_deg in stretched_deg.items()})

    def check(data: mujoco.MjData) -> str:
        return "" if rise_deg(data, shoulder, hand) >= LOWEST_DEG else "arm too low"

    return Attempt(infant, data.qpos.copy(), steady(target), ARM_S, check, ARM_S - ARM_HELD_S, strategy=f"{side} arm")


def _lifting(infant: TrialInfant) -> Iterator[Attempt]:
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


ARM_OUT = Trial("arm_out", "holds an arm straight out for 3 s, the trunk held", _arm_out)
LEG_LIFT = Trial("leg_lift", "lying on its back, lifts both stretched legs by 60° for 1 s", _lifting)
