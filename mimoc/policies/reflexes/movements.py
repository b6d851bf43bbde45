"""Movements of joints by their names in anatomy, and the commands that make them, of muscles, motors or servos."""

import re
from collections.abc import Mapping

import numpy as np

from mimoc.policies.batch import Batch
from mimoc.runtime.sense import FloatArray

SIDES = ("right", "left")
FINGERS = "(ff|mf|rf|lf)_(knuckle|middle|distal)|thumb_(middle|distal)"
"""Joints that bend five fingers."""
MOVEMENTS: Mapping[str, tuple[tuple[str, int], ...]] = {
    "shoulder abduction": (("shoulder_abduction", 1),),
    "shoulder adduction": (("shoulder_abduction", -1),),
    "arm forwards": (("shoulder_horizontal", 1),),
    "arm backwards": (("shoulder_horizontal", -1),),
    "elbow extension": (("elbow", 1),),
    "elbow flexion": (("elbow", -1),),
    "finger flexion": (("fingers", -1), (FINGERS, 1)),
    "finger extension": (("fingers", 1), (FINGERS, -1)),
    "hip flexion": (("hip_flex", -1),),
    "hip extension": (("hip_flex", 1),),
    "knee flexion": (("knee", -1),),
    "knee extension": (("knee", 1),),
    "foot dorsiflexion": (("foot_flexion", 1),),
    "toe flexion": (("toes|big_toe", -1),),
}
"""Movements of each side: patterns of actuators without the side, and whether they turn their joint towards positive or
negative angles. Mitten hands bend their one finger towards negative angles, five fingers towards positive ones."""
HEAD: Mapping[str, tuple[tuple[str, int], ...]] = {
    "head turn left": (("head_swivel", 1),),
    "head turn right": (("head_swivel", -1),),
}


def command_rows(batch: Batch) -> dict[str, FloatArray]:
    """Return the commands of each movement, such as `right elbow flexion`, in full strength, shape (n,).

    A muscle pulls one way: it is commanded 1 if that is the way of the movement, else 0. A motor turns with all of its
    torque, a servo goes to the end of the joint's range: 1 or -1.
    """
    infant = batch.infants[0]
    low, commanded = infant.actuation.low, [item for item in infant.manifest.actuation.actuators if item.commanded]
    pulls_nm = infant.actuation.limits_nm
    signs = np.where(low < 0, 0.0, np.where(pulls_nm[:, 1] > -pulls_nm[:, 0], 1.0, -1.0))
    names = [item.mimo_actuator.removeprefix("act:") for item in commanded]
    rows = {name: _row(names, signs, patterns) for name, patterns in HEAD.items()}
    for side in SIDES:
        for name, patterns in MOVEMENTS.items():
            of_side = tuple((f"{side}_({pattern})", sign) for pattern, sign in patterns)
            rows[f"{side} {name}"] = _row(names, signs, of_side)
    return rows


def _row(names: list[str], signs: FloatArray, patterns: tuple[tuple[str, int], ...]) -> FloatArray:
    """Return the commands of actuators; *signs* are the ways that muscles pull, and 0 of motors and servos."""
    row = np.zeros(len(names))
    for pattern, sign in patterns:
        matches = np.array([re.fullmatch(pattern, name) is not None for name in names])
        row = np.where(matches, np.where(signs == 0, float(sign), (signs == sign) * 1.0), row)
    return row
