"""Grip: with how much force a rod can be pulled at before it slips out of a hand that is closed with all strength.

The rod is put where fingers that are half closed have room for it. It keeps the direction of the axis about which the
knuckles bend, and moves freely in all three.
"""

import copy
from collections.abc import Iterator
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.bundle.model import in_subtrees
from mimoc.compiler.measuring import infant_files
from mimoc.runtime.sense import FloatArray
from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.trial import TrialInfant, in_trial
from mimoc.studies.movement.trial import MovementTrial, Subject, Values, has_joint, run

HAND, ROD = "left_hand", "rod"
KNUCKLES = {"left_fingers": 0.72, "left_mf_knuckle": 0.5}
"""The hinge at the knuckles, in mittens and in hands with five fingers (that of the middle finger), and the share of
its range by which the hand is closed when the rod is put between fingers and palm."""
WRIST = ("left_hand1", "left_hand2", "left_hand3")
NOT_CLOSING = ("_side", "_meta", "_adduction", "_pivot")
"""Joints of fingers and thumb that neither bend them nor put the thumb before the palm."""
STRAIGHT = ("_th_middle", "_th_distal")
"""Joints that are straight when the rod is put in: a thumb that is half bent would be in its way."""
RADIUS = 0.14
"""Radius of the rod by the length of a straight finger: .5 cm at birth, half of the 19 mm of the bar that newborns have
hung by; a mitten's one finger does not get around more."""
ROD_HALF_M, ROD_KG, ROD_DAMPING = 0.03, 0.1, 0.5  # Half length, mass, and damping of its movements in [N s/m].
ROD_FRICTION = (1.0, 0.005, 0.0002)
CLEAR_M, FAR_M = 0.0003, 0.01
GRID = 41  # Places that are tried for the rod along each side of a square.
HAND_ABOVE_M = 1.0


@dataclass(frozen=True)
class Hand:
    """A left hand with bent fingers; unit vectors of the world, shape (3,) each."""

    closing_rad: dict[str, float]
    """Hinges that bend fingers and thumb, and the one that puts the thumb before the palm, without `robot:`, and the
    angle of each at the closed end of its range."""
    knuckle_m: FloatArray
    axis: FloatArray  # About which the knuckles bend.
    to_wrist: FloatArray  # From the knuckles along the palm.
    to_fingers: FloatArray  # From the knuckles to the middle of the bent fingers.
    length_m: float  # Length of a straight finger from the knuckle.
    closed_deg: dict[str, float]  # Angles of these hinges when the rod is put in.

    @property
    def out_of_palm(self) -> FloatArray:
        """Across the palm, to the side that the fingers bend to."""
        return _unit(self.to_fingers - self.to_wrist * (self.to_fingers @ self.to_wrist))

    @property
    def into_gap(self) -> FloatArray:
        """Half way between palm and fingers, where the bent hand is open."""
        return _unit(self.to_fingers + self.to_wrist)


def hand_of(infant: TrialInfant) -> Hand:
    """Return the left hand of an infant, its fingers bent as far as they are when the rod is put in."""
    model = infant.model
    knuckle = next(name for name in KNUCKLES if has_joint(infant, name))
    hand = in_subtrees(model, [model.body(HAND).id])
    closing_rad = dict[str, float]()
    for joint, name in zip(infant.joints, infant.joint_names, strict=True):
        if hand[model.jnt_bodyid[joint]] and name not in WRIST and not name.endswith(NOT_CLOSING):
            low, high = model.joint(f"robot:{name}").range
            closing_rad[name] = float(low if -low > high else high)
    straight = infant.placed(0.0, {}, HAND_ABOVE_M)
    hinge = model.joint(f"robot:{knuckle}").id
    palm = np.flatnonzero(model.geom_bodyid == model.body(HAND).id)
    fingers = np.flatnonzero(in_subtrees(model, [int(model.jnt_bodyid[hinge])])[model.geom_bodyid])
    tips_m = [np.linalg.norm(straight.geom_xpos[geom] - straight.xanchor[hinge]) for geom in fingers]
    outermost = fingers[int(np.argmax(tips_m))]
    length_m = float(max(tips_m) + model.geom_size[outermost, 0])
    closed = {
        name: 0.0 if name.endswith(STRAIGHT) else float(np.degrees(KNUCKLES[knuckle] * end_rad))
        for name, end_rad in closing_rad.items()
    }
    data = infant.placed(0.0, closed, HAND_ABOVE_M)
    anchor, axis = data.xanchor[hinge].copy(), data.xaxis[hinge].copy()
    ways_m = (data.geom_xpos[geoms[0]] - anchor for geoms in (palm, fingers))
    to_wrist, to_fingers = (_unit(way_m - axis * (way_m @ axis)) for way_m in ways_m)
    return Hand(closing_rad, anchor, axis, to_wrist, to_fingers, length_m, closed)


def with_rod(spec: InfantSpec, hand: Hand) -> TrialInfant:
    """Return the infant of a spec with a rod in its world, the places of which are the last three of `qpos`."""
    files = infant_files(spec)
    assets = {name: content for name, content in files.items() if name.startswith("assets/")}
    scene = mujoco.MjSpec.from_string(files["scene.xml"].decode(), include=dict(files), assets=assets)
    for key in list(scene.keys):
        scene.delete(key)
    rod = scene.worldbody.add_body(name=ROD, quat=_turned_to(hand.axis))
    for number, name in enumerate("xyz"):
        turned, back = np.zeros(3), np.zeros(4)
        mujoco.mju_negQuat(back, np.array(_turned_to(hand.axis)))
        mujoco.mju_rotVecQuat(turned, np.eye(3)[number], back)
        axis = turned.tolist()
        slide = mujoco.mjtJoint.mjJNT_SLIDE
        rod.add_joint(name=f"{ROD}_{name}", type=slide, axis=axis, damping=ROD_DAMPING)
    size = [RADIUS * hand.length_m, ROD_HALF_M, 0.0]
    capsule = mujoco.mjtGeom.mjGEOM_CAPSULE
    rod.add_geom(name=ROD, type=capsule, size=size, mass=ROD_KG, friction=list(ROD_FRICTION), condim=4)
    return in_trial(scene.compile(), spec)


def gripping(infant: TrialInfant, hand: Hand) -> mujoco.MjData | None:
    """Return an infant with the rod between its fingers and palm; None if it does not go there.

    Of places on a grid across the knuckles, inside the bend of the fingers, it is the one nearest to the knuckles where
    the rod touches no part of the hand.
    """
    model = infant.model
    data = infant.placed(0.0, hand.closed_deg, HAND_ABOVE_M)
    parts = np.flatnonzero(in_subtrees(model, [model.body(HAND).id])[model.geom_bodyid])
    for place in sorted(_places(hand), key=lambda place: float(np.linalg.norm(place - hand.knuckle_m))):
        data.qpos[-3:] = place
        mujoco.mj_kinematics(model, data)
        if all(
            float(mujoco.mj_geomDistance(model, data, model.geom(ROD).id, int(geom), FAR_M, None)) >= CLEAR_M
            for geom in parts
        ):
            mujoco.mj_forward(model, data)
            return data
    return None


def _places(hand: Hand) -> Iterator[FloatArray]:
    for along in np.linspace(0.0, 1.0, GRID):
        for out in np.linspace(2 * RADIUS, 1.0, GRID):  # Nearer, it would be in the palm.
            offset = along * hand.to_wrist + out * hand.out_of_palm
            if offset @ hand.to_fingers > 0:
                yield hand.knuckle_m + hand.length_m * offset


def _unit(vector: FloatArray) -> FloatArray:
    return vector / np.linalg.norm(vector)


def _turned_to(axis: FloatArray) -> list[float]:
    """Return the quaternion that turns z to an axis."""
    quat = np.array([1.0 + axis[2], -axis[1], axis[0], 0.0])
    length = float(np.linalg.norm(quat))
    return (quat / length).tolist() if length > 1e-6 else [0.0, 1.0, 0.0, 0.0]


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
    run(infant, data, seconds, {name: float(np.sign(end_rad)) for name, end_rad in hand.closing_rad.items()})


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
