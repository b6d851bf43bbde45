"""Filters: what a sense organ makes, over time, of what acts on it, between the sensor and the delay line.

A filter is a term as noise is (`mimoc.noise.noise`), so one definition runs on one infant, on many, and on a device:

    @dataclass(frozen=True)
    class Adapted(Filter):
        time_constant_s: np.ndarray     # Shape (1,)

        def __call__(self, xp, elapsed_s, sample, state):
            if state is None:
                return sample, sample
            left = xp.exp(-elapsed_s / self.time_constant_s)
            usual = left * state + (1 - left) * sample
            return sample - usual, usual

Its state lasts from sample to sample, is in the state of an environment, and is kept when an infant grows. Samples may
be any time apart: a filter knows how long ago the last one was. Those of mimoc are exact for an input that changes
linearly from one sample to the next (a first-order hold), so that they add no delay of their own.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.runtime.term import Term

FloatArray = npt.NDArray[np.float64]

INSTANT_S = 1e-9
"""Least time between samples."""
SLOW_S = 1.0
"""From this time constant on, a lag has seen nothing yet when an episode begins; others have settled."""


@dataclass(frozen=True)
class Filter(Term):
    """A base for filters."""

    def size(self, count: int) -> int:
        """Return how many numbers of state samples of *count* numbers have."""
        return count

    def __call__(self, xp: Any, elapsed_s: float, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the response, shape (k, m), and the state then.

        Args:
            xp: The array library.
            elapsed_s: Time since the state.
            sample: What acts now, shape (k, n); never changed in place.
            state: Shape (k, size(n)), or None at the start of an episode.
        """
        raise NotImplementedError


def held(xp: Any, elapsed_s: float, time_constants_s: Any) -> tuple[Any, Any]:
    """Return a and b of first-order lags after a time.

    With p = t / T, a lag x of an input that goes from u to v is then a x + (1 - a) u + b (v - u), with a = exp(-p) and
    b = 1 - (1 - a) / p.
    """
    past = max(elapsed_s, INSTANT_S) / time_constants_s
    return xp.exp(-past), 1.0 + xp.expm1(-past) / past


@dataclass(frozen=True)
class Lags(Filter):
    """A linear filter of each of n numbers: H(s) = d + Σ w / (1 + T s) over p lags, the partial fractions of H."""

    direct: FloatArray
    """What passes at once, d, shape (n,)."""
    weights: FloatArray
    """w, shape (n, p)."""
    time_constants_s: FloatArray
    """T, shape (p,)."""

    def size(self, count: int) -> int:
        """Return how many numbers of state there are: the lags of each number, and its input; see `Filter`."""
        return count * (self.weights.shape[-1] + 1)

    def __call__(self, xp: Any, elapsed_s: float, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the response, shape (k, n), and the state, number by number; see `Filter`."""
        now, rows = sample[..., None], sample.shape[0]
        times_s = self.time_constants_s[:, None, :]
        if state is None:
            lags = now * xp.where(times_s < SLOW_S, 1.0, 0.0)
        else:
            kept = xp.reshape(state, (rows, sample.shape[1], -1))
            left, ramp = held(xp, elapsed_s, times_s)
            former = kept[..., -1:]
            lags = left * kept[..., :-1] + (1.0 - left) * former + ramp * (now - former)
        response = self.direct * sample + xp.sum(self.weights * lags, axis=-1)
        return response, xp.reshape(xp.concat([lags, now], axis=-1), (rows, -1))


def lags_of(
    count: int, high_passes_s: Sequence[float], leads_s: Sequence[float] = (), lags_s: Sequence[float] = ()
) -> Lags:
    """Return the filter of *count* numbers with H(s) = Π T s / (1 + T s) · Π (1 + L s) / Π (1 + l s).

    Args:
        count: n.
        high_passes_s: Each T.
        leads_s: Each L, as many as there are l.
        lags_s: Each l; all T and l differ.
    """
    poles_s = np.array([*high_passes_s, *lags_s])
    at = -1.0 / poles_s
    numerators = np.prod([at * time_s for time_s in high_passes_s] + [1.0 + at * lead_s for lead_s in leads_s], axis=0)
    others = 1.0 + at[:, None] * poles_s
    np.fill_diagonal(others, 1.0)
    direct = float(np.prod(leads_s) / np.prod(lags_s))
    return Lags(np.full(count, direct), np.tile(numerators / others.prod(axis=1), (count, 1)), poles_s)
