"""Bursts of k infants, in a fixed number of slots for each limb."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from mimoc.runtime.term import Put

SLOTS = 5
"""Bursts of a limb at one time; one more takes the place of the oldest."""


class Bursts:
    """The bursts that are under way.

    A burst asks hinge j for the share p_j s(t) of its strength, where

        s(t) = sin²(π t / T)        for 0 <= t < T
             = -r sin²(π t / T)     for T <= t < 2 T
             = 0                    afterwards

    t is the time since it began, T its duration, and r its rebound. The slots of a limb are taken in turn:

        slot     0      1      2      3      4
        t / T   2.3    0.2     -      -     3.1      the next burst of this limb goes into slot 2
    """

    def __init__(self, xp: Any, put: Put, limb: Any, of_limbs: Any, of_hinges: Any):
        """Begin with none; *limb* is that of each hinge, (m,); of limbs and hinges are zeros, (k, limbs), (k, m)."""
        self._xp, self._limb = xp, limb
        self._slots = put(np.arange(SLOTS, dtype=np.float64)[None, :, None])
        self._next = of_limbs
        self._length_s = of_limbs[:, None, :] + 0.0 * self._slots + 1.0
        self._time_s = 10.0 * self._length_s
        self._pattern = of_hinges[:, None, :] + 0.0 * self._slots

    def advance(self, step_s: float, begins: Any, lengths_s: Any, patterns: Any) -> None:
        """Let time pass, and bursts of given lengths and patterns of shares, (k, m), begin in limbs, (k, limbs)."""
        xp = self._xp
        is_new = begins[:, None, :] & (xp.abs(self._slots - self._next[:, None, :]) < 0.5)
        self._time_s = xp.where(is_new, 0.0, self._time_s + step_s)
        self._length_s = xp.where(is_new, lengths_s[:, None, :], self._length_s)
        self._pattern = xp.where(xp.take(is_new, self._limb, axis=2), patterns[:, None, :], self._pattern)
        following = xp.where(self._next > SLOTS - 1.5, 0.0, self._next + 1.0)
        self._next = xp.where(begins, following, self._next)

    def shares(self, rebound: Any) -> Any:
        """Return what all of them ask for now, shape (k, m); *rebound* has shape (k, 1)."""
        xp = self._xp
        part = self._time_s / self._length_s
        wave = xp.sin(math.pi * part) ** 2
        first = xp.where(part < 1.0, wave, 0.0)
        second = xp.where((part >= 1.0) & (part < 2.0), wave, 0.0)
        shape = first - rebound[:, :, None] * second
        return xp.sum(self._pattern * xp.take(shape, self._limb, axis=2), axis=1)


def probabilities(xp: Any, law: Mapping[str, Any], rate_hz: Any, swell: Any, arousal: Any, activity: Any) -> Any:
    """Return the rates at which bursts begin now, [1/s]: in all limbs, in a pair, and in each limb by itself.

    With the arousal a and the activity x of a limb, both of variance 1, the rate is λ exp(s a - s²/2) of all, and that
    times exp(l x - l²/2) of each limb by itself, with the swells s and l, so that λ is their mean over time.
    """
    common = rate_hz * xp.exp(swell * arousal - swell**2 / 2)
    alone = common * xp.exp(law["limb_swell"] * activity - law["limb_swell"] ** 2 / 2)
    alone = alone * (1.0 - law["together"] - law["whole"])
    return common * law["whole"], common * law["together"], alone
