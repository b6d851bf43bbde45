"""Kicks of one leg and of both in turn, and lifts of legs held upright, changed by weights, posture or water."""

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.base.units import GRAVITY_M_S2
from mimoc.compiler.measuring import ROOT
from mimoc.runtime.sense import FloatArray
from mimoc.studies.milestones.trial import TrialInfant
from mimoc.studies.movement.trial import (
    MovementTrial,
    Subject,
    Values,
    again,
    all_but,
    angle_deg,
    driven,
    has_joint,
    settled,
)

KICK_S = 0.35  # How long the hip is driven: kicks of real infants last .23 to .33 s.
ENOUGH_DEG = 50.0  # Excursion of the hip that counts as a kick.
SHARE = 0.8  # Most of its strength that an infant may need.
KICK_SHARES = (0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.8, 0.9, 1.0)
"""Shares of the hip's strength among which the least that suffices is looked for."""
GENTLE_SHARES = (0.2, 0.3, 0.4, 0.5, 0.6, 0.65, 0.7, 0.75, 0.8)
KNEES = (-1.0, 0.0, 1.0)  # What the knee does, by the share of the hip: it bends as much, does nothing, or stretches.
GENTLE_KNEES = (-1.0, -0.5, -0.25, 0.0, 0.25, 0.5)
MEAN_S = 0.05
"""Time over which accelerations are taken, as the speed changes: that of the filters of body-worn sensors, a guess."""


@dataclass(frozen=True, slots=True)
class Kick:
    """The effect of a burst at the hip."""

    excursion_deg: float  # How far the hip has bent at most.
    seconds: float | None  # Time to `ENOUGH_DEG`; None if it does not bend so far.
    acceleration_m_s2: float  # Peak acceleration of the foot until then.


def kick(infant: TrialInfant, start: mujoco.MjData, hip: float, knee: float) -> Kick:
    """Return what comes of bending the left hip from rest, with shares of the strength of hip and knee.

    The hip's is that of its flexors; above 0, the knee is stretched.
    """
    data = again(infant, start, moving=False)
    before_deg = angle_deg(infant, data, "left_hip1")
    foot = infant.model.body("left_foot").id
    speeds = [np.zeros(3)]
    most_deg = -np.inf
    fastest = 0.0
    seconds = None
    window = round(MEAN_S / infant.model.opt.timestep)
    velocity = np.zeros(6)
    for time_s in driven(infant, data, KICK_S, {"left_hip1": -hip, "left_knee": knee}):
        mujoco.mj_objectVelocity(infant.model, data, mujoco.mjtObj.mjOBJ_XBODY, foot, velocity, 0)
        speeds.append(velocity[3:].copy())
        bent_deg = before_deg - angle_deg(infant, data, "left_hip1")
        most_deg = max(most_deg, bent_deg)
        if seconds is None:
            fastest = max(
                fastest, float(np.linalg.norm(speeds[-1] - speeds[max(0, len(speeds) - 1 - window)])) / MEAN_S
            )
            seconds = time_s if bent_deg >= ENOUGH_DEG else None
    return Kick(most_deg, seconds, fastest)


def best_kick(infant: TrialInfant, start: mujoco.MjData, hip: float, knees: Sequence[float] = KNEES) -> Kick:
    """Return the kick that goes furthest among those with some share of the hip, by what the knee does."""
    return max((kick(infant, start, hip, hip * knee) for knee in knees), key=lambda one: one.excursion_deg)


def _kick(subject: Subject) -> Values:
    infant, start = subject.infant, settled(subject.infant)
    usual = best_kick(infant, start, SHARE)
    enough = [share for share in KICK_SHARES if best_kick(infant, start, share).seconds is not None]
    kicks = [kick(infant, start, hip, hip * knee) for hip in GENTLE_SHARES for knee in GENTLE_KNEES]
    accelerations = [one.acceleration_m_s2 for one in kicks if one.seconds is not None]
    return {
        "kick_deg": usual.excursion_deg,
        "kick_s": usual.seconds,
        "kick_share": min(enough, default=None),
        "kick_gentlest_m_s2": min(accelerations, default=None),
        "kick_strongest_m_s2": max(accelerations, default=None),
    }


KICK = MovementTrial(
    "kick",
    "on its back, bends a hip with at most .8 of its strength",
    _kick,
    (0.0, 1.0, 3.0, 6.0),
    (
        Quantity("kick_deg", "Kick: hip bends by", "deg"),
        Quantity("kick_s", "Kick: time to 50 degrees", "s"),
        Quantity("kick_share", "Kick: least share of strength"),
        Quantity("kick_gentlest_m_s2", "Kick: gentlest peak of the foot", "m/s²"),
        Quantity("kick_strongest_m_s2", "Kick: strongest peak of the foot", "m/s²"),
    ),
    ("left_lower_leg", "left_foot"),
    side="left",
)


SIDES = ("left", "right")
STEP_SHARE = 0.6  # Share of the strength of the hips' flexors.
STEP_BURST_S, STEP_CYCLE_S, STEP_BETWEEN_S = 0.5, 1.4, 0.7
"""How long a hip is driven, how often, and by how much the right one is later."""
STEPPING_S, STEPS_FROM_S = 6.0, 2.8
SHANKS_KG = 0.15  # Weight on each shank; about what a leg gains in the second month, derived from WHO's weights.
FLOATING = 0.95  # Share of the weight of the legs that water carries.
ABOVE_M = 0.4
PARTS = ("upper_leg", "lower_leg", "foot", "toes")


def lifts(infant: TrialInfant, weight_kg: float = 0.0, *, water: bool = False) -> tuple[float, float]:
    """Return range and height of the left hip's lifts, in [deg]; the height is the most bent angle.

    The trunk is held upright, so that legs hang free, with weights on the shanks, or in water up to the hips.
    """
    joints = [f"{side}_{name}" for side in SIDES for name in ("hip1", "knee", "foot1")]
    held = all_but(with_weights(infant, weight_kg), *(joint for joint in joints if has_joint(infant, joint)))
    model, data = held.model, held.placed(0.0, {}, ABOVE_M)
    legs = [model.body(f"{side}_{part}").id for side in SIDES for part in PARTS if held.has(f"{side}_{part}")]
    data.xfrc_applied[legs, 2] = FLOATING * GRAVITY_M_S2 * model.body_mass[legs] if water else 0.0
    trace = [angle_deg(held, data, "left_hip1") for _ in driven(held, data, STEPPING_S, _step_shares)]
    read = np.array(trace)[int(STEPS_FROM_S / model.opt.timestep) :]
    return float(np.ptp(read)), float(-read.min())


def with_weights(infant: TrialInfant, weight_kg: float, sides: Sequence[str] = SIDES) -> TrialInfant:
    """Return an infant with a weight on some of its shanks."""
    model = copy.copy(infant.model)
    for side in sides:
        model.body_mass[model.body(f"{side}_lower_leg").id] += weight_kg
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return replace(infant, model=model)


def _step_shares(time_s: float) -> dict[str, float]:
    later = {side: STEP_BETWEEN_S * place for place, side in enumerate(SIDES)}
    return {f"{side}_hip1": -STEP_SHARE for side in SIDES if (time_s + later[side]) % STEP_CYCLE_S < STEP_BURST_S}


def _stepping(subject: Subject) -> Values:
    plain_deg, high_deg = lifts(subject.infant)
    heavy_deg, _ = lifts(subject.infant, SHANKS_KG)
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
    _stepping,
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


BURST_S, CYCLE_S, BETWEEN_S = 0.35, 2.0, 1.0
"""How long a hip is driven (flexion lasts .3 to .4 s), how often (active infants kick 20 to 40 times a minute), and by
how much the right one is later."""
KICKING_S, READ_FROM_S = 8.0, 2.0
KNEE = 0.5
"""Share of the strength of the knee, by that of the hip: in young infants both bend together; the size is a guess."""
USUAL_DEG = 40.0  # Excursion of the hip in an everyday kick.
LEG_SHARES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
"""Shares of the strength of the hip's flexors, the least of which is taken that bends it by `USUAL_DEG`."""
WEIGHT_KG = 0.1
SEEDS, UNEVEN = 12, 0.2
"""Seeds with which a weighted leg kicks, as a single one would show chance; how uneven kicks are is a guess."""
TILTS_DEG = {"45": 45.0, "upright": 90.0}  # How far the infant and the board on which it lies are tilted.
SETTLING_S = 2.0
LEGS = tuple(f"{side}_{name}" for side in SIDES for name in ("hip1", "hip2", "hip3", "knee", "foot1"))


def excursions(infant: TrialInfant, start: mujoco.MjData, share: float, seed: int | None = None) -> FloatArray:
    """Return the ranges of left and right hip, in [deg], in kicks with some share of their strength, shape (2,).

    Knees bend with half of the share of the hips' flexors. A seed makes each kick stronger or weaker by up to `UNEVEN`.
    """
    data = again(infant, start, moving=False)
    cycles = int(KICKING_S / CYCLE_S) + 1
    uneven = np.random.default_rng(seed).uniform(1 - UNEVEN, 1 + UNEVEN, (cycles, 2)) if seed is not None else 1.0
    kicks = np.minimum(share * np.ones((cycles, 2)) * uneven, 1.0)
    trace = [
        [angle_deg(infant, data, f"{side}_hip1") for side in SIDES]
        for _ in driven(infant, data, KICKING_S, lambda time_s: _kick_shares(time_s, kicks))
    ]
    return np.asarray(np.ptp(trace[round(READ_FROM_S / infant.model.opt.timestep) :], axis=0), np.float64)


def tilted(infant: TrialInfant, tilt_deg: float) -> TrialInfant:
    """Return an infant tilted with the board that it lies on, trunk, head and arms held; 90 degrees is upright."""
    model, supine = copy.copy(infant.model), infant.placed(-90.0, {})
    to_feet = np.sign(supine.body(ROOT).xpos[0] - supine.body("head").xpos[0])
    tilt_rad = math.radians(tilt_deg)
    model.opt.gravity[:] = GRAVITY_M_S2 * np.array([to_feet * np.sin(tilt_rad), 0.0, -np.cos(tilt_rad)])
    turned = replace(infant, model=model)
    return all_but(turned, *(joint for joint in LEGS if has_joint(infant, joint)))


def usual_share(infant: TrialInfant, start: mujoco.MjData) -> float:
    """Return the least share of strength with which the left hip moves by 40 degrees; 1 if none does."""
    return next((share for share in LEG_SHARES if excursions(infant, start, share)[0] >= USUAL_DEG), LEG_SHARES[-1])


def _kick_shares(time_s: float, kicks: FloatArray) -> dict[str, float]:
    """Return what hips and knees do at a time, by the share of each kick, shape (cycles, 2)."""
    shares = {}
    for slot, side in enumerate(SIDES):
        cycle, since_s = divmod(time_s + slot * BETWEEN_S, CYCLE_S)
        if since_s < BURST_S:
            share = kicks[int(cycle), slot]
            shares |= {f"{side}_hip1": -share, f"{side}_knee": -KNEE * share}
    return shares


def _weighted(subject: Subject) -> Values:
    infant = subject.infant
    heavy = with_weights(subject.infant, WEIGHT_KG, ("left",))
    start, loaded = settled(infant, SETTLING_S), settled(heavy, SETTLING_S)
    share = usual_share(infant, start)
    plain = np.array([excursions(infant, start, share, seed) for seed in range(SEEDS)])
    changed = np.array([excursions(heavy, loaded, share, seed) for seed in range(SEEDS)])
    changes = changed.mean(axis=0) / plain.mean(axis=0) - 1.0
    less = (changed < plain).mean(axis=0)
    return {
        "leg_kick_deg": float(plain[:, 0].mean()),
        "leg_weight_change": float(changes[0]),
        "leg_weight_other_change": float(changes[1]),
        "leg_weight_less": float(less[0]),
        "leg_weight_other_less": float(less[1]),
    }


def _tilted(subject: Subject) -> Values:
    start = settled(subject.infant, SETTLING_S)
    supine = tilted(subject.infant, 0.0)
    share = usual_share(supine, start)
    plain = float(excursions(supine, start, share)[0])
    bodies = {name: tilted(subject.infant, tilt_deg) for name, tilt_deg in TILTS_DEG.items()}
    changes = {
        f"posture_{name}_change": float(excursions(body, start, share)[0]) / plain - 1.0 if plain else None
        for name, body in bodies.items()
    }
    return {"posture_supine_deg": plain, **changes}


LEG_WEIGHT = MovementTrial(
    "leg_weight",
    "on its back, kicks with both legs in turn by 40 degrees at the hip: then with 100 g on the left shank; 12 seeds",
    _weighted,
    (1.5, 3.0),
    (
        Quantity("leg_kick_deg", "Kicks in turn: range of the hip", "deg"),
        Quantity("leg_weight_change", "Weight on a leg: change of its range"),
        Quantity("leg_weight_other_change", "Weight on a leg: change of the other's range"),
        Quantity("leg_weight_less", "Weight on a leg: share of seeds in which it moves less"),
        Quantity("leg_weight_other_less", "Weight on a leg: share of seeds in which the other moves less"),
    ),
    ("left_lower_leg", "right_lower_leg"),
    held_out=True,
)
POSTURE = MovementTrial(
    "posture",
    "on a board, trunk held, kicks with both legs in turn by 40 degrees at the hip: then tilted by 45° and upright",
    _tilted,
    (3.0,),
    (
        Quantity("posture_supine_deg", "Kicks on the board: range of the hip", "deg"),
        *(Quantity(f"posture_{name}_change", f"Kicks on the board, {name}: change of range") for name in TILTS_DEG),
    ),
    ("head", "left_lower_leg", "right_lower_leg"),
    held_out=True,
)
