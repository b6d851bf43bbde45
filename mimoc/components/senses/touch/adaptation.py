"""How touch receptors adapt: what slowly and rapidly adapting ones make of a force on the skin over time.

With the pressure F at a point, the lag L_T of time constant T, and the rate of F where it rises:

    sa1 = max(F + 2 D - .3 L_3s(F), 0)        D = .15 s L_.15s(max(dF/dt, 0))      slowly adapting (Merkel)
    ra  = |F - L_53ms(F)|                     F above 3 Hz                         rapidly adapting (Meissner)
    pc  = F where there was none before, else 0                                    onsets (Pacini)
    ct  = exp(-(log10(v / 3 cm/s) / .42)² / 2), where F > 0                        slow stroking

A step of F gives sa1 three times F at first, F after half a second, and .7 F in the end. All are derived (D) from what
is known of adults' fingertips (Johansson & Vallbo 1979 and Bolanowski 1988, from memory): no infant was measured.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import mujoco
import numpy as np

from mimoc.base.geometry.rotations import cross
from mimoc.components.senses.touch import Channel
from mimoc.components.senses.touch.receptors import ContactForces
from mimoc.runtime.filter import INSTANT_S, Filter, held
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.runtime.worlds import NUMPY

RISE_S, SLOW_S = 0.15, 3.0
"""Time constants of the response of slowly adapting receptors to a rising force, and of their slow loss."""
OVERSHOOT, LOSS = 2.0, 0.3  # Its share at the onset beside the force itself, and what is lost in the end.
RAPID_HZ = 3.0  # Frequency above which rapidly adapting receptors respond.
RAPID_S = 1 / (2 * math.pi * RAPID_HZ)
STROKED_M_S, DECADES = 0.03, 1 / (2 * math.sqrt(2 * math.log(2)))
"""Speed of stroking that is felt most, and the standard deviation of its logarithm: half as much a half decade away."""
SLOWEST_M_S = 1e-6  # Speed below which nothing strokes.
STATES = 4  # Numbers of state of each point.
FORGOTTEN_N, FORGOTTEN_S = 1e-6, 1e3  # A force of which nothing more is remembered, and a time after which nothing is.


def stroking(speed_m_s: FloatArray) -> FloatArray:
    """Return the response to stroking at some speeds, from 0 to 1."""
    decades = np.log10(np.maximum(speed_m_s, SLOWEST_M_S) / STROKED_M_S)
    return np.exp(-0.5 * (decades / DECADES) ** 2)


@dataclass(frozen=True)
class Adapting(Filter):
    """The c channels of n points, one channel after the other: from pressures, or these and what of them strokes."""

    time_constants_s: FloatArray  # Time constants of the slow loss and of rapid adaptation, shape (2,).
    rise_s: FloatArray  # Time constant of the response to a rising force, shape (1,).
    channels: tuple[Channel, ...]
    width: int  # Numbers of each point in a sample: its pressure, and with `ct` also what of it is stroking.

    def size(self, count: int) -> int:
        """Return how many numbers of state there are: slow lag, fast lag, rise and pressure of all points."""
        return STATES * count // self.width

    def __call__(self, xp: Any, elapsed_s: float, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the channels, shape (k, c n), and the state; see `Filter`."""
        rows, points = sample.shape[0], sample.shape[1] // self.width
        numbers = sample[:, None, :]
        if self.width > 1:
            numbers = xp.permute_dims(xp.reshape(sample, (rows, points, self.width)), (0, 2, 1))
        if state is None:  # What presses when an episode begins has done so for long.
            force = numbers[:, :1, :]
            kept = xp.concat([force, force, xp.zeros_like(force), force], axis=1)
        else:
            kept = xp.reshape(state, (rows, STATES, points))
        of_points = self._of_touched if xp is NUMPY and rows == 1 else partial(self._changed, xp)
        response, kept = of_points(elapsed_s, numbers, kept)
        return xp.reshape(response, (rows, -1)), xp.reshape(kept, (rows, -1))

    def _of_touched(self, elapsed_s: float, numbers: FloatArray, kept: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what `_changed` does, of one infant: only few points are touched, and nothing changes at others."""
        touched = (numbers[0, 0] + kept[0, 0]).nonzero()[0]
        felt, changed = self._changed(NUMPY, elapsed_s, numbers.take(touched, 2), kept.take(touched, 2))
        response, state = (np.zeros((rows, kept.shape[2]), np.float32) for rows in (len(self.channels), STATES))
        response[:, touched], state[:, touched] = felt[0], changed[0]
        return response[None], state[None]  # pyright: ignore[reportReturnType] - 32 bits, as there are many points.

    def _changed(self, xp: Any, elapsed_s: float, numbers: Any, kept: Any) -> tuple[Any, Any]:
        """Return the channels of m points, shape (k, c, m), and their state, shape (k, 4, m)."""
        force = numbers[:, 0, :]
        rise = kept[:, 2, :]
        former = kept[:, 3, :]
        interval_s = min(max(round(elapsed_s, 9), INSTANT_S), FORGOTTEN_S)
        left, gained, ramp, of_rise, risen = self.of_interval(xp, interval_s, self._gains)
        change = force - former
        rise = of_rise * rise + risen * xp.maximum(change, 0.0)
        lags = left * kept[:, :2, :] + gained * former[:, None, :] + ramp * change[:, None, :]
        felt = xp.stack([self._channel(xp, channel, numbers, former, rise, lags) for channel in self.channels], axis=1)
        state = xp.concat([lags, rise[:, None, :], force[:, None, :]], axis=1)
        is_over = (force == 0.0) & (lags[:, 0, :] < FORGOTTEN_N)
        return felt, xp.where(is_over[:, None, :], 0.0, state)

    def _gains(self, xp: Any, interval_s: float) -> tuple[Any, ...]:
        """Return what is left of both lags, what force and its change add to them, and both of the rise."""
        left, ramp = held(xp, interval_s, self.time_constants_s[:, :, None])
        of_rise, _ = held(xp, interval_s, self.rise_s)
        return left, 1.0 - left, ramp, of_rise, (1.0 - of_rise) * (self.rise_s / interval_s)

    def _channel(self, xp: Any, channel: Channel, numbers: Any, former: Any, rise: Any, lags: Any) -> Any:
        force = numbers[:, 0, :]
        if channel == "sa1":
            return xp.maximum(force + OVERSHOOT * rise - LOSS * lags[:, 0, :], 0.0)
        if channel == "ra":
            return xp.abs(force - lags[:, 1, :])
        if channel == "pc":
            return xp.where(former > 0.0, 0.0, force)
        return numbers[:, 1, :] / xp.where(force > 0.0, force, 1.0)


def adapting(channels: tuple[Channel, ...], width: int) -> Adapting:
    """Return the filter of some channels."""
    return Adapting(np.array([SLOW_S, RAPID_S]), np.array([RISE_S]), channels, width)


class Stroking:
    """What of the pressure of contacts is stroking."""

    def __init__(self, model: mujoco.MjModel, hairless: frozenset[int]):
        """Find which skin feels it: not that of the bodies that are hairless."""
        self._body_of_geom = np.append(model.geom_bodyid, 0).astype(np.intp)
        self._roots = model.body_rootid.astype(np.intp)
        self._is_hairy = ~np.isin(np.arange(model.nbody), list(hairless))

    def __call__(self, data: mujoco.MjData, forces: ContactForces, pressures_n: FloatArray) -> FloatArray:
        """Return the pressure of m contacts, and what of it is stroking, shape (m, 2); *pressures_n* has it twice."""
        bodies = self._body_of_geom.take(data.contact.geom.take(forces.contacts, 0))
        normals = data.contact.frame.take(forces.contacts, 0)[:, :3]
        speeds_m_s = sliding_speeds(data, bodies, self._roots, forces.places_m, normals)
        shares = np.where(self._is_hairy.take(forces.bodies), stroking(speeds_m_s), 0.0)
        return pressures_n * np.stack([np.ones_like(shares), shares], axis=1)


def sliding_speeds(
    data: mujoco.MjData, bodies: IntArray, roots: IntArray, places_m: FloatArray, normals: FloatArray
) -> FloatArray:
    """Return how fast both bodies of m contacts slide over each other, shape (m,), [m/s].

    MuJoCo's `cvel` of a body is about the centre of mass of its tree, c: v = v_c + w x (p - c). *roots* are the roots
    of the trees of all bodies of the model; places and normals have shape (m, 3).
    """
    turning, moving = np.split(data.cvel.take(bodies, 0), 2, axis=-1)
    away_m = places_m[:, None] - data.subtree_com.take(roots.take(bodies), 0)
    velocities = moving + cross(turning, away_m)
    relative = velocities[:, 1] - velocities[:, 0]
    across = relative - (relative * normals).sum(axis=1, keepdims=True) * normals
    return np.sqrt((across * across).sum(axis=1))
