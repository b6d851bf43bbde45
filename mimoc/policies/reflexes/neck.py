"""Reflexes of head and neck: the asymmetric tonic neck reflex, and rooting."""

from mimoc.policies.reflexes.reflex import AgeWindow, Drives, Reflex, State
from mimoc.policies.reflexes.sensing import SIDES, Sensed

LEFT = {"right": -1.0, "left": 1.0}  # Sign of the head's turn towards a side.
TURN_LEAST_RAD, TURN_FULL_RAD = 0.35, 0.8
"""Turns of the head at which the tonic reflex begins and is whole: 20 and 45 degrees. Ours."""
ON_S, OFF_S = 4.0, 6.0
"""Mean length of its spells and of the times between: it is there 40 % of the time; the literature has 30-50 %."""
EASE_S = 0.5  # Time constant in which it sets in.
ARM, ABDUCTION, LEG = 0.35, 0.15, 0.2  # Drives of elbow, shoulder and knee. Ours.
TOUCH_LEAST, TOUCH_FULL = 0.003, 0.012
"""Force on the cheek that is noticed, and that sets off all of rooting, as shares of the body's weight. Ours."""
USED_TO_S = 5.0  # Time constant in which a lasting touch, such as that of a mattress, is no longer noticed. Ours.
HOLD_S = 0.7  # Time constant in which the head's turn outlasts the touch.
ROOTED_RAD, ROOM_RAD = 0.7, 0.35
"""Turn at which it stops, 40 degrees, and over which it slackens before; the literature has turns of 20-40 degrees."""
ROOTING = 0.5  # Drive of the neck. Ours.

TONIC_NECK = {"is on": 0.0, "level": 0.0}
ROOTING_START = {f"{side} {what}": 0.0 for side in SIDES for what in ("used to", "touch")}


def tonic_neck(sensed: Sensed, state: State) -> tuple[Drives, State]:
    """Supine with the head turned, stretch arm and leg of the side that it faces, and bend the others, now and then."""
    xp, dt_s = sensed.xp, sensed.step_s
    is_on, one = state["is on"], 1.0 + sensed.zero
    stays, begins = sensed.chance >= dt_s / ON_S, sensed.chance < dt_s / OFF_S
    is_on = xp.where(xp.where(is_on > 0.5, stays, begins), one, sensed.zero)
    level = state["level"] + (1.0 - sensed.keep(EASE_S)) * (is_on - state["level"])
    supine = sensed.clip((sensed.up[0] - 0.4) / 0.4)
    drives = {}
    for side, other in (SIDES, SIDES[::-1]):
        turn = LEFT[side] * sensed.angle("head_swivel")
        faces = level * supine * sensed.clip((turn - TURN_LEAST_RAD) / (TURN_FULL_RAD - TURN_LEAST_RAD))
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
        touched = sensed.clip((force - used - TOUCH_LEAST) / (TOUCH_FULL - TOUCH_LEAST))
        touch = sensed.hold(state[f"{side} touch"], touched, HOLD_S)
        room = sensed.clip((ROOTED_RAD - LEFT[side] * sensed.angle("head_swivel")) / ROOM_RAD)
        drives[f"head turn {side}"] = ROOTING * touch * room
        kept |= {f"{side} used to": used, f"{side} touch": touch}
    return drives, kept


REFLEXES = (
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
)
