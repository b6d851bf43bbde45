"""Infants without commands, lying, sitting or with a free head, and pictures of those that try to sit."""

from collections import deque
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.compiler.measuring import ROOT
from mimoc.policies.control.holding.postures import seat
from mimoc.render.body_camera import BodyCamera
from mimoc.render.picture_files import Picture, tile_pictures
from mimoc.render.soft_light import STILL
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.milestones import TRIALS, Conditions, Outcome, TrialInfant, compile_at
from mimoc.studies.milestones.trial import simulate

LYING_S, FALLING_S = 6.0, 3.0
ON_THE_BACK_DEG, LEANING_BACK_DEG, UPRIGHT_DEG = -90.0, -45.0, 0.0
BENT_DEG = {"{side}_hip1": -50.0, "{side}_hip2": -25.0, "{side}_knee": -70.0, "{side}_elbow": -60.0}
"""The posture in which an infant is laid down, its arms away from its body: that of mimoc's pose `supine`."""
ARMS_DEG = 60.0
ABOVE_M = 1.0  # Height at which a trunk is held, so that nothing touches the floor.
LEANS = (0.15, 0.25, 0.35, 0.45)
"""Where the weight of a sitting infant stands at first: 0 over the seat, 1 over the heels."""
SITTING_KNEE_DEG = -20.0


@dataclass(frozen=True, slots=True)
class Rest:
    """Where an infant without commands comes to rest."""

    development: Development
    age_months: float
    hip_deg: float  # Lying on its back; below 0 is bent, as for knee and elbow.
    knee_deg: float
    elbow_deg: float
    head_upright_deg: float  # Angle of the head with the trunk held upright; above 0, the chin has fallen to the chest.
    head_back_deg: float  # The same with the trunk leaning back by 45 degrees; below 0, the head has fallen back.
    slumps_deg: Sequence[float]
    """Tilt of the chest after sitting, for each of `LEANS`; above 0 forward, about 90 is lying."""


def rest(development: Development, age_months: float) -> Rest:
    """Return where the average child of an age comes to rest."""
    infant = _average_child(development, age_months)
    lying = infant.placed(ON_THE_BACK_DEG, {**BENT_DEG, "{side}_shoulder_ad_ab": ARMS_DEG})
    lying = _after(infant, lying, LYING_S)
    return Rest(
        development,
        age_months,
        hip_deg=_angle_deg(infant, lying, "left_hip1"),
        knee_deg=_angle_deg(infant, lying, "left_knee"),
        elbow_deg=_angle_deg(infant, lying, "left_elbow"),
        head_upright_deg=_head_deg(infant, UPRIGHT_DEG),
        head_back_deg=_head_deg(infant, LEANING_BACK_DEG),
        slumps_deg=[_slump_deg(infant, lean) for lean in LEANS],
    )


def _average_child(development: Development, age_months: float) -> TrialInfant:
    spec = InfantSpec(mimoc=1, name="average_child", age_months=age_months, development=development)
    return compile_at(spec, age_months, Conditions())


def _head_deg(infant: TrialInfant, pitch_deg: float) -> float:
    held = infant.fixed(infant.trunk_dofs())
    return _angle_deg(held, _after(held, held.placed(pitch_deg, {}, ABOVE_M), FALLING_S), "head_tilt")


def _slump_deg(infant: TrialInfant, lean: float) -> float:
    """Return the tilt of the chest of a slack infant that sat with its weight over some point."""
    data = _after(infant, seat(infant, SITTING_KNEE_DEG, lean), FALLING_S)
    forward, _, up = data.xmat[infant.pushed].reshape(3, 3)[:, 2]
    return float(np.degrees(np.arctan2(forward, up)))


def _after(infant: TrialInfant, data: mujoco.MjData, seconds: float) -> mujoco.MjData:
    for _ in range(round(seconds / infant.model.opt.timestep)):
        mujoco.mj_step(infant.model, data)
    return data


def _angle_deg(infant: TrialInfant, data: mujoco.MjData, joint: str) -> float:
    address = infant.model.joint(f"robot:{joint}").qposadr[0]
    return float(np.degrees(data.qpos[address]))


PICTURE_PX = (150, 150)


def try_to_sit(development: Development, age_months: float) -> Picture:
    """Let the average child of an age try to sit, and show how its longest attempt ended."""
    infant = _average_child(development, age_months)
    best, outcome = mujoco.MjData(infant.model), Outcome(False, -1.0)
    for attempt in TRIALS["sit"].attempts(infant):
        states = deque[mujoco.MjData](maxlen=1)
        ended = simulate(attempt, Conditions(), states.append)
        if ended.seconds > outcome.seconds:
            best, outcome = states[0], ended
        if outcome.success:
            break
    with closing(BodyCamera(infant.model, [ROOT], *PICTURE_PX, exposure=STILL)) as camera:
        held = "sits" if outcome.success else f"falls after {outcome.seconds:.1f} s"
        return tile_pictures([[camera.render(best)]], columns=[f"{age_months:g} months: {held}"])
