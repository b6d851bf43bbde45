"""Lifts of the legs of an infant held upright, plain, with weights on the shanks, and in water."""

import copy
from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.base.units import GRAVITY_M_S2
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.movement.drive import Drive, all_but, angle_deg, has_joint
from mimoc.studies.movement.trial import MovementTrial, Subject, Values

SHARE = 0.6  # Share of the strength of the hips' flexors.
BURST_S, CYCLE_S, BETWEEN_S = 0.5, 1.4, 0.7
"""How long a hip is driven, how often, and by how much the right one is later."""
STEPPING_S, READ_FROM_S = 6.0, 2.8
WEIGHT_KG = 0.15  # Weight on each shank; about what a leg gains in the second month, derived from WHO's weights.
FLOATING = 0.95  # Share of the weight of the legs that water carries.
ABOVE_M = 0.4
SIDES = ("left", "right")
PARTS = ("upper_leg", "lower_leg", "foot", "toes")


def lifts(infant: TrialInfant, weight_kg: float = 0.0, *, water: bool = False) -> tuple[float, float]:
    """Return range and height of the left hip's lifts, in [deg]; the height is the most bent angle.

    The trunk is held upright, so that legs hang free, with weights on the shanks, or in water up to the hips.
    """
    joints = [f"{side}_{name}" for side in SIDES for name in ("hip1", "knee", "foot1")]
    held = all_but(with_weights(infant, weight_kg), *(joint for joint in joints if has_joint(infant, joint)))
    model, data, drive = held.model, held.placed(0.0, {}, ABOVE_M), Drive(held)
    legs = [model.body(f"{side}_{part}").id for side in SIDES for part in PARTS if held.has(f"{side}_{part}")]
    lift_n = FLOATING * GRAVITY_M_S2 * model.body_mass[legs] if water else np.zeros(len(legs))
    trace = []
    for step in range(round(STEPPING_S / model.opt.timestep)):
        data.ctrl[:] = drive(data, _shares(step * model.opt.timestep))
        data.xfrc_applied[legs, 2] = lift_n
        mujoco.mj_step(model, data)
        trace.append(angle_deg(held, data, "left_hip1"))
    read = np.array(trace)[int(READ_FROM_S / model.opt.timestep) :]
    return float(np.ptp(read)), float(-read.min())


def with_weights(infant: TrialInfant, weight_kg: float, sides: Sequence[str] = SIDES) -> TrialInfant:
    """Return an infant with a weight on some of its shanks."""
    model = copy.copy(infant.model)
    for side in sides:
        model.body_mass[model.body(f"{side}_lower_leg").id] += weight_kg
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return replace(infant, model=model)


def _shares(time_s: float) -> dict[str, float]:
    later = {side: BETWEEN_S * place for place, side in enumerate(SIDES)}
    return {f"{side}_hip1": -SHARE for side in SIDES if (time_s + later[side]) % CYCLE_S < BURST_S}


def _measure(subject: Subject) -> Values:
    plain_deg, high_deg = lifts(subject.infant)
    heavy_deg, _ = lifts(subject.infant, WEIGHT_KG)
    _, afloat_deg = lifts(subject.infant, water=True)
    return {
        "step_range_deg": plain_deg,
        "step_lift_deg": high_deg,
        "step_weights_change": heavy_deg / plain_deg - 1.0 if plain_deg else None,
        "step_water_change": afloat_deg / high_deg - 1.0 if high_deg else None,
    }


STEPPING = MovementTrial(
    "stepping",
    "held upright, lifts its legs in turn with .6 of its strength: plain, with 150 g on each shank, in water",
    _measure,
    (0.0, 1.0, 2.0, 3.0),
    (
        Quantity("step_range_deg", "Steps: range of the hip", "deg"),
        Quantity("step_lift_deg", "Steps: height of the lift", "deg"),
        Quantity("step_weights_change", "Steps: change of range by weights"),
        Quantity("step_water_change", "Steps: change of height in water"),
    ),
    ("left_lower_leg", "right_lower_leg"),
    held_out=True,
    side="left",
)
