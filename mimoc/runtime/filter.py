"""Filters: what a sense organ makes, over time, of what acts on it, between the sensor and the delay line.

A filter is a term as noise is (`mimoc.runtime.noise`), so one definition runs on one infant, on many, and on a
device:

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
be any time apart, which a filter is given. Those of mimoc are exact for an input that changes
linearly from one sample to the next (a first-order hold), so that they add no delay of their own.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.runtime.term import Term

FloatArray = npt.NDArray[np.float64]

INSTANT_S = 1e-9  # Least time between samples.
MAX_INTERVALS = 64  # Between samples, for which filters remember what they do.
SLOW_S = 1.0  # From this time constant on, a lag has seen nothing yet when an episode begins; others have settled.


@dataclass(frozen=True)
class Filter(Term):
    """A base for filters."""

    def size(self, count: int) -> int:
        """Return the size of the state for samples of *count* numbers."""
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

    @cached_property
    def _of_intervals(self) -> dict[float, Any]:
        return {}  # No field, so that infants never share it.

    def of_interval(self, xp: Any, interval_s: float, work_out: Callable[[Any, float], Any]) -> Any:
        """Return `work_out(xp, interval_s)`, which is remembered, as most samples are equally far apart."""
        known = self._of_intervals
        if interval_s not in known:
            if len(known) == MAX_INTERVALS:
                known.clear()
            known[interval_s] = work_out(xp, interval_s)
        return known[interval_s]


def held(xp: Any, elapsed_s: float, time_constants_s: Any) -> tuple[Any, Any]:
    """Return a and b of first-order lags after a time.

    With p = t / T, a lag x of an input that goes from u to v is then a x + (1 - a) u + b (v - u), with a = exp(-p) and
    b = 1 - (1 - a) / p.
    """
    past = max(elapsed_s, INSTANT_S) / time_constants_s
    return xp.exp(-past), 1.0 + xp.expm1(-past) / past


@dataclass(frozen=True)
class Lags(Filter):
    """A linear filter of numbers, H(s) = d + Σ w / (1 + T s) over p lags: the partial fractions of H.

    State and sample, one after the other, become response and state by a matrix that depends on the time between
    samples alone: of few calls of NumPy, as a single infant pays for each.
    """

    direct: FloatArray  # What passes at once, d, shape (1,).
    weights: FloatArray  # w, shape (p,).
    time_constants_s: FloatArray  # T, shape (p,); they differ.
    identity: FloatArray  # The identity matrix of the n numbers of a sample, shape (n, n).
    first: int = 0  # The first number of a sample that is filtered; those before it stay as they are.

    def size(self, count: int) -> int:
        """Return the size of the state: each lag of all numbers, then their inputs."""
        return (count - self.first) * (self.weights.shape[-1] + 1)

    def __call__(self, xp: Any, elapsed_s: float, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the response, shape (k, n), and the lags and inputs; see `Filter`."""
        if state is None:
            return self._begun(xp, sample)
        matrix = self.of_interval(xp, round(elapsed_s, 9), self._matrix)
        count = sample.shape[1]
        changed = xp.matmul(matrix, xp.concat([state, sample], axis=1)[:, :, None])
        return changed[:, :count, 0], changed[:, count:, 0]

    def _begun(self, xp: Any, sample: Any) -> tuple[Any, Any]:
        filtered = sample[:, self.first :]
        has_settled = xp.astype(self.time_constants_s < SLOW_S, self.time_constants_s.dtype)
        gain = self.direct + xp.sum(self.weights * has_settled, axis=1)[:, None]
        lags = xp.reshape(has_settled[:, :, None] * filtered[:, None, :], (sample.shape[0], -1))
        return xp.concat([sample[:, : self.first], gain * filtered], axis=1), xp.concat([lags, filtered], axis=1)

    def _matrix(self, xp: Any, interval_s: float) -> Any:
        """Return the matrix of all numbers of a sample: rows are response and state, columns state and sample."""
        times_s = self.time_constants_s
        lags = self.weights.shape[-1]
        first = self.first
        left, ramp = held(xp, interval_s, times_s)
        of_lags = xp.where(times_s[:, :, None] == times_s[:, None, :], left[:, :, None], 0.0)
        rows = xp.concat([of_lags, (1.0 - left - ramp)[:, :, None], ramp[:, :, None]], axis=2)
        now = xp.concat([xp.zeros_like(rows[:, :1, :-1]), xp.ones_like(rows[:, :1, :1])], axis=2)
        response = xp.sum(self.weights[:, :, None] * rows, axis=1)[:, None, :] + self.direct[:, :, None] * now
        of_one = xp.concat([response, rows, now], axis=1)
        same = self.identity[:, first:, first:]
        side = (lags + 2) * same.shape[1]
        of_all = xp.reshape(of_one[:, :, None, :, None] * same[:, None, :, None, :], (-1, side, side))
        kept = side - same.shape[1]
        kept_zeros = xp.zeros_like(of_all[:, :1, :kept])
        passed = xp.concat([self.identity[:, :first, :1] * kept_zeros, self.identity[:, :first, :]], axis=2)
        nothing = xp.zeros_like(of_all[:, :, :1]) * self.identity[:, :1, :first]
        return xp.concat([passed, xp.concat([of_all[:, :, :kept], nothing, of_all[:, :, kept:]], axis=2)], axis=1)


def lags_of(
    count: int,
    high_passes_s: Sequence[float],
    leads_s: Sequence[float] = (),
    lags_s: Sequence[float] = (),
    first: int = 0,
) -> Lags:
    """Return the filter H(s) = Π T s / (1 + T s) · Π (1 + L s) / Π (1 + l s).

    Args:
        count: Numbers of a sample.
        high_passes_s: Each T.
        leads_s: Each L, as many as there are l.
        lags_s: Each l; all T and l differ.
        first: The first number of a sample that is filtered.
    """
    poles_s = np.array([*high_passes_s, *lags_s])
    at = -1.0 / poles_s
    numerators = np.prod([at * time_s for time_s in high_passes_s] + [1.0 + at * lead_s for lead_s in leads_s], axis=0)
    others = 1.0 + at[:, None] * poles_s
    np.fill_diagonal(others, 1.0)
    direct = float(np.prod(leads_s) / np.prod(lags_s))
    return Lags(np.array([direct]), numerators / others.prod(axis=1), poles_s, np.eye(count), first)
