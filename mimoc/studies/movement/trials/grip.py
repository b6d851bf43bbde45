"""Grip: with how much force a rod can be pulled at before it slips out of a hand that is closed with all strength."""

import copy
from dataclasses import replace

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.runtime.sense import FloatArray
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.movement.drive import Drive
from mimoc.studies.movement.rod import HAND, ROD, Hand, gripping, hand_of, with_rod
from mimoc.studies.movement.trial import MovementTrial, Subject, Values

PULLS_N = (0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 24.0, 28.0)
SQUEEZED_S, PULLED_S = 1.5, 0.8
SQUEEZED_OUT_M, SLIPPED_M = 0.02, 0.012
"""Way of the rod that means that closing has squeezed it out, and that a pull has moved it out."""
DIRECTIONS = {"along": "along the fingers", "slant": "slantwise", "out": "out of the palm", "gap": "into the gap"}


def grip(infant: TrialInfant, hand: Hand) -> dict[str, float]:
    """Return the greatest force, in [N], that a hand withstands in each of some directions; 0 if it holds nothing.

    All of the infant but its fingers is held, and there is no gravity. The directions are across the rod: along the
    fingers if they were straight, as when hanging; out of the palm; half way between these; and into the gap between
    the palm and the bent fingers.
    """
    held = _held(infant)
    start = gripping(held, hand)
    along, out = -hand.to_wrist, hand.out_of_palm
    ways = (along, (along + out) / np.sqrt(2.0), out, hand.into_gap)
    if start is None:
        return dict.fromkeys(DIRECTIONS, 0.0)
    before = start.qpos[-3:].copy()
    _close(held, hand, start, SQUEEZED_S)
    if np.linalg.norm(start.qpos[-3:] - before) >= SQUEEZED_OUT_M:
        return dict.fromkeys(DIRECTIONS, 0.0)
    return {name: _withstands(held, hand, start, way) for name, way in zip(DIRECTIONS, ways, strict=True)}


def _held(infant: TrialInfant) -> TrialInfant:
    model = copy.copy(infant.model)
    model.opt.gravity[:] = 0.0
    loose = replace(infant, model=model)
    names, above = list[str](), {model.body(HAND).id}
    for body in range(model.body(HAND).id + 1, model.nbody):
        if int(model.body_parentid[body]) in above:
            above.add(body)
            names.append(model.body(body).name)
    fingers = set(loose.dofs_of(*names))
    return loose.fixed([dof for dof in range(model.nv - 3) if dof not in fingers])


def _withstands(infant: TrialInfant, hand: Hand, start: mujoco.MjData, way: FloatArray) -> float:
    """Return the greatest of the forces in some direction that does not move the rod out."""
    data = copy.copy(start)
    before, most_n = data.qpos[-3:].copy(), 0.0
    for force_n in PULLS_N:
        data.body(ROD).xfrc_applied[:3] = force_n * way
        _close(infant, hand, data, PULLED_S)
        if np.linalg.norm(data.qpos[-3:] - before) > SLIPPED_M:
            break
        most_n = force_n
    return most_n


def _close(infant: TrialInfant, hand: Hand, data: mujoco.MjData, seconds: float) -> None:
    drive = Drive(infant)
    shares = {name: float(np.sign(end_rad)) for name, end_rad in hand.closing_rad.items()}
    for _ in range(round(seconds / infant.model.opt.timestep)):
        data.ctrl[:] = drive(data, shares)
        mujoco.mj_step(infant.model, data)


def _measure(subject: Subject) -> Values:
    hand = hand_of(subject.infant)
    return {f"grip_{way}_n": force_n for way, force_n in grip(with_rod(subject.spec, hand), hand).items()}


GRIP = MovementTrial(
    "grip",
    "closes a hand around a rod with all strength: the force before it slips out, by direction across the rod",
    _measure,
    (0.0, 1.0, 2.0, 3.0),
    tuple(Quantity(f"grip_{name}_n", f"Grip, {words}", "N") for name, words in DIRECTIONS.items()),
    (HAND,),
    ("left_fingers", "left_mfknuckle"),
    side="left",
)
