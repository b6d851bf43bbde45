"""Standing alone, and half a squat with the balance given."""

from collections.abc import Iterator, Mapping

import mujoco
import numpy as np

from mimoc.studies.milestones.infant import SIDES, TrialInfant, tilt_deg
from mimoc.studies.milestones.trial import PUSHES, Attempt, Trial, steady

STANDING_S = 10.0
MOST_TILT_DEG = 45.0
FEET = ("left_foot", "right_foot")
KNEES_DEG = (0.0, -20.0, -40.0)
"""Knees of the postures that are tried, straight and bent; what a young joint cannot stretch stays bent."""
LEANS = (0.2, 0.3, 0.4)
"""Where the centre of mass stands over the feet in the postures that are tried: 0 over the ankle, 1 over the toes."""


def _standing(infant: TrialInfant) -> Iterator[Attempt]:
    if not infant.has(*FEET):
        return
    forbidden = infant.parts_without(FEET)
    for knee_deg in KNEES_DEG:
        for lean in LEANS:
            data = stance(infant, knee_deg, lean)
            yield Attempt(
                infant,
                data.qpos.copy(),
                steady(data.qpos[infant.angles]),
                STANDING_S,
                lambda data: fallen(infant, data, forbidden),
                pushes=PUSHES,
                strategy=f"knees {knee_deg:g}°, weight {lean:g} of the way from ankle to toes",
            )


def fallen(infant: TrialInfant, data: mujoco.MjData, forbidden: frozenset[int]) -> str:
    """Return whether a body that must not touch the floor does, or the trunk is tilted too far."""
    if part := infant.touching(data, forbidden):
        return f"{part} touches the floor"
    return "trunk tilted" if tilt_deg(data, infant.pushed) > MOST_TILT_DEG else ""


def stance(infant: TrialInfant, knee_deg: float, lean: float) -> mujoco.MjData:
    """Return an infant standing with flat soles on the floor, its centre of mass over some point of its feet.

    The hips bend half as far as the knees, or as far as a young hip is bent anyway; the ankles, and with them the lean
    of the whole infant, are found by bisection.
    """
    data = mujoco.MjData(infant.model)
    knee = min(max(knee_deg, infant.range_deg("left_knee")[0]), infant.range_deg("left_knee")[1])
    hip = min(knee_deg / 2, infant.range_deg("left_hip1")[1])
    low, high = infant.range_deg("left_foot1")
    for _ in range(BISECTIONS):
        ankle = (low + high) / 2
        infant.place(data, ankle + knee - hip, _standing_angles(hip, knee, ankle))
        if _lean(infant, data) > lean:
            high = ankle
        else:
            low = ankle
    return data


BISECTIONS = 12


def _standing_angles(hip: float, knee: float, ankle: float) -> Mapping[str, float]:
    return {"{side}_hip1": hip, "{side}_knee": knee, "{side}_foot1": ankle, "{side}_elbow": -15.0}


def _lean(infant: TrialInfant, data: mujoco.MjData) -> float:
    """Return where the centre of mass stands over the feet: 0 over the ankles, 1 over the joints of the toes."""
    ankle, toes = (np.mean([data.body(f"{side}_{part}").xpos[0] for side in SIDES]) for part in ("foot", "toes"))
    return float((data.subtree_com[1, 0] - ankle) / (toes - ankle))


def _half_squat(infant: TrialInfant) -> Iterator[Attempt]:
    """Yield one attempt, with hands that keep the trunk upright and let it only sink or rise."""
    if not infant.has(*FEET):
        return
    data = stance(infant, SQUAT_KNEE_DEG, 0.3)
    upright = infant.fixed([dof for dof in infant.trunk_dofs() if dof != VERTICAL])
    height_m = float(data.qpos[2])
    forbidden = infant.parts_without(FEET)

    def check(data: mujoco.MjData) -> str:
        if part := infant.touching(data, forbidden):
            return f"{part} touches the floor"
        return "" if data.qpos[2] > LEAST_SQUAT * height_m else "sinks"

    target = steady(data.qpos[infant.angles])
    yield Attempt(upright, data.qpos.copy(), target, STANDING_S, check, strategy=f"knees {SQUAT_KNEE_DEG:g}°")


SQUAT_KNEE_DEG = -60.0
LEAST_SQUAT = 0.85
"""Height of the hips below which the squat is lost, by that at its start."""
VERTICAL = 2
"""The degree of freedom in which the hip goes up and down."""

STANDING = Trial("stand", "stands alone for 10 s", _standing)
HALF_SQUAT = Trial("half_squat", "carries its weight in a half squat for 10 s, balance given", _half_squat)
