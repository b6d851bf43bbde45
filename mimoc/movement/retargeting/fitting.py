"""The fit: robust least squares over all frames at once, by the damped Gauss-Newton method (Levenberg, Marquardt)."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import as_strided
from scipy.linalg import get_lapack_funcs, solve_triangular

from mimoc.motion.point_recording import FloatArray
from mimoc.movement.retargeting.observations import OUTLIER, Channel, Observed
from mimoc.movement.retargeting.prior import times_chain
from mimoc.movement.retargeting.sizes import at_sizes
from mimoc.movement.retargeting.skeleton import ROOT, Shape, Skeleton
from mimoc.movement.retargeting.start import Contacts

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
    g: FloatArray  # Gradient by the unknowns of frames, shape (t, n).
    border: FloatArray  # C, shape (t, n, s).
    corner: FloatArray  # D, shape (s, s).
    h: FloatArray  # Gradient by what all frames share, shape (s,).

    @classmethod
    def zeros(cls, frames: int, unknowns: int, shared: int) -> "NormalEquations":
        """Return an empty system."""
        bands = np.zeros(((frames + 2) * unknowns, 2 * unknowns + 1))
        bands[frames * unknowns :, 0] = 1.0
        g = np.zeros((frames, unknowns))
        border = np.zeros((frames, unknowns, shared))
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

    factor: FloatArray  # Cholesky factor L of A in LAPACK's lower bands, shape (2 n + 1, (t + 2) n).
    inverse_g: FloatArray  # A^-1 g, shape (t, n).
    inverse_border: FloatArray  # Z = A^-1 C, shape (t, n, s).
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


LIMIT_RAD = np.radians(0.3)
"""How far beyond an end of its range a hinge may be, as a standard deviation; what remains is clipped afterwards."""
CHUNK = 500  # Frames whose derivatives are in memory at once.
SETTLED = 5e-4  # Relative change of the cost below which a fit ends.
SLOW, SHRINK = 0.15, 0.5  # Gain, relative to the cost, below which outliers come nearer, and by which factor.
LONGEST = 0.6  # Largest change of an unknown of a frame in one step, in [rad] or [m].


@dataclass(frozen=True)
class State:
    """Where a fit stands."""

    x: FloatArray  # Unknowns of the frames, shape (t, n).
    height_m: float  # Height of the camera above the floor; of points in space, of the floor above their zero, negated.
    logs: FloatArray  # Logarithms of overall size and other sizes, relative to the child's, shape (s,).

    def moved(self, step: FloatArray, shared: FloatArray) -> "State":
        """Return the state after a step, which is shortened in frames where it is too long."""
        longest = np.maximum(np.abs(step).max(axis=1, keepdims=True) / LONGEST, 1.0)
        return State(self.x + step / longest, self.height_m + float(shared[0]), self.logs + shared[1:])


@dataclass(frozen=True)
class Problem:
    """All that a fit is of: t frames of n unknowns, which share the height and s sizes."""

    skeleton: Skeleton
    shape: Shape
    observed: Observed
    contacts: Contacts
    rate_hz: float
    chain: FloatArray  # Precision matrix of the usual movement, `prior.chain`.
    mean: FloatArray  # Usual unknowns, shape (t, n).
    low: FloatArray  # Least angles of the unknowns of hinges, shape (u,).
    high: FloatArray
    sums: FloatArray  # Factors of combined limits, shape (m, u).
    sum_bounds: FloatArray  # Their bounds in either direction, shape (m,).
    shared_mean: FloatArray  # What is usual of the height and the logarithms of sizes, shape (1 + s,).
    shared_sd: FloatArray  # Its standard deviation, shape (1 + s,).
    held: FloatArray
    """Factors of a sum of these that is held near 0 while nothing tells of size, over its SD, shape (1 + s,)."""
    pull: FloatArray
    """Half the gradient of log det A by these, `uncertainty.pull_of`, shape (1 + s,); zero before it is known."""

    def equations(self, state: State, outlier: float) -> tuple[NormalEquations, float]:
        """Return the normal equations at a state, and its cost (twice the negative logarithm of the posterior)."""
        t, n = state.x.shape
        system = NormalEquations.zeros(t, n, 1 + len(state.logs))
        shape = at_sizes(self.shape, state.logs)
        cost = sum(
            self._add_part(system, state, shape, slice(i, min(i + CHUNK, t)), outlier) for i in range(0, t, CHUNK)
        )
        return system, cost + self._add_priors(system, state)

    def _add_part(self, system: NormalEquations, state: State, shape: Shape, part: slice, outlier: float) -> float:
        """Add what is seen in some frames, contacts and limits; return their cost."""
        pose = self.skeleton.pose(state.x[part], shape)
        seen = np.arange(self.observed.places.shape[1])
        jacobian, cost = self.skeleton.jacobian(pose, seen), 0.0
        blocks = np.zeros((part.stop - part.start, *system.border.shape[1:2] * 2))
        for channel in self.observed.channels(part, pose, jacobian, state.height_m):
            weight, value = channel.robust(outlier)
            cost += value
            _add_channel(system, blocks, part, channel, weight)
        for frames, errors, by_frame, by_size in self.contacts.residuals(self.skeleton, pose, self.rate_hz):
            cost += float(errors @ errors)
            blocks[frames] += by_frame[:, :, None] * by_frame[:, None]
            system.g[part][frames] += by_frame * errors[:, None]
            system.border[part][frames, :, 1:] += by_frame[:, :, None] * by_size[:, None]
            system.corner[1:, 1:] += by_size.T @ by_size
            system.h[1:] += by_size.T @ errors
        for over, factors in self._beyond(state.x[part]):
            cost += float((over**2).sum())
            outside = (over != 0) / LIMIT_RAD**2
            blocks[:, ROOT:, ROOT:] += np.einsum("fm,mu,mv->fuv", outside, factors, factors, optimize=True)
            system.g[part][:, ROOT:] += over / LIMIT_RAD @ factors
        system.add_blocks(part.start, blocks)
        return cost

    def _beyond(self, x: FloatArray) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Yield how far unknowns and their sums are beyond their limits, over its SD, and factors of the unknowns."""
        angles = x[:, ROOT:]
        yield (angles - np.clip(angles, self.low, self.high)) / LIMIT_RAD, np.eye(angles.shape[1])
        sums = angles @ self.sums.T
        yield (sums - np.clip(sums, -self.sum_bounds, self.sum_bounds)) / LIMIT_RAD, self.sums

    def _add_priors(self, system: NormalEquations, state: State) -> float:
        away = state.x - self.mean
        pull = times_chain(self.chain, away)
        system.add_chain(self.chain)
        system.g += pull
        shared = np.array([state.height_m, *state.logs]) - self.shared_mean
        held = float(self.held @ shared)
        system.corner += np.diag(self.shared_sd**-2) + np.outer(self.held, self.held)
        system.h += shared / self.shared_sd**2 + self.pull + held * self.held
        cost = ((shared / self.shared_sd) ** 2).sum() + held**2 + 2 * self.pull @ shared
        return float((away * pull).sum() + cost)

    def within_limits(self, x: FloatArray) -> FloatArray:
        """Return unknowns within all limits: those beyond are at the end, sums of angles shrink in proportion."""
        angles = np.clip(x[:, ROOT:], self.low, self.high)
        for factors, bound in zip(self.sums, self.sum_bounds, strict=True):
            share = np.minimum(1.0, bound / np.maximum(np.abs(angles @ factors), 1e-12))
            used = factors != 0
            angles[:, used] *= share[:, None]
        return np.concatenate([x[:, :ROOT], np.clip(angles, self.low, self.high)], axis=1)


def solve(
    problem: Problem,
    state: State,
    iterations: int,
    *,
    free: BoolArray,
    first_outlier: float = OUTLIER,
    last_outlier: float = OUTLIER,
    tick: Callable[[], None] = lambda: None,
    keep: Callable[[State], None] = lambda state: None,
) -> State:
    """Return the state after a number of steps, or fewer if it no longer changes.

    Args:
        problem: What is fitted.
        state: Where it begins.
        iterations: Number of steps at most.
        free: Which of height and sizes may change, shape (1 + s,), boolean.
        first_outlier: Distance of an outlier in the first step; it shrinks when steps gain little (graduated
            non-convexity, Blake and Zisserman 1987), to *last_outlier*.
        last_outlier: Its distance in the end.
        tick: Called after each step.
        keep: Called with each state that is better than those before.
    """
    damping, outlier = 1e-4, first_outlier
    best, least, last = state, np.inf, np.inf
    for _ in range(iterations):
        system, cost = problem.equations(state, outlier)
        if outlier == last and cost > least * (1 + 1e-6):
            damping, state = min(damping * 20, 10.0), best
            system, _ = problem.equations(state, outlier)
        else:
            gain = least - cost if outlier == last else np.inf
            best = state
            least = cost
            damping = max(damping / 4, 1e-6)
            last = outlier
            keep(state)
            if gain < SLOW * abs(cost) and outlier > last_outlier:
                outlier = max(last_outlier, SHRINK * outlier)
            elif gain < SETTLED * abs(cost):
                break
        step, shared = system.factored(damping).step(free)
        state = state.moved(step, shared)
        tick()
    return state if outlier != last or problem.equations(state, outlier)[1] < least else best


def _add_channel(
    system: NormalEquations, blocks: FloatArray, part: slice, channel: Channel, weight: FloatArray
) -> None:
    """Add the squares of differences to blocks and to the rest of a system."""
    f, k, c = channel.errors.shape
    rows = np.repeat(weight, c, axis=1)
    frame, shared = channel.by_frame.reshape(f, k * c, -1), channel.by_shared.reshape(f, k * c, -1)
    weighted = (frame * rows[..., None]).transpose(0, 2, 1)
    errors = channel.errors.reshape(f, k * c, 1)
    blocks += weighted @ frame
    system.g[part] += (weighted @ errors)[..., 0]
    system.border[part] += weighted @ shared
    heavy = (shared * rows[..., None]).reshape(f * k * c, -1)
    system.corner += heavy.T @ shared.reshape(f * k * c, -1)
    system.h += heavy.T @ errors.ravel()


INTERRUPTED = "stopped before the end, by Ctrl-C: the motion is the best so far"
_T = TypeVar("_T")


@dataclass
class Run:
    """A fit in progress."""

    progress: Callable[[int, int], None] | None  # Called with the number of steps done, and of all.
    total: int
    done: int = 0
    begin_s: float = field(default_factory=time.process_time)
    compiling_s: float = 0.0
    notes: list[str] = field(default_factory=list)

    @property
    def interrupted(self) -> bool:
        """Whether it was told to end."""
        return bool(self.notes)

    @property
    def seconds(self) -> float:
        """Processor time so far, without that of compiling."""
        return time.process_time() - self.begin_s - self.compiling_s

    def tick(self) -> None:
        """Count a step."""
        self.done += 1
        if self.progress:
            self.progress(min(self.done, self.total), self.total)

    def compiled(self, make: Callable[[], _T]) -> _T:
        """Return what is made; its time does not count. Ctrl-C lets it finish."""
        begin = time.process_time()
        result = self.finished(make)
        self.compiling_s += time.process_time() - begin
        return result

    def finished(self, make: Callable[[], _T]) -> _T:
        """Return what the end of a fit needs; Ctrl-C makes it begin again, once."""
        try:
            return make()
        except KeyboardInterrupt:
            if self.interrupted:
                raise
            self.notes.append(INTERRUPTED)
            return make()

    def improved(self, before: _T, make: Callable[[], _T]) -> _T:
        """Return what is made, or what was before if the run was or is interrupted."""
        if self.interrupted:
            return before
        try:
            return make()
        except KeyboardInterrupt:
            self.notes.append(INTERRUPTED)
            return before

    def solve(
        self,
        problem: Problem,
        state: State,
        steps: int,
        free: BoolArray,
        outliers: tuple[float, float] = (OUTLIER, OUTLIER),
    ) -> State:
        """Return the best state after at most so many steps; *outliers* are distances, first and last."""
        states, end = [state], self.done + steps
        if not self.interrupted:
            try:
                first, last = outliers
                solved = solve(
                    problem,
                    state,
                    steps,
                    free=free,
                    first_outlier=first,
                    last_outlier=last,
                    tick=self.tick,
                    keep=states.append,
                )
                states.append(solved)
            except KeyboardInterrupt:
                self.notes.append(INTERRUPTED)
        if self.done < end:
            self.done = end - 1
            self.tick()
        return states[-1]
