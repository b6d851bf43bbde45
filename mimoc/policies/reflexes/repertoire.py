"""The reflexes of infants: what sets each off, what it does, and at which ages there is one.

Ages and responses are those that textbooks give; `source` says which were read in a secondary source, and which are
from memory and still to be checked. No source gives thresholds, gains by age, or how strong responses are: these are
ours, and stand beside what they are of.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from mimoc.base.units import GRAVITY_M_S2
from mimoc.policies.reflexes.sensing import SIDES, Sensed
from mimoc.runtime.worlds import NUMPY


@dataclass(frozen=True, slots=True)
class AgeWindow:
    """The ages of onset and of loss, as the literature gives them: ranges over children, in months.

    No study gives gains by age. The law is ours: with an onset from a to b and a loss from c to d,

        gain(t) = clip((t - a) / (b - a), 0, 1) · clip((d - t) / (d - c / 2), 0, 1),

    so that a reflex rises from the earliest to the latest age of onset, is whole until half of the lower age of loss,
    and is gone at the upper.
    """

    onset_months: tuple[float, float] | None = None  # None: whole at birth.
    loss_months: tuple[float, float] | None = None  # None: it stays.

    def gain(self, age_months: Any) -> Any:
        """Return the gain at an age, or at ages, of NumPy: from 0 to 1."""
        gain = NUMPY.ones_like(age_months, dtype=float)
        if self.onset_months:
            first, last = self.onset_months
            gain = gain * NUMPY.clip((age_months - first) / (last - first), 0.0, 1.0)
        if self.loss_months:
            lower, upper = self.loss_months
            gain = gain * NUMPY.clip((upper - age_months) / (upper - lower / 2), 0.0, 1.0)
        return gain


State = Mapping[str, Any]  # What a reflex remembers of k infants: arrays of shape (k,), by name.
Drives = Mapping[str, Any]
"""How much of each movement (`mimoc.policies.reflexes.binding`) it commands, from 0 to 1, shape (k,)."""


@dataclass(frozen=True, slots=True)
class Reflex:
    """A reflex: when infants have it, what sets it off, and what it does."""

    name: str
    stimulus: str  # What sets it off, in a few words.
    response: str  # What the infant does then, in a few words.
    ages: AgeWindow
    senses: tuple[str, ...]  # The senses that it needs; without one of them, it does nothing.
    source: str
    """Where ages and response are from, and so how far they can be relied on; "memory" is still to be checked."""
    run: Callable[[Sensed, State], tuple[Drives, State]]
    """Returns the drives of a control step and what is remembered, for what is sensed. It does not branch on values: it
    runs on k infants at once, with NumPy or torch."""
    start: Mapping[str, float] = field(default_factory=dict)  # What is remembered when an episode begins.


# Palmar and plantar grasp: pressure bends fingers and toes; a pull at the fingers tightens the grip.

PRESSED_MIN, PRESSED_FULL = 0.004, 0.02
"""Pressure that is noticed, and that sets off all of the response, as shares of the body's weight: .13 and .65 N for a
newborn of 3.3 kg. Ours: the literature gives none."""
GRIP_S = 0.5  # Time constant in which the grip lets go.
GRIP, TIGHT = 0.6, 0.4  # Drive of the fingers that hold, and what a pull adds.
PULL_RAD_S = 1.0  # Speed of fingers being opened that adds all of it.
TOES = 0.6

PALMAR = {f"{side} {what}": 0.0 for side in SIDES for what in ("grip", "pull")}
PLANTAR = {f"{side} grip": 0.0 for side in SIDES}


def palmar_grasp(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Close the fingers around what presses into the palm."""
    drives, kept = {}, {}
    for side in SIDES:
        held = sensed.clip((sensed.pressure(f"{side} palm") - PRESSED_MIN) / (PRESSED_FULL - PRESSED_MIN))
        opening = sensed.speed(f"{side}_fingers") - sensed.speed(f"{side}_mf_knuckle")
        grip = sensed.hold(state[f"{side} grip"], held, GRIP_S)
        pull = sensed.hold(state[f"{side} pull"], held * sensed.clip(opening / PULL_RAD_S), GRIP_S)
        drives[f"{side} finger flexion"] = GRIP * grip + TIGHT * pull
        kept |= {f"{side} grip": grip, f"{side} pull": pull}
    return drives, kept


def plantar_grasp(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Curl the toes over what presses on the ball of the foot."""
    drives, kept = {}, {}
    for side in SIDES:
        pressed = sensed.clip((sensed.pressure(f"{side} ball") - PRESSED_MIN) / (PRESSED_FULL - PRESSED_MIN))
        kept[f"{side} grip"] = grip = sensed.hold(state[f"{side} grip"], pressed, GRIP_S)
        drives[f"{side} toe flexion"] = TOES * grip
    return drives, kept


# Moro reflex: when the head drops back, or all of the body falls, the arms spread and then come back.

DROP_RAD = 0.26  # Drop of the head that sets it off, 15 degrees; the examiner lets it drop by 20 to 30 degrees.
DROP_S = 0.5  # Time constant in which a drop is forgotten: slower turns do nothing.
DROPS, FALLS, FALL_S = 0.9, 0.4, 0.05
"""Specific force, as a share of gravity, below which a head that turns back drops instead of being moved, and below
which all of the body falls; and the time constant in which that is noticed. Ours."""
SPREAD_S, EMBRACE_S = 0.4, 1.5  # Length of the two phases; the literature has .3-.5 s and 1-2 s.
AGAIN_S = 3.0  # Time after which it can be set off again. Ours.
MORO_SPREAD, MORO_EMBRACE = 0.9, 0.4  # Drives of the two phases. Ours.

MORO = {"drop": 0.0, "fall": 0.0, "since": 100.0}


def moro(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Spread the arms, then let them come back and bend.

    The time since the stimulus runs through the phases:

        0 s             .4 s                      1.9 s          3 s
        | arms spread   | arms come back and bend | nothing      | can be set off again
    """
    xp, dt_s = sensed.xp, sensed.step_s
    x, y, z = sensed.head_force_m_s2
    force = (x * x + y * y + z * z) / GRAVITY_M_S2**2
    one = 1.0 + sensed.zero
    keep = sensed.keep(FALL_S)
    turn_back = xp.where(force < DROPS**2, -dt_s * sensed.head_rate_rad_s[1], sensed.zero)
    drop = sensed.keep(DROP_S) * state["drop"] + turn_back
    falls = xp.where(force < FALLS**2, one, sensed.zero)
    fall = keep * state["fall"] + (1.0 - keep) * falls
    is_set_off = ((drop > DROP_RAD) | (fall > 0.8)) & (state["since"] > AGAIN_S)
    since = xp.where(is_set_off, sensed.zero, state["since"] + dt_s)
    spreads = xp.where(since < SPREAD_S, one, sensed.zero)
    comes_back = xp.where((since >= SPREAD_S) & (since < SPREAD_S + EMBRACE_S), one, sensed.zero)
    drives = {}
    for side in SIDES:
        for movement in ("shoulder abduction", "elbow extension", "finger extension"):
            drives[f"{side} {movement}"] = MORO_SPREAD * spreads
        for movement in ("shoulder adduction", "arm forwards", "elbow flexion"):
            drives[f"{side} {movement}"] = MORO_EMBRACE * comes_back
    return drives, {"drop": drop, "fall": fall, "since": since}


# Reflexes of head and neck: the asymmetric tonic neck reflex, and rooting.

LEFT = {"right": -1.0, "left": 1.0}  # Sign of the head's turn towards a side.
TURN_MIN_RAD, TURN_FULL_RAD = 0.35, 0.8
"""Turns of the head at which the tonic reflex begins and is whole: 20 and 45 degrees. Ours."""
ON_S, OFF_S = 4.0, 6.0
"""Mean length of its spells and of the times between: it is there 40 % of the time; the literature has 30-50 %."""
EASE_S = 0.5  # Time constant in which it sets in.
ARM, ABDUCTION, LEG = 0.35, 0.15, 0.2  # Drives of elbow, shoulder and knee. Ours.
TOUCH_MIN, TOUCH_FULL = 0.003, 0.012
"""Force on the cheek that is noticed, and that sets off all of rooting, as shares of the body's weight. Ours."""
USED_TO_S = 5.0  # Time constant in which a lasting touch, such as that of a mattress, is no longer noticed. Ours.
ROOTING_S = 0.7  # Time constant in which the head's turn outlasts the touch.
ROOTED_RAD, ROOM_RAD = 0.7, 0.35
"""Turn at which it stops, 40 degrees, and over which it slackens before; the literature has turns of 20-40 degrees."""
ROOTING = 0.5  # Drive of the neck. Ours.

TONIC_NECK = {"is on": 0.0, "level": 0.0}
ROOTING_START = {f"{side} {what}": 0.0 for side in SIDES for what in ("used to", "touch")}


def tonic_neck(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Supine with the head turned, stretch arm and leg of the side that it faces, and bend the others, now and then."""
    xp, dt_s = sensed.xp, sensed.step_s
    is_on, one = state["is on"], 1.0 + sensed.zero
    stays = sensed.chance >= dt_s / ON_S
    begins = sensed.chance < dt_s / OFF_S
    is_on = xp.where(xp.where(is_on > 0.5, stays, begins), one, sensed.zero)
    level = state["level"] + (1.0 - sensed.keep(EASE_S)) * (is_on - state["level"])
    supine = sensed.clip((sensed.up[0] - 0.4) / 0.4)
    drives = {}
    for side, other in (SIDES, SIDES[::-1]):
        turn = LEFT[side] * sensed.angle("head_swivel")
        faces = level * supine * sensed.clip((turn - TURN_MIN_RAD) / (TURN_FULL_RAD - TURN_MIN_RAD))
        drives[f"{side} elbow extension"] = ARM * faces
        drives[f"{side} shoulder abduction"] = ABDUCTION * faces
        drives[f"{side} knee extension"] = LEG * faces
        drives[f"{other} elbow flexion"] = ARM * faces
        drives[f"{other} knee flexion"] = LEG * faces
    return drives, {"is on": is_on, "level": level}


def rooting(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Turn the head towards what touches the cheek; not to what has long touched it."""
    drives, kept = {}, {}
    for side in SIDES:
        force = sensed.pressure(f"{side} cheek")
        used = state[f"{side} used to"]
        used = used + (1.0 - sensed.keep(USED_TO_S)) * (force - used)
        touched = sensed.clip((force - used - TOUCH_MIN) / (TOUCH_FULL - TOUCH_MIN))
        touch = sensed.hold(state[f"{side} touch"], touched, ROOTING_S)
        room = sensed.clip((ROOTED_RAD - LEFT[side] * sensed.angle("head_swivel")) / ROOM_RAD)
        drives[f"head turn {side}"] = ROOTING * touch * room
        kept |= {f"{side} used to": used, f"{side} touch": touch}
    return drives, kept


# Reflexes of the legs of an infant that is held upright: stepping and placing.

UPRIGHT_MIN, UPRIGHT_FULL = 0.6, 0.8
"""Upward part of the trunk's axis from which on an infant is upright, and wholly so. Ours."""
SOLE_MIN, SOLE_FULL = 0.005, 0.03
"""Force on both soles that is noticed, and that makes steps fastest, as shares of the body's weight. Ours."""
SETTLE_S = 0.5  # Time constant in which stepping sets in.
SLOWEST, FASTEST = 5.0, 20.0  # Steps in a minute; the literature has 5-20 in newborns.
LIFT_FROM, LIFT_FULL = 0.3, 0.8
"""Sine of the rhythm at which a leg begins to lift, and lifts fully: a leg lifts for two fifths of its cycle. Ours."""
LIFT, BEND, TOES_UP, SUPPORT = 0.8, 0.6, 0.3, 0.3
"""Drives of hip, knee and foot of the leg that lifts, and of hip and knee of the other. Ours."""
EDGE = 0.006
"""Force on the back of the foot, less that on its sole, that sets off placing, as a share of the weight. Ours."""
PLACE_S, DOWN_S, PLACED_S = 0.7, 1.4, 2.0
"""Times since then at which the leg has been lifted, is put down, and can be placed again. Ours."""

STEPPING = {"stimulus": 0.0, "phase": 0.0}
PLACING = {f"{side} since": 100.0 for side in SIDES}


def stepping(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Lift one leg after the other.

    The rhythm is that of two half-centres in antiphase: with the phase p, which advances while the stimulus lasts, the
    right leg lifts around sin p = 1 and the left one around sin p = -1.
    """
    soles = sensed.pressure("right sole") + sensed.pressure("left sole")
    wanted = upright(sensed) * sensed.clip((soles - SOLE_MIN) / (SOLE_FULL - SOLE_MIN))
    stimulus = state["stimulus"] + (1.0 - sensed.keep(SETTLE_S)) * (wanted - state["stimulus"])
    steps_per_min = sensed.clip(stimulus / 0.2) * SLOWEST + (FASTEST - SLOWEST) * stimulus
    phase = state["phase"] + math.pi * sensed.step_s * steps_per_min / 60.0
    wave, drives = sensed.xp.sin(phase), {}
    for side, other, sign in (("right", "left", 1.0), ("left", "right", -1.0)):
        lifts = sensed.clip(stimulus / 0.2) * sensed.clip((sign * wave - LIFT_FROM) / (LIFT_FULL - LIFT_FROM))
        drives |= {f"{side} hip flexion": LIFT * lifts, f"{side} knee flexion": BEND * lifts}
        drives[f"{side} foot dorsiflexion"] = TOES_UP * lifts
        drives |= {f"{other} hip extension": SUPPORT * lifts, f"{other} knee extension": SUPPORT * lifts}
    return drives, {"stimulus": stimulus, "phase": phase}


def placing(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Lift a foot whose back touches an edge, and put it down on top."""
    xp, drives, kept = sensed.xp, {}, {}
    is_upright = upright(sensed) > 0.5
    for side in SIDES:
        since = state[f"{side} since"]
        edge = sensed.pressure(f"{side} foot back") - sensed.pressure(f"{side} sole")
        is_set_off = is_upright & (edge > EDGE) & (since > PLACED_S)
        kept[f"{side} since"] = since = xp.where(is_set_off, sensed.zero, since + sensed.step_s)
        lifts = xp.where(since < PLACE_S, 1.0 + sensed.zero, sensed.zero)
        is_put_down = xp.where((since >= PLACE_S) & (since < DOWN_S), 1.0 + sensed.zero, sensed.zero)
        drives |= {f"{side} hip flexion": LIFT * lifts, f"{side} knee flexion": BEND * lifts}
        drives[f"{side} foot dorsiflexion"] = TOES_UP * lifts
        drives[f"{side} knee extension"] = SUPPORT * is_put_down
    return drives, kept


def upright(sensed: Sensed):
    """Return how upright infants are, from 0 to 1."""
    return sensed.clip((sensed.up[2] - UPRIGHT_MIN) / (UPRIGHT_FULL - UPRIGHT_MIN))


# Protective extension: an infant that tips over stretches its arms towards the floor.

TIPPED = math.sin(math.radians(20))  # Tilt of the trunk from which on it acts, as the sine. Ours.
RATE_RAD_S = 0.7  # Speed of tipping over from which on it acts, 40 degrees a second. Ours.
POSTURE = 0.6  # Upward part of the trunk's axis over the last second: an infant that lies does not tip over.
STRETCHED_S = 1.0  # How long the arms stay stretched. Ours.
STRETCH, REACH, SPREAD, BEHIND = 0.9, 0.8, 0.5, 0.1
"""Drives of elbows and fingers, of shoulders towards the floor, and of what else the shoulders do: beside, and behind
the body, where little lifts the arms above the head. Ours."""

ONE, BOTH = {"since": 100.0}, {f"{side} since": 100.0 for side in SIDES}


def _arm(side: str, stretches, reach: str, other: str, spread: float) -> Drives:
    """Return the drives of one arm: the way that it reaches, another movement of the shoulder, and straight."""
    return {
        f"{side} {reach}": REACH * stretches,
        f"{side} {other}": spread * stretches,
        f"{side} elbow extension": STRETCH * stretches,
        f"{side} finger extension": STRETCH * stretches,
    }


def _since(sensed: Sensed, former, down, rate):
    """Return the time since an infant began to tip over one way, and how much that stretches the arms."""
    is_set_off = (down > TIPPED) & (rate > RATE_RAD_S) & (sensed.posture > POSTURE)
    since = sensed.xp.where(is_set_off, sensed.zero, former + sensed.step_s)
    return since, sensed.xp.where(since < STRETCHED_S, 1.0 + sensed.zero, sensed.zero)


def _fore_and_aft(sign: float, reach: str, spread: float, sensed: Sensed, state: State) -> tuple[Drives, State]:
    since, stretches = _since(sensed, state["since"], -sign * sensed.up[0], sign * sensed.rate_rad_s[1])
    drives: dict = {}
    for side in SIDES:
        drives |= _arm(side, stretches, reach, "shoulder abduction", spread)
    return drives, {"since": since}


forwards = partial(_fore_and_aft, 1.0, "arm forwards", SPREAD)  # Stretch both arms forwards when tipping forwards.
backwards = partial(_fore_and_aft, -1.0, "arm backwards", BEHIND)  # Stretch both arms backwards when tipping backwards.


def sideways(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Stretch the arm of the side that the infant tips over to."""
    drives, kept = {}, {}
    for side, left in (("right", -1.0), ("left", 1.0)):
        down, rate = -left * sensed.up[1], -left * sensed.rate_rad_s[0]
        kept[f"{side} since"], stretches = _since(sensed, state[f"{side} since"], down, rate)
        drives |= _arm(side, stretches, "shoulder abduction", "arm forwards", SPREAD)
    return drives, kept


_ALL = (
    Reflex(
        "palmar_grasp",
        "pressure in the palm",
        "fingers close, and tighten when they are pulled",
        AgeWindow(loss_months=(3, 6)),
        ("touch",),
        "secondary sources: 3-4, and 4-6 months",
        palmar_grasp,
        PALMAR,
    ),
    Reflex(
        "plantar_grasp",
        "pressure on the ball of the foot",
        "toes curl",
        AgeWindow(loss_months=(6, 12)),
        ("touch",),
        "secondary sources",
        plantar_grasp,
        PLANTAR,
    ),
    Reflex(
        "moro",
        "the head drops back, or all of the body falls",
        "arms spread, elbows and fingers straighten (.3-.5 s), then arms come back and bend (1-2 s)",
        AgeWindow(loss_months=(4, 6)),
        ("vestibular",),
        "secondary sources; times from memory",
        moro,
        MORO,
    ),
    Reflex(
        "tonic_neck",
        "supine, the head turned to a side (asymmetric tonic neck reflex)",
        "arm and leg of the face's side straighten, the others bend, 40 % of the time",
        AgeWindow(onset_months=(-1, 1), loss_months=(4, 7)),
        ("proprioception", "vestibular"),
        "secondary sources; share of time, and that it is strongest at 1-3 months, from memory",
        tonic_neck,
        TONIC_NECK,
    ),
    Reflex(
        "rooting",
        "touch at the cheek",
        "the head turns there, by 20-40 degrees",
        AgeWindow(loss_months=(3, 4)),
        ("touch",),
        "secondary sources",
        rooting,
        ROOTING_START,
    ),
    Reflex(
        "stepping",
        "held upright, soles on a surface",
        "legs lift in turn, 5-20 steps a minute",
        AgeWindow(loss_months=(2, 4)),
        ("touch", "vestibular"),
        "secondary sources; steps a minute from memory",
        stepping,
        STEPPING,
    ),
    Reflex(
        "placing",
        "held upright, the back of a foot touches an edge",
        "hip and knee bend, and the foot is put down on top",
        AgeWindow(loss_months=(2, 4)),
        ("touch", "vestibular"),
        "secondary sources; ages vary",
        placing,
        PLACING,
    ),
    Reflex(
        "protective_forwards",
        "tipping forwards from sitting",
        "arms stretch forwards, fingers open",
        AgeWindow(onset_months=(6, 9)),
        ("vestibular",),
        "memory; secondary sources say 4-6 months",
        forwards,
        ONE,
    ),
    Reflex(
        "protective_sideways",
        "tipping to a side from sitting",
        "the arm of that side stretches, fingers open",
        AgeWindow(onset_months=(6, 7)),
        ("vestibular",),
        "memory",
        sideways,
        BOTH,
    ),
    Reflex(
        "protective_backwards",
        "tipping backwards from sitting",
        "arms stretch backwards, fingers open",
        AgeWindow(onset_months=(8, 10)),
        ("vestibular",),
        "memory",
        backwards,
        ONE,
    ),
)
REFLEXES: Mapping[str, Reflex] = {reflex.name: reflex for reflex in _ALL}
