"""Normal equations of many frames that only neighbours couple, bordered by unknowns that all frames share."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import as_strided
from scipy.linalg import get_lapack_funcs, solve_triangular

from mimoc.motion.point_recording import FloatArray

BoolArray = npt.NDArray[np.bool_]
_PBTRF, _PBTRS = get_lapack_funcs(("pbtrf", "pbtrs"), (np.zeros(1),))


@dataclass
class NormalEquations:
    r"""The linear system of a step: [[A, C], [C', D]] [dx, ds] = -[g, h].

    A has t blocks of n unknowns; blocks of neighbours, one and two frames away, are diagonal, since priors couple each
    unknown with itself only. So all of A lies within 2 n of its diagonal:

        frame    0  1  2  3
            0  [ #  \  \  . ]     #: full block, from observations
            1  [ \  #  \  \ ]     \: diagonal block, from differences in time
            2  [ \  \  #  \ ]
            3  [ .  \  \  # ]
    """

    bands: FloatArray
    """Lower bands of A, shape ((t + 2) n, 2 n + 1): row j, column d is A[j + d, j]. Two frames of an identity matrix
    follow, so that blocks can be read beyond the end."""
    g: FloatArray
    """Gradient by the unknowns of frames, shape (t, n)."""
    border: FloatArray
    """C, shape (t, n, s)."""
    corner: FloatArray
    """D, shape (s, s)."""
    h: FloatArray
    """Gradient by what all frames share, shape (s,)."""

    @classmethod
    def zeros(cls, frames: int, unknowns: int, shared: int) -> "NormalEquations":
        """Return an empty system."""
        bands = np.zeros(((frames + 2) * unknowns, 2 * unknowns + 1))
        bands[frames * unknowns :, 0] = 1.0
        g, border = np.zeros((frames, unknowns)), np.zeros((frames, unknowns, shared))
        return cls(bands, g, border, np.zeros((shared, shared)), np.zeros(shared))

    def add_blocks(self, start: int, blocks: FloatArray) -> None:
        """Add symmetric blocks, shape (f, n, n), to the frames from *start* on."""
        n = self.g.shape[1]
        rows = self.bands.reshape(-1, n, 2 * n + 1)[start : start + len(blocks)]
        for column in range(n):
            rows[:, column, : n - column] += blocks[:, column, column:]

    def add_chain(self, chain: FloatArray) -> None:
        """Add a prior that couples each unknown with itself at neighbouring frames, shape (3, t, n).

        Entry [d, t] is what couples frames t and t + d; those beyond the last frame do not count.
        """
        n = self.g.shape[1]
        rows = self.bands.reshape(-1, n, 2 * n + 1)
        for distance, diagonal in enumerate(chain):
            last = max(0, len(diagonal) - distance)
            rows[:last, :, distance * n] += diagonal[:last]

    def factored(self, damping: float = 0.0) -> "Factored":
        """Return the Cholesky factor of A, which overwrites it, with its diagonal multiplied by 1 + *damping*."""
        self.bands[:, 0] *= 1 + damping
        factor, info = _PBTRF(self.bands.T, lower=1, overwrite_ab=1)
        if info:
            raise np.linalg.LinAlgError(f"the leading minor of order {info} is not positive definite")
        t, n = self.g.shape
        right = np.zeros(((t + 2) * n, 1 + self.border.shape[2]), order="F")
        right[: t * n, 0], right[: t * n, 1:] = self.g.ravel(), self.border.reshape(t * n, -1)
        solved, _ = _PBTRS(factor, right, lower=1, overwrite_b=1)
        solved = solved[: t * n].reshape(t, n, -1)
        return Factored(factor, solved[..., 0], solved[..., 1:], self.border, self.corner, self.h)


@dataclass
class Factored:
    """A factored system: its solution, and the covariance that its inverse is."""

    factor: FloatArray
    """Cholesky factor L of A in LAPACK's lower bands, shape (2 n + 1, (t + 2) n)."""
    inverse_g: FloatArray
    """A^-1 g, shape (t, n)."""
    inverse_border: FloatArray
    """Z = A^-1 C, shape (t, n, s)."""
    border: FloatArray
    corner: FloatArray
    h: FloatArray

    def step(self, free: BoolArray) -> tuple[FloatArray, FloatArray]:
        """Return the steps of frames, shape (t, n), and of what they share, (s,), of which only *free* may change."""
        shared = np.zeros(len(self.h))
        if free.any():
            right = np.einsum("tns,tn->s", self.border, self.inverse_g) - self.h
            shared[free] = np.linalg.solve(self.schur()[np.ix_(free, free)], right[free])
        return -(self.inverse_g + self.inverse_border @ shared), shared

    def schur(self) -> FloatArray:
        """Return S = D - C' A^-1 C, the inverse of the covariance of what frames share, shape (s, s)."""
        return self.corner - np.einsum("tns,tnr->sr", self.border, self.inverse_border)

    def blocks(self) -> Iterator[tuple[int, FloatArray]]:
        """Yield the diagonal blocks of A^-1, shape (n, n), from the last frame to the first.

        With the blocks of L below block t stacked to Y = L[t+1..t+2, t] L[t, t]^-1 and P the inverse's block of the two
        next frames, (Takahashi et al. 1973):

            A^-1[t+1..t+2, t] = -P Y,    A^-1[t, t] = L[t, t]^-T L[t, t]^-1 + Y' P Y
        """
        t, n = self.inverse_g.shape
        width, size = self.factor.shape[0], self.factor.itemsize
        row, column = np.indices((3 * n, n))
        inside = (row >= column) & (row - column < width)
        later = np.zeros((2 * n, 2 * n))
        identity = np.eye(n)
        base = self.factor.T  # Row j, column d is L[j + d, j].
        for frame in range(t - 1, -1, -1):
            start = base[frame * n :]
            strip = as_strided(start, (3 * n, n), (size, (width - 1) * size), writeable=False)
            strip = np.where(inside, strip, 0.0)
            inverse = solve_triangular(strip[:n], identity, lower=True, check_finite=False)
            below = strip[n:] @ inverse
            across = -later @ below
            block = inverse.T @ inverse - below.T @ across
            block = (block + block.T) / 2  # Otherwise errors of rounding double at each frame.
            yield frame, block
            later = np.block([[block, across[:n].T], [across[:n], later[:n, :n]]])
