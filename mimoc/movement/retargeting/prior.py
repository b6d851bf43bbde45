"""What is usual of infants' posture and movement: a Gaussian process for each unknown of a fit."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.motion.point_recording import FloatArray
from mimoc.movement.retargeting.skeleton import Hinges


@dataclass(frozen=True, slots=True)
class Usual:
    """Mean, spread and speed of change of an unknown.

    It is a stationary process with the spectrum

    S(w) = 1 / (a (w^2 + w_1^2) (w^2 + w_2^2)),    variance = 1 / (2 a w_1 w_2 (w_1 + w_2)).

    Below w_1 it is flat: postures last about 1 / w_1. Above w_2 it falls with the fourth power: accelerations are
    limited, which is what couples neighbouring frames.
    """

    sd: float  # Its standard deviation over time and infants, in [rad] or [m].
    slow_hz: float = 0.04  # w_1 / 2 pi.
    fast_hz: float = 1.0  # w_2 / 2 pi.


def chain(usual: Sequence[Usual], frames: int, rate_hz: float) -> FloatArray:
    """Return the diagonals of the precision matrix of n such processes, sampled at t frames, shape (3, t, n).

    The process minimises the integral of a (x'')^2 + b (x')^2 + c x^2 with b = a (w_1^2 + w_2^2) and c = a w_1^2 w_2^2;
    with frames of d seconds, and differences in place of derivatives,

        Q = a / d^3 D_2' D_2 + b / d D_1' D_1 + c d.
    """
    first, second = (2 * np.pi * np.array([getattr(item, name) for item in usual]) for name in ("slow_hz", "fast_hz"))
    sd, d = np.array([item.sd for item in usual]), 1 / rate_hz
    a = 1 / (2 * sd**2 * first * second * (first + second))
    result = np.zeros((3, frames, len(usual)))
    result[0] += a * (first * second) ** 2 * d
    for order, weight in ((1, a * (first**2 + second**2) / d), (2, a / d**3)):
        row = np.array({1: [-1.0, 1.0], 2: [1.0, -2.0, 1.0]}[order])
        count = frames - order
        for i in range(order + 1):
            for j in range(i, order + 1):
                if count > 0:
                    result[j - i, i : i + count] += row[i] * row[j] * weight
    return result


def times_chain(matrix: FloatArray, x: FloatArray) -> FloatArray:
    """Return Q x, for Q as `chain` gives it, and x of shape (t, n)."""
    result = matrix[0] * x
    for distance in (1, 2):
        if len(x) > distance:
            couples = matrix[distance, :-distance]
            result[:-distance] += couples * x[distance:]
            result[distance:] += couples * x[:-distance]
    return result


_POSTURE_DEG = {"shoulder_horizontal": 15, "shoulder_ad_ab": 45, "shoulder_rotation": 20, "elbow": -60}
_POSTURE_DEG |= {"hip1": -65, "hip2": -22, "hip3": 20, "knee": -75}
"""Usual angles of an infant who lies awake on its back (D: middle of what fits to the 12 recordings of MINI-RGBD give,
and of the flexed posture of the first months); other hinges rest as in mimoc's supine pose."""
_USUAL = {
    **{f"hip_{name}": Usual(np.radians(5)) for name in ("lean", "rot", "bend")},
    "head": Usual(np.radians(25)),
    "hand": Usual(np.radians(20)),
    "foot": Usual(np.radians(17)),
    "shoulder": Usual(np.radians(35)),
    "elbow": Usual(np.radians(35)),
    "knee": Usual(np.radians(30)),
    "hip1": Usual(np.radians(28)),
    "hip2": Usual(np.radians(17)),
    "hip3": Usual(np.radians(22)),
}
"""Spread by what the name of a hinge contains (D: of movements of simulated infants, and of the fits named above)."""
ROOT_PLACE, ROOT_TURN = Usual(0.2, 0.02, 0.5), Usual(np.radians(20), 0.03, 0.6)  # What is usual of the root.


def usual_of(hinges: Hinges) -> list[Usual]:
    """Return what is usual of each unknown, in their order."""
    limbs = [next(usual for part, usual in _USUAL.items() if part in _plain(name)) for name in hinges.names]
    return [ROOT_PLACE] * 3 + [ROOT_TURN] * 3 + limbs


def posture(model: mujoco.MjModel, hinges: Hinges, rest: FloatArray) -> FloatArray:
    """Return the usual angles of the unknowns within their limits, shape (u,)."""
    low, high = limits(model, hinges)
    angles = np.zeros(len(hinges.names))
    for column, name in enumerate(hinges.names):
        first = int(np.flatnonzero(hinges.column == column)[0])
        resting = rest[model.jnt_qposadr[hinges.ids[first]]] / hinges.factor[first]
        part = _plain(name).partition("_")[2]
        angles[column] = np.radians(_POSTURE_DEG[part]) if part in _POSTURE_DEG else resting
    return np.clip(angles, low, high)


def limits(model: mujoco.MjModel, hinges: Hinges) -> tuple[FloatArray, FloatArray]:
    """Return the least and largest angle of each unknown, shape (u,): the tightest of the hinges that it turns."""
    low = np.full(len(hinges.names), -np.inf)
    high = np.full(len(hinges.names), np.inf)
    for joint, column, factor in zip(hinges.ids, hinges.column, hinges.factor, strict=True):
        if model.jnt_limited[joint]:
            ends = np.sort(model.jnt_range[joint] / factor)
            low[column] = max(low[column], ends[0])
            high[column] = min(high[column], ends[1])
    return low, high


def _plain(name: str) -> str:
    return name.removeprefix("robot:")
