"""Palmar and plantar grasp: pressure bends fingers and toes; a pull at the fingers tightens the grip."""

from mimoc.policies.reflexes.reflex import AgeWindow, Drives, Reflex, State
from mimoc.policies.reflexes.sensing import SIDES, Sensed

LEAST, FULL = 0.004, 0.02
"""Pressure that is noticed, and that sets off all of the response, as shares of the body's weight: .13 and .65 N for a
newborn of 3.3 kg. Ours: the literature gives none."""
HOLD_S = 0.5  # Time constant in which the grip lets go.
GRIP, TIGHT = 0.6, 0.4  # Drive of the fingers that hold, and what a pull adds.
PULL_RAD_S = 1.0  # Speed of fingers being opened that adds all of it.
TOES = 0.6

PALMAR = {f"{side} {what}": 0.0 for side in SIDES for what in ("grip", "pull")}
PLANTAR = {f"{side} grip": 0.0 for side in SIDES}


def palmar_grasp(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Close the fingers around what presses into the palm."""
    drives, kept = {}, {}
    for side in SIDES:
        held = sensed.clip((sensed.pressure(f"{side} palm") - LEAST) / (FULL - LEAST))
        opening = sensed.speed(f"{side}_fingers") - sensed.speed(f"{side}_mf_knuckle")
        grip = sensed.hold(state[f"{side} grip"], held, HOLD_S)
        pull = sensed.hold(state[f"{side} pull"], held * sensed.clip(opening / PULL_RAD_S), HOLD_S)
        drives[f"{side} finger flexion"] = GRIP * grip + TIGHT * pull
        kept |= {f"{side} grip": grip, f"{side} pull": pull}
    return drives, kept


def plantar_grasp(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Curl the toes over what presses on the ball of the foot."""
    drives, kept = {}, {}
    for side in SIDES:
        pressed = sensed.clip((sensed.pressure(f"{side} ball") - LEAST) / (FULL - LEAST))
        kept[f"{side} grip"] = grip = sensed.hold(state[f"{side} grip"], pressed, HOLD_S)
        drives[f"{side} toe flexion"] = TOES * grip
    return drives, kept


REFLEXES = (
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
)
