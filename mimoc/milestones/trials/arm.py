"""Holding an arm out, with the trunk held."""

from collections.abc import Iterator

import mujoco

from mimoc.milestones.infant import SIDES, Infant
from mimoc.milestones.trial import Attempt, Trial, steady
from mimoc.milestones.upright import rise_deg

ARM_S, ARM_HELD_S = 6.0, 3.0
LOWEST_DEG = -20.0
"""How far the hand may be below the shoulder, as the elevation of the line from shoulder to hand."""
CLEARANCE_M = 0.2


def _arm_out(infant: Infant) -> Iterator[Attempt]:
    held = infant.fixed([*infant.trunk_dofs(), *infant.dofs_of("head")])
    for side in reversed(SIDES):
        if infant.has(f"{side}_upper_arm", f"{side}_hand"):
            yield _attempt(held, side)


def _attempt(infant: Infant, side: str) -> Attempt:
    shoulder, hand = (infant.model.body(f"{side}_{part}").id for part in ("upper_arm", "hand"))
    data = mujoco.MjData(infant.model)
    infant.place(data, 0.0, {"{side}_hip1": -60.0, "{side}_knee": -60.0, "{side}_elbow": -20.0}, CLEARANCE_M)
    stretched_deg = {"shoulder_horizontal": 85.0, "shoulder_ad_ab": 85.0, "elbow": 0.0}
    target = infant.turned(data, {f"{side}_{name}": angle_deg for name, angle_deg in stretched_deg.items()})

    def check(data: mujoco.MjData) -> str:
        return "" if rise_deg(data, shoulder, hand) >= LOWEST_DEG else "arm too low"

    return Attempt(infant, data.qpos.copy(), steady(target), ARM_S, check, ARM_S - ARM_HELD_S, strategy=f"{side} arm")


ARM_OUT = Trial("arm_out", "holds an arm straight out for 3 s, the trunk held", _arm_out)
