"""Task priorities: each demand is fulfilled in the null space of those before it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.runtime.sense import FloatArray

RANK = 1e-4
"""Threshold, relative to the size of a demand, below which singular values count as zero, since demands of higher
priority leave almost no freedom in these directions."""
DAMPING = 0.01
"""Damping λ of inverses, relative to the size of the demand."""
SINGULAR = 0.1
"""Threshold, relative to the size of a demand, below which a singular value is damped more strongly."""
SINGULAR_DAMPING = 0.3
"""Damping at singularities: a stretched arm then stays at rest instead of flailing at a target beyond its reach."""
_TINY = 1e-30
_STRIP = 2**17
"""Number of products above which BLAS distributes a multiplication over threads, whose start takes longer than it."""


@dataclass(frozen=True, slots=True)
class LinearDemand:
    """Accelerations demanded at one priority, as a linear function of n torques (fractions of strength)."""

    response: FloatArray
    """Acceleration per unit of each torque, shape (m, n)."""
    accelerations: FloatArray
    """Demanded accelerations less those without torques, shape (m,)."""

    @property
    def size(self) -> float:
        """Frobenius norm of the response, the reference for singular values."""
        return size_of(self.response)


def size_of(matrix: FloatArray) -> float:
    """Return the Frobenius norm of a matrix."""
    return math.sqrt(np.vdot(matrix, matrix))


def joined(demands: Sequence[LinearDemand]) -> LinearDemand:
    """Return one demand of several, each normalised by its size, so that metres and radians are comparable."""
    if len(demands) == 1:
        return demands[0]
    sizes = [max(demand.size, _TINY) for demand in demands]
    return LinearDemand(
        np.concatenate([demand.response / size for demand, size in zip(demands, sizes, strict=True)]),
        np.concatenate([demand.accelerations / size for demand, size in zip(demands, sizes, strict=True)]),
    )


def solve_prioritized(demands: Sequence[LinearDemand], rest: LinearDemand) -> FloatArray:
    """Return the torques, shape (n,), that fulfil demands in order of priority.

    With the response A_k and the null-space projector N_k of the first k demands,
    u_k = u_(k-1) + (A_k N_(k-1))^# (a_k - A_k u_(k-1)), where ^# is a damped inverse. N_k is not damped, so that no
    demand disturbs those before it, regardless of the damping. The last demand is for the remaining freedom, and the
    size of its response is 1.
    """
    count = rest.response.shape[1]
    shares, taken = np.zeros(count), np.zeros((0, count))
    for demand in demands:
        values, left, right = _singular_values(_without(taken, demand.response), size := demand.size)
        missing = demand.accelerations - demand.response @ shares
        shares = shares + (damped_inverse(values, size) * (missing @ left)) @ right
        taken = np.concatenate([taken, right])
    # For the last demand, the null space need not be updated.
    free = _without(taken, rest.response)
    gram = product(free, free)
    gram.flat[:: len(gram) + 1] += DAMPING**2
    change = np.linalg.solve(gram, rest.accelerations - rest.response @ shares) @ free
    return shares + (change - (taken @ change) @ taken)


def damped_inverse(values: FloatArray, size: float) -> FloatArray:
    """Return s / (s² + λ²) of positive singular values s, shape (k,), of which the size of the demand is a bound.

    λ grows near singularities, so that it stays bounded.
    """
    nearness = np.maximum(1.0 - values / (SINGULAR * size), 0.0)
    return values / (values**2 + size**2 * (DAMPING**2 + (SINGULAR_DAMPING * nearness) ** 2))


def product(left: FloatArray, right: FloatArray) -> FloatArray:
    """Return left rightᵀ of two matrices, shapes (m, k) and (n, k), in blocks."""
    height = max(1, _STRIP // max(1, right.size))
    if len(left) <= height:
        return left @ right.T
    return np.concatenate([left[top : top + height] @ right.T for top in range(0, len(left), height)])


def _singular_values(response: FloatArray, size: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the k singular values of a response above the threshold, and their vectors, shapes (m, k) and (k, n).

    They are computed from the eigenvalues of its Gram matrix, which for few rows takes a third of the time.
    """
    squares, left = np.linalg.eigh(response @ response.T)
    kept = squares > max((RANK * size) ** 2, _TINY)
    values, left = np.sqrt(squares[kept]), left[:, kept]
    return values, left, (left / values).T @ response


def _without(taken: FloatArray, response: FloatArray) -> FloatArray:
    """Return the component of a response that is orthogonal to *taken*, whose rows are orthonormal."""
    return response - (response @ taken.T) @ taken if len(taken) else response
