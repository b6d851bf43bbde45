"""Priorities: of many wishes, each is fulfilled as far as those before it leave it free."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.senses.sense import FloatArray

RANK = 1e-4
"""Singular values below this share of a task's size count as none: what is before it leaves so little of them free."""
DAMPING = 0.01
"""Of inverses, by the task's size (λ)."""
SINGULAR = 0.1
"""Share of a task's size below which a singular value is near none, and damped more."""
SINGULAR_DAMPING = 0.3
"""What the damping grows to there: a straight arm then rests instead of flailing at what it cannot reach."""
_TINY = 1e-30
_STRIP = 2**17
"""Products that a matrix multiplication may have before BLAS hands it to several threads; waking those takes longer."""


@dataclass(frozen=True, slots=True)
class Wish:
    """Accelerations that are wanted of n shares of torque, all at one priority."""

    response: FloatArray
    """What each share of torque does to each acceleration, shape (m, n)."""
    accelerations: FloatArray
    """What is wanted beyond what happens without torques, shape (m,)."""

    @property
    def size(self) -> float:
        """How large the response is: what singular values are large or small against."""
        return size_of(self.response)


def size_of(matrix: FloatArray) -> float:
    """Return the root of the sum of squares of a matrix."""
    return math.sqrt(np.vdot(matrix, matrix))


def joined(wishes: Sequence[Wish]) -> Wish:
    """Return one wish of several, each by its own size: metres and radians then count alike."""
    if len(wishes) == 1:
        return wishes[0]
    sizes = [max(wish.size, _TINY) for wish in wishes]
    return Wish(
        np.concatenate([wish.response / size for wish, size in zip(wishes, sizes, strict=True)]),
        np.concatenate([wish.accelerations / size for wish, size in zip(wishes, sizes, strict=True)]),
    )


def fulfil(wishes: Sequence[Wish], rest: Wish) -> FloatArray:
    """Return the shares of torque, shape (n,), that fulfil some wishes in the order of their priority.

    With A_k the response and N_k the shares of torque that are still free after k wishes,
    u_k = u_(k-1) + (A_k N_(k-1))^# (a_k - A_k u_(k-1)), where ^# is a damped inverse. N_k is not damped, so that no
    wish disturbs one before it, whatever the damping.

    Args:
        wishes: The most important first.
        rest: What is done with all that they leave free; its response is of the size of 1.
    """
    count = rest.response.shape[1]
    shares, taken = np.zeros(count), np.zeros((0, count))
    for wish in wishes:
        values, left, right = _singular_values(_without(taken, wish.response), size := wish.size)
        missing = wish.accelerations - wish.response @ shares
        shares = shares + (damped_inverse(values, size) * (missing @ left)) @ right
        taken = np.concatenate([taken, right])
    return shares + _rest(rest, shares, taken)


def damped_inverse(values: FloatArray, size: float) -> FloatArray:
    """Return s / (s² + λ²) of singular values s; λ grows near singularities, so that it stays bounded.

    Args:
        values: Shape (k,), above zero.
        size: Of the task by itself, the largest that they can be.
    """
    nearness = np.maximum(1.0 - values / (SINGULAR * size), 0.0)
    return values / (values**2 + size**2 * (DAMPING**2 + (SINGULAR_DAMPING * nearness) ** 2))


def product(left: FloatArray, right: FloatArray) -> FloatArray:
    """Return left rightᵀ of two matrices, shapes (m, k) and (n, k), strip by strip."""
    height = max(1, _STRIP // max(1, right.size))
    if len(left) <= height:
        return left @ right.T
    return np.concatenate([left[top : top + height] @ right.T for top in range(0, len(left), height)])


def _singular_values(response: FloatArray, size: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the k singular values of a response that are not next to none, shape (k,), and their vectors.

    They come from the eigenvalues of its product with itself, which for few rows takes a third of the time.

    Returns:
        The values, the left vectors, shape (m, k), and the right ones, shape (k, n).
    """
    squares, left = np.linalg.eigh(response @ response.T)
    kept = squares > max((RANK * size) ** 2, _TINY)
    values, left = np.sqrt(squares[kept]), left[:, kept]
    return values, left, (left / values).T @ response


def _rest(wish: Wish, shares: FloatArray, taken: FloatArray) -> FloatArray:
    """Return the shares of torque of the last wish, shape (n,), after which nothing need be free."""
    free = _without(taken, wish.response)
    gram = product(free, free)
    gram.flat[:: len(gram) + 1] += DAMPING**2
    change = np.linalg.solve(gram, wish.accelerations - wish.response @ shares) @ free
    return change - (taken @ change) @ taken


def _without(taken: FloatArray, response: FloatArray) -> FloatArray:
    """Return the part of a response that makes no use of what is taken, rows of which are orthonormal."""
    return response - (response @ taken.T) @ taken if len(taken) else response
