"""Reflexes of the legs of an infant that is held upright: stepping and placing."""

import math

from mimoc.policies.reflexes.reflex import AgeWindow, Drives, Reflex, State
from mimoc.policies.reflexes.sensing import SIDES, Sensed

UPRIGHT_LEAST, UPRIGHT_FULL = 0.6, 0.8
"""Upward part of the trunk's axis from which on an infant is upright, and wholly so. Ours."""
SOLE_LEAST, SOLE_FULL = 0.005, 0.03
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
    wanted = upright(sensed) * sensed.clip((soles - SOLE_LEAST) / (SOLE_FULL - SOLE_LEAST))
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
    return sensed.clip((sensed.up[2] - UPRIGHT_LEAST) / (UPRIGHT_FULL - UPRIGHT_LEAST))


REFLEXES = (
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
)
