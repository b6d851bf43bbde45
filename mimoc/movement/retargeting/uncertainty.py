"""What a recording leaves open: the noise of its points, and standard deviations from the inverse of the Hessian."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from mimoc.motion.point_recording import FloatArray
from mimoc.movement.retargeting.banded import Factored
from mimoc.movement.retargeting.fitting import CHUNK, Problem, State
from mimoc.movement.retargeting.observations import OUTLIER
from mimoc.movement.retargeting.sizes import at_sizes
from mimoc.movement.retargeting.skeleton import ROOT, Shape

DIFFERENCE = 1e-3
"""Change of the height in [m], or of the logarithm of a size, by which derivatives of squares are computed."""


@dataclass(frozen=True)
class Uncertainty:
    """Of a fit to t frames and k points, with u hinges."""

    noise: tuple[float, ...]
    """Estimated noise of each channel, relative to what was assumed: of places, then of depth."""
    angle_sd_rad: FloatArray
    """Shape (t, u)."""
    depth_sd_m: FloatArray
    """Of heights above the floor, shape (t, k)."""
    shared_covariance: FloatArray
    """Of the height and the logarithms of sizes, shape (1 + s, 1 + s)."""


def uncertainty_of(problem: Problem, state: State) -> Uncertainty:
    """Return how sure a fit is, if it is linear about its solution and noise is independent.

    The covariance of the unknowns x of a frame is P = A_t + Z_t S^-1 Z_t', A_t the frame's block of A^-1 (the inverse
    if everything shared were known), and that of what is shared S^-1; so a quantity with derivatives a by x and b by
    what is shared has the variance a A_t a' + (b - a Z_t) S^-1 (b - a Z_t)'. The noise is the root of the sum of
    weighted squares over the number of coordinates less those that the unknowns use up, tr(A_t J' W J).
    """
    system, _ = problem.equations(state, OUTLIER)
    factored = system.factored()
    covariance = np.asarray(np.linalg.inv(factored.schur()), np.float64)
    shape = at_sizes(problem.shape, state.logs)
    t, n = state.x.shape
    k = problem.observed.places.shape[1]
    angle_sd, depth_sd = np.empty((t, n - ROOT)), np.empty((t, k))
    sums: list[FloatArray] = []
    blocks, stop = [], t
    for frame, block in factored.blocks():
        blocks.append(block)
        if frame % CHUNK == 0:
            part = slice(frame, stop)
            angle_sd[part], depth_sd[part], squares = _of_part(
                problem, state, shape, part, np.array(blocks[::-1]), factored, covariance
            )
            sums.append(squares)
            blocks, stop = [], frame
    noise = [
        _noise(row, dimensions)
        for row, dimensions in zip(
            np.sum(sums, axis=0),
            [problem.observed.places.shape[2]] + [1] * (problem.observed.depth_m is not None),
            strict=True,
        )
    ]
    return Uncertainty(tuple(noise), angle_sd, depth_sd, covariance)


def pull_of(problem: Problem, state: State, every: int = 1) -> FloatArray:
    """Return half the gradient of log det A by the height and the logarithms of sizes, shape (1 + s,).

    Sizes that suit the most probable motion are not the most probable sizes: the longer a limb, the less it need turn
    to be where it is seen, and the more probable the motion. Integrated over all motions (Laplace's approximation), the
    posterior of what is shared has the cost min_x c(x, s) + log det A(s), and

        1/2 d log det A / ds = 1/2 sum_t tr(A^-1[t, t] d(J_t' W J_t) / ds),

    with the motion as it is. What changes all sizes alike is overall size.

    Args:
        problem: What is fitted.
        state: Where the gradient is wanted.
        every: Of how many frames one is taken, for the rest.
    """
    system, _ = problem.equations(state, OUTLIER)
    blocks = [block for frame, block in system.factored().blocks() if frame % every == 0]
    covariances = np.array(blocks[::-1])
    frames = slice(0, len(state.x), every)
    base, weights = _squares(problem, state, frames, None)
    result = np.zeros(len(system.h))
    for index in (0, *range(2, len(result))):
        shared = np.where(np.arange(len(result)) == index, DIFFERENCE, 0.0)
        moved = state.moved(np.zeros_like(state.x), shared)
        other, _ = _squares(problem, moved, frames, weights)
        result[index] = every * np.einsum("fnm,fmn->", covariances, other - base) / (2 * DIFFERENCE)
    result[1] = result[2:].sum()
    return result


def _squares(
    problem: Problem, state: State, frames: slice, weights: list[FloatArray] | None
) -> tuple[FloatArray, list[FloatArray]]:
    """Return J' W J of frames, shape (f, n, n), and the weights W of channels; these can be given."""
    observed = problem.observed
    pose = problem.skeleton.pose(state.x[frames], at_sizes(problem.shape, state.logs))
    jacobian = problem.skeleton.jacobian(pose, np.arange(observed.places.shape[1]))
    total, used = np.zeros(()), []
    for index, channel in enumerate(observed.channels(frames, pose, jacobian, state.height_m)):
        used.append(channel.robust(OUTLIER)[0] if weights is None else weights[index])
        f, k, c, n = channel.by_frame.shape
        rows = channel.by_frame.reshape(f, k * c, n)
        total = total + (rows * np.repeat(used[-1], c, axis=1)[..., None]).transpose(0, 2, 1) @ rows
    return total, used


def _of_part(
    problem: Problem,
    state: State,
    shape: Shape,
    part: slice,
    blocks: FloatArray,
    factored: Factored,
    covariance: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return standard deviations of angles and heights, and sums for the noise, of some frames."""
    observed = problem.observed
    pose = problem.skeleton.pose(state.x[part], shape)
    seen = np.arange(observed.places.shape[1])
    jacobian = problem.skeleton.jacobian(pose, seen)
    z = factored.inverse_border[part]
    angles = np.einsum("fnn->fn", blocks) + np.einsum("fns,sr,fnr->fn", z, covariance, z, optimize=True)
    by_size = pose.points_m[2][:, seen, 1:]
    rest = np.concatenate([np.zeros((*by_size.shape[:2], 1)), by_size], axis=-1) - jacobian[2] @ z
    heights = np.einsum("fkn,fkn->fk", jacobian[2] @ blocks, jacobian[2])
    heights += np.einsum("fks,sr,fkr->fk", rest, covariance, rest, optimize=True)
    sums = []
    for channel in observed.channels(part, pose, jacobian, state.height_m):
        weight, _ = channel.robust(OUTLIER)
        used = np.einsum("fkcn,fkcn->fk", channel.by_frame @ blocks[:, None], channel.by_frame)
        squares = (channel.errors**2).sum(-1)
        sums.append([(weight * squares).sum(), weight.sum() * channel.errors.shape[2], (weight * used).sum()])
    return np.sqrt(angles[:, ROOT:]), np.sqrt(np.maximum(heights, 0.0)), np.array(sums)


def _noise(sums: FloatArray, dimensions: int) -> float:
    """Return the noise from sums of squares, of coordinates, and of those used up, all weighted.

    Weights are smaller for larger differences, also of Gaussian noise: for d coordinates, r^2 is chi-squared, and the
    expectation of w r^2 over that of w d is less than 1.
    """
    squares, coordinates, used = sums
    if coordinates <= 0:
        return 1.0
    r2 = chi2.ppf((np.arange(400) + 0.5) / 400, dimensions)
    weight = (1 + r2 / OUTLIER**2) ** -2
    usual = (weight * r2).mean() / (weight.mean() * dimensions)
    return float(np.sqrt(squares / max(coordinates - used, 0.05 * coordinates) / usual))
