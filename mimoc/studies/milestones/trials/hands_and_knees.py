"""Limbs that carry or lift: keeping on hands and knees, rocking there, an arm held out, both legs lifted."""

from collections.abc import Iterator
from dataclasses import replace

import mujoco
import numpy as np

from mimoc.policies.control.holding.driven import SIDES, rise_deg
from mimoc.policies.control.holding.postures import SUPPORTS, kneel
from mimoc.runtime.sense import FloatArray
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.milestones.trial import Attempt, Trial

HELD_S = 10.0
ELBOWS_DEG = (-30.0, -40.0)
"""Elbows of the postures that are tried: bent, so that muscles carry the infant. Stretched, its weight would lock them
against the ends of their range, and arms would need hardly any strength."""
THIGHS_DEG = (0.0, 20.0)  # Forward slants of the thighs that are tried.
ROCKING_HZ, ROCKING_DEG = 0.5, 10.0


def _still(infant: TrialInfant) -> Iterator[Attempt]:
    forbidden = infant.parts_without(SUPPORTS)
    for elbow_deg in ELBOWS_DEG:
        for thigh_deg in THIGHS_DEG:
            yield Attempt(
                infant,
                kneel(infant, elbow_deg, thigh_deg),
                HELD_S,
                lambda data: infant.touching(data, forbidden),
                strategy=f"elbows {elbow_deg:g}°, thighs slanted by {thigh_deg:g}°",
            )


def _rocking(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield attempts to swing forward and back over the hands, by hips and shoulders against each other."""
    swaying = [f"{side}_{joint}" for side in SIDES for joint in ("hip1", "shoulder_ad_ab")]
    sway = np.isin(infant.joint_names, swaying) * np.radians(ROCKING_DEG)
    for attempt in _still(infant):
        still = attempt.start.qpos[infant.angles]

        def rock(data: mujoco.MjData, time_s: float, still: FloatArray = still) -> FloatArray:
            return still + np.sin(2 * np.pi * ROCKING_HZ * time_s) * sway

        yield replace(attempt, target=rock)


HANDS_AND_KNEES = Trial("hands_and_knees", "keeps on hands and knees for 10 s", _still, SUPPORTS)
ROCKING = Trial("rocking", "rocks on hands and knees for 10 s", _rocking, SUPPORTS)

ARM_S, ARM_HELD_S = 6.0, 3.0
LOWEST_DEG = -20.0  # How far the hand may be below the shoulder, as the elevation of the line from shoulder to hand.
CLEARANCE_M = 0.2
LIFTING_S, RAISED_S = 3.0, 1.0
RAISED_DEG = 60.0  # How far the thighs have to point up from level.
HIPS_DEG = -80.0
LOWER_LEGS = ("left_lower_leg", "right_lower_leg")


def _arm_out(infant: TrialInfant) -> Iterator[Attempt]:
    held = infant.fixed([*infant.trunk_dofs(), *infant.dofs_of("head")])
    for side in reversed(SIDES):
        if infant.has(f"{side}_upper_arm", f"{side}_hand"):
            yield _attempt(held, side)


def _attempt(infant: TrialInfant, side: str) -> Attempt:
    shoulder, hand = (infant.model.body(f"{side}_{part}").id for part in ("upper_arm", "hand"))
    start = infant.placed(0.0, {"{side}_hip1": -60.0, "{side}_knee": -60.0, "{side}_elbow": -20.0}, CLEARANCE_M)
    goal_deg = {f"{side}_shoulder_horizontal": 85.0, f"{side}_shoulder_ad_ab": 85.0, f"{side}_elbow": 0.0}

    def check(data: mujoco.MjData) -> str:
        return "" if rise_deg(data, shoulder, hand) >= LOWEST_DEG else "arm too low"

    return Attempt(infant, start, ARM_S, check, ARM_S - ARM_HELD_S, goal_deg, strategy=f"{side} arm", side=side)


def _lifting(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield an attempt for each leg, with both lifted, and hips and knees as straight at the start as they go."""
    start = infant.placed(-90.0, {"{side}_hip1": 0.0, "{side}_knee": 0.0})
    for side in reversed(SIDES):
        hip, knee = (infant.model.body(f"{side}_{part}").id for part in ("upper_leg", "lower_leg"))

        def check(data: mujoco.MjData, hip: int = hip, knee: int = knee) -> str:
            return "" if rise_deg(data, hip, knee) >= RAISED_DEG else "leg too low"

        goal_deg = {"{side}_hip1": HIPS_DEG}
        yield Attempt(
            infant, start, LIFTING_S, check, LIFTING_S - RAISED_S, goal_deg, strategy=f"{side} leg", side=side
        )


ARM_OUT = Trial("arm_out", "holds an arm straight out for 3 s, the trunk held", _arm_out, sided=True)
LEG_LIFT = Trial(
    "leg_lift", "lying on its back, lifts both stretched legs by 60° for 1 s", _lifting, LOWER_LEGS, sided=True
)
