"""The trials: what infants learn to do, each as an experiment in physics.

They are about the head, rolling, limbs that carry or lift, sitting and standing; when an infant pulls itself up, hands
on a rail lead its trunk, and its legs lift it.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import mujoco
import numpy as np

from mimoc.policies.behaviours.postures import LAP_DEG
from mimoc.policies.control.postures import (
    FEET,
    SEAT,
    SUPPORTS,
    drooped,
    elevation_deg,
    fallen,
    kneel,
    on_forearms,
    rise_deg,
    seat,
    slumped,
    stance,
)
from mimoc.runtime.sense import FloatArray
from mimoc.schema.names import SIDES
from mimoc.studies.milestones.trial import PUSHES, Attempt, Trial, TrialInfant

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
                balanced=True,
                on_feet=True,
            )


SQUAT_KNEE_DEG = -60.0
MIN_SQUAT = 0.85  # Height of the hips below which the squat is lost, by that at its start.
VERTICAL = 2  # The degree of freedom in which the hip goes up and down.


def _half_squat(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield one attempt, with hands that keep the trunk upright and let it only sink or rise."""
    start = stance(infant, SQUAT_KNEE_DEG, 0.3)
    forbidden = infant.parts_without(FEET)

    def check(data: mujoco.MjData) -> str:
        sunk = "" if data.qpos[VERTICAL] > MIN_SQUAT * start.qpos[VERTICAL] else "sinks"
        return infant.touching(data, forbidden) or sunk

    yield Attempt(_balanced(infant), start, STANDING_S, check, strategy=f"knees {SQUAT_KNEE_DEG:g}°")


def _balanced(infant: TrialInfant) -> TrialInfant:
    """Return an infant whose trunk is held but for going up and down."""
    return infant.fixed([dof for dof in infant.trunk_dofs() if dof != VERTICAL])


STANDING = Trial("stand", "stands alone for 10 s", _standing, FEET, "fitted")
HALF_SQUAT = Trial("half_squat", "carries its weight in a half squat for 10 s, balance given", _half_squat, FEET)

RISING_S, RISEN_S, UP_S = 3.0, 5.0, 1.0
"""How long the trunk is led, when the trial ends, and how long the infant has to be up by then."""
DEEP_KNEE_DEG = -100.0
LEAN = 0.3
"""Where the centre of mass stands over the feet at the start and at the end: 0 over the ankles, 1 over the toes."""
MIN_HEIGHT = 0.9
"""Height of the hips from which on the infant is up, by that of standing with knees as straight as they go."""


def _pulling_up(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield one attempt to rise from a squat.

    The rail, at the height of the shoulders, gives balance: it turns the trunk and carries it forward with the feet
    below it, but leaves it free to sink or to rise.
    """
    squat, stand = (stance(infant, knee_deg, LEAN) for knee_deg in (DEEP_KNEE_DEG, 0.0))
    start = squat.qpos[infant.angles].copy()
    end = stand.qpos[infant.angles].copy()
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
        low = "" if data.qpos[VERTICAL] >= MIN_HEIGHT * stand.qpos[VERTICAL] else "does not get up"
        return infant.touching(data, forbidden) or low

    yield Attempt(
        _balanced(infant),
        squat,
        RISEN_S,
        check,
        RISEN_S - UP_S,
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
    arms_deg = {f"{{side}}_{name}": angle for name, angle in LAP_DEG.items()} if infant.nerves else {}
    for knee_deg in SITTING_KNEES_DEG:
        for lean in SITTING_LEANS:
            yield Attempt(
                infant,
                seat(infant, knee_deg, lean, arms_deg),
                SITTING_S,
                lambda data: slumped(infant, data, forbidden),
                pushes=PUSHES,
                strategy=f"knees {knee_deg:g}°, weight {lean:g} of the way from seat to heels",
                balanced=True,
            )


SITTING = Trial("sit", "sits without support for 10 s", _sitting, ("left_foot", "right_foot"), "fitted")


PRONE_S = 3.0
RAISED_S = 3.0
MAX_LAG_DEG = 20.0  # How far the head may stay behind the trunk while it is raised.
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
        rate_rad_s = math.radians(90.0) / RAISED_S
        half = (math.radians(-90.0) + rate_rad_s * time_s) / 2
        data.qpos[:7] = (*start.qpos[:3], np.cos(half), 0.0, np.sin(half), 0.0)
        data.qvel[:6] = (0.0, 0.0, 0.0, 0.0, rate_rad_s, 0.0)

    def check(data: mujoco.MjData) -> str:
        lag_deg = -float(np.degrees(data.qpos[tilt]))
        return f"head lags by {lag_deg:.0f}°" if lag_deg > MAX_LAG_DEG else ""

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
        yield _roll(infant, near, far)


def _roll(infant: TrialInfant, near: str, far: str) -> Attempt:
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
LIFTING_S, LEGS_RAISED_S = 3.0, 1.0
RAISED_DEG = 60.0  # How far the thighs have to point up from level.
HIPS_DEG = -80.0
LOWER_LEGS = ("left_lower_leg", "right_lower_leg")


def _arm_out(infant: TrialInfant) -> Iterator[Attempt]:
    held = infant.fixed([*infant.trunk_dofs(), *infant.dofs_of("head")])
    for side in reversed(SIDES):
        if infant.has(f"{side}_upper_arm", f"{side}_hand"):
            yield _hold_out(held, side)


def _hold_out(infant: TrialInfant, side: str) -> Attempt:
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
            infant, start, LIFTING_S, check, LIFTING_S - LEGS_RAISED_S, goal_deg, strategy=f"{side} leg", side=side
        )


ARM_OUT = Trial("arm_out", "holds an arm straight out for 3 s, the trunk held", _arm_out, sided=True)
LEG_LIFT = Trial(
    "leg_lift", "lying on its back, lifts both stretched legs by 60° for 1 s", _lifting, LOWER_LEGS, sided=True
)


MILESTONES: tuple[Trial, ...] = (PRONE_HEAD, HALF_SQUAT, ARM_OUT, HEAD_LAG, SITTING, HANDS_AND_KNEES, STANDING)
FURTHER: tuple[Trial, ...] = (LEG_LIFT, ROLL_OVER, SUPINE_HEAD, ROCKING, PULL_TO_STAND)
"""Trials that are only reported and not judged, until they are understood."""
TRIALS: Mapping[str, Trial] = {trial.name: trial for trial in (*MILESTONES, *FURTHER)}


def trial_called(name: str) -> tuple[Trial, str]:
    """Return the trial and the side of a name such as `sit` or `arm_out:left`; no side is either."""
    trial, _, side = name.partition(":")
    return TRIALS[trial], side
