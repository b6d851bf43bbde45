"""Limbs that carry or lift: keeping on hands and knees, rocking there, an arm held out, both legs lifted."""

from collections.abc import Callable, Iterator, Mapping

import mujoco
import numpy as np

from mimoc.studies.milestones.infant import SIDES, FloatArray, TrialInfant, bisect, rise_deg
from mimoc.studies.milestones.trial import Attempt, Trial, steady

HELD_S = 10.0
SUPPORTS = ("left_hand", "right_hand", "left_upper_leg", "right_upper_leg")
"""Parts that may touch the floor, with all that hangs on them; thighs, because they end in the knees."""
ELBOWS_DEG = (-30.0, -40.0)
"""Elbows of the postures that are tried: bent, so that muscles carry the infant. Stretched, its weight would lock them
against the ends of their range, and arms would need hardly any strength."""
THIGHS_DEG = (0.0, 20.0)
"""Forward slants of the thighs that are tried."""
ROCKING_HZ, ROCKING_DEG = 0.5, 10.0


def _still(infant: TrialInfant) -> Iterator[Attempt]:
    yield from _attempts(infant, lambda start: steady(start))


def _rocking(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield attempts to swing forward and back over the hands, by hips and shoulders against each other."""
    names = infant.joint_names
    sway = np.zeros(len(names))
    for side in SIDES:
        if f"{side}_hip1" in names and f"{side}_shoulder_ad_ab" in names:
            sway[names.index(f"{side}_hip1")] = sway[names.index(f"{side}_shoulder_ad_ab")] = np.radians(ROCKING_DEG)

    def rock(start: FloatArray) -> Callable[[mujoco.MjData, float], FloatArray]:
        return lambda data, time_s: start + np.sin(2 * np.pi * ROCKING_HZ * time_s) * sway

    yield from _attempts(infant, rock)


def _attempts(
    infant: TrialInfant, target: Callable[[FloatArray], Callable[[mujoco.MjData, float], FloatArray]]
) -> Iterator[Attempt]:
    if not infant.has(*SUPPORTS):
        return
    forbidden = infant.parts_without(SUPPORTS)
    for elbow_deg in ELBOWS_DEG:
        for thigh_deg in THIGHS_DEG:
            data = kneel(infant, elbow_deg, thigh_deg)

            def check(data: mujoco.MjData) -> str:
                part = infant.touching(data, forbidden)
                return f"{part} touches the floor" if part else ""

            yield Attempt(
                infant,
                data.qpos.copy(),
                target(data.qpos[infant.angles]),
                HELD_S,
                check,
                strategy=f"elbows {elbow_deg:g}°, thighs slanted by {thigh_deg:g}°",
            )


def kneel(infant: TrialInfant, elbow_deg: float, thigh_deg: float) -> mujoco.MjData:
    """Return an infant on hands and knees, its shanks flat on the floor and its arms upright.

    The pitch of the trunk that brings hands and knees to the floor together is found by bisection.
    """
    data = mujoco.MjData(infant.model)

    def are_hands_down(pitch_deg: float) -> bool:
        infant.place(data, pitch_deg, _kneeling_angles(pitch_deg, elbow_deg, thigh_deg))
        return infant.lowest_m(data, "left_hand") <= infant.lowest_m(data, "left_lower_leg")

    bisect(50.0, 110.0, are_hands_down)
    return data


def _kneeling_angles(pitch_deg: float, elbow_deg: float, thigh_deg: float) -> Mapping[str, float]:
    return {
        "{side}_hip1": -pitch_deg - thigh_deg,
        "{side}_knee": -90.0 - thigh_deg,
        "{side}_foot1": -55.0,
        "{side}_shoulder_horizontal": 80.0,
        "{side}_shoulder_ad_ab": pitch_deg,
        "{side}_elbow": elbow_deg,
        "{side}_hand2": 80.0,
        "head_tilt": -30.0,
    }


HANDS_AND_KNEES = Trial("hands_and_knees", "keeps on hands and knees for 10 s", _still)
ROCKING = Trial("rocking", "rocks on hands and knees for 10 s", _rocking)


ARM_S, ARM_HELD_S = 6.0, 3.0
LOWEST_DEG = -20.0
"""How far the hand may be below the shoulder, as the elevation of the line from shoulder to hand."""
CLEARANCE_M = 0.2
LIFTING_S, RAISED_S = 3.0, 1.0
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
    yield Attempt(infant, data.qpos.copy(), target, LIFTING_S, check, LIFTING_S - RAISED_S)


ARM_OUT = Trial("arm_out", "holds an arm straight out for 3 s, the trunk held", _arm_out)
LEG_LIFT = Trial("leg_lift", "lying on its back, lifts both stretched legs by 60° for 1 s", _lifting)
