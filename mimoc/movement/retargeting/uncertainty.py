"""What a recording leaves open: the noise of its points, and standard deviations from the inverse of the Hessian."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from mimoc.motion.point_recording import FloatArray
from mimoc.movement.retargeting import prior
from mimoc.movement.retargeting.fitting import CHUNK, BoolArray, Factored, Problem, State
from mimoc.movement.retargeting.observations import OUTLIER
from mimoc.movement.retargeting.postures import AngleBounds, Scale, spread_of_alike
from mimoc.movement.retargeting.prior import usual_of
from mimoc.movement.retargeting.result import QUANTILE, Account, Interval
from mimoc.movement.retargeting.setting import Setting, points_of
from mimoc.movement.retargeting.sizes import at_sizes, lengths_of
from mimoc.movement.retargeting.skeleton import ROOT, Shape, exponential

DIFFERENCE = 1e-3
"""Change of the height in [m], or of the logarithm of a size, by which derivatives of squares are computed."""


@dataclass(frozen=True)
class Uncertainty:
    """How uncertain a fit to t frames and k points is, with u hinges."""

    noise: tuple[float, ...]  # Estimated noise of each channel, relative to what was assumed: of places, then of depth.
    angle_sd_rad: FloatArray  # Shape (t, u).
    depth_sd_m: FloatArray  # Standard deviations of heights above the floor, shape (t, k).
    shared_covariance: FloatArray  # Covariance of the height and the logarithms of sizes, shape (1 + s, 1 + s).


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
        every: Step, in frames, between those that are taken; each stands for a whole step.
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


MODEL_OF_TRUNK = 0.05
"""Noise that stands for errors which last, of proportions, centres of joints and the camera, as a share of the trunk:
the Hessian counts each frame anew, so it is about .01 times the root of the frames in which postures last."""
WIDER = {
    "shoulder_horizontal": (0.8, 0.8),
    "shoulder_ad_ab": (0.6, 0.8),
    "shoulder_rotation": (0.7, 0.7),
    "elbow": (0.55, 0.7),
    "hand1": (0.75, 0.75),
    "hand": (0.5, 0.5),
    "head": (0.6, 0.9),
    "hip_bend": (1.3, 4.0),
    "hip_lean": (1.0, 5.0),
    "hip_rot": (1.5, 6.0),
    "hip1": (1.1, 2.3),
    "hip2": (0.9, 2.3),
    "hip3": (1.0, 1.6),
    "knee": (0.8, 0.8),
    "foot1": (0.5, 0.5),
    "foot2": (0.7, 0.7),
    "foot3": (0.6, 0.9),
}
"""Factors on standard deviations of angles, by what the name of a hinge contains: while the trunk lies flat, and from
the first frame on in which it has turned, when what its contact with the floor tells of it is wrong (D: the 90th
percentile of errors over standard deviations in that kind of motion in which it is largest, over that of a normal
distribution, of 10 children each in general movements and kicks and 8 who roll: `benchmarks/one_camera.py --calibrate
--first 1000`, before these factors; reaches had no part)."""
FLAT = 0.8  # Cosine of the angle between the front of the trunk and the vertical from which it lies flat.
LENGTHS_WIDER, LENGTHS_WIDER_WITH_HEIGHT = 1.15, 2.0
"""Factors on those of logarithms of lengths: where the camera's height is not given, and where it is, so that not
knowing overall size does not hide what is wrong (D: likewise; with the height, of nine children who lie)."""
OVERALL_LEAST = 0.02
"""Standard deviation of the logarithm of overall size, at least, that the camera's height leaves (D: likewise)."""


def of_one_camera(setting: Setting, problem: Problem, state: State, sure: Uncertainty) -> Uncertainty:
    """Return how sure a fit to one camera is, from how sure its solution is by its Hessian.

    With the calibrated factor v of a hinge, its variance is v^2 (H + A): H is that of the Hessian with `MODEL_OF_TRUNK`
    added to the noise, and without the limits of joints, for a solution at a limit need not be there; A is the mean
    square distance of postures that look alike, `spread_of_alike`. The variance of the logarithm of a length is that of
    overall size, if nothing tells it, and that of the bodies of children, times a calibrated factor: one camera tells
    next to nothing of lengths.
    """
    trunk = setting.recording.trunk
    boundless = np.full_like(problem.low, np.inf)
    observed = replace(problem.observed, noise=float(np.hypot(problem.observed.noise, MODEL_OF_TRUNK * trunk)))
    loose = uncertainty_of(
        replace(
            problem,
            observed=observed,
            low=-boundless,
            high=boundless,
            sum_bounds=np.full_like(problem.sum_bounds, np.inf),
            shared_sd=setting.shared_sd(),
        ),
        state,
    )
    spread = np.array([usual.sd for usual in prior.usual_of(setting.hinges)[ROOT:]])
    alike = spread_of_alike(
        problem.skeleton,
        at_sizes(problem.shape, state.logs),
        problem.observed,
        state.x,
        AngleBounds(spread, problem.low, problem.high),
        Scale(trunk, state.height_m, problem.rate_hz),
        problem.mean[0, ROOT:],
    )
    lying, turned = factors(setting.hinges.names)
    has_turned = turns(problem, state)[:, None]
    angles = np.hypot(loose.angle_sd_rad, alike) * np.where(has_turned, turned, lying)
    shared = loose.shared_covariance.copy()
    shared[1:, 1:] *= (LENGTHS_WIDER_WITH_HEIGHT if setting.size_is_known else LENGTHS_WIDER) ** 2
    shared[1, 1] += OVERALL_LEAST**2 if setting.size_is_known else 0.0
    return replace(sure, angle_sd_rad=angles, shared_covariance=shared, depth_sd_m=loose.depth_sd_m)


def factors(hinges: Sequence[str]) -> FloatArray:
    """Return the factors of each hinge, while the trunk lies flat and when it has turned, shape (2, u)."""
    return np.array([next(pair for part, pair in WIDER.items() if part in name) for name in hinges]).T


def turns(problem: Problem, state: State) -> BoolArray:
    """Return from which frame on the trunk has turned off the side on which it mostly lies, shape (t,)."""
    front = (exponential(state.x[:, 3:ROOT])[0] @ problem.skeleton.turned)[:, 2, 0]
    return np.logical_or.accumulate(front * np.sign(np.median(front)) < FLAT)


UNSEEN = 0.8
"""Share of the usual spread of a hinge that its standard deviation must keep, in half of the frames, for it to count as
unseen: then its interval is about as wide as what infants do at all."""
CENTRE_M = 0.0003
"""How far a joint's centre is from where the model of the fitted child has it, as a standard deviation: between its two
joints, a length is no better known (D: from fits to known motions)."""
NOT_SEEN = "what was filmed does not tell these angles; they are what is usual, and their intervals say little"
TOUCHED_RAD = np.radians(0.1)  # Distance from an end of its range at which a hinge touches it.


def account_of(
    setting: Setting,
    problem: Problem,
    state: State,
    sure: Uncertainty,
    fitted: FloatArray,
    seconds: float,
    notes: tuple[str, ...],
) -> Account:
    """Return the account of a fit, by its last problem and solution, with *fitted* points as the recording has them."""
    recording, hinges = setting.recording, setting.hinges
    seen = (problem.observed.weight > 0) & np.isfinite(fitted).all(-1)
    distance = np.linalg.norm(fitted - problem.observed.places, axis=-1)
    names = recording.names
    by_point = {n: float(np.median(distance[seen[:, k], k])) for k, n in enumerate(names) if seen[:, k].any()}
    joints = tuple(setting.child.model.joint(int(joint)).name for joint in hinges.ids)
    wide = sure if problem.observed.tells_size else of_one_camera(setting, problem, state, sure)
    half_m = QUANTILE * float(np.sqrt(wide.shared_covariance[0, 0]))
    factors = setting.height_factors
    ends_m = (state.height_m - half_m) * factors[0], (state.height_m + half_m) * factors[1]
    unseen = _unseen(setting, wide, joints)
    if unseen:
        named = ", ".join(name.removeprefix("robot:") for name in unseen)
        notes = (*notes, f"{NOT_SEEN}: {named}")
    angles = state.x[:, ROOT:]
    touched = (angles < problem.low + TOUCHED_RAD) | (angles > problem.high - TOUCHED_RAD)
    shares = dict(zip(hinges.names, touched.mean(axis=0).tolist(), strict=True))
    return Account(
        unit=recording.unit,
        error_median=float(np.median(distance[seen])),
        error_p95=float(np.percentile(distance[seen], 95)),
        trunk=recording.trunk,
        error_of_trunk={name: value / recording.trunk for name, value in by_point.items()},
        depth_error_m=_depth_error(problem, state),
        noise=problem.observed.noise * sure.noise[0],
        depth_noise_m=problem.observed.depth_noise_m * sure.noise[1] if len(sure.noise) > 1 else None,
        size_is_known=setting.size_is_known,
        lengths_m=_lengths(setting, wide),
        camera_height_m=Interval(state.height_m, *ends_m) if recording.unit == "px" else None,
        camera_pitch_deg=setting.pitch.deg if recording.unit == "px" else None,
        joints=joints,
        angle_sd_rad=wide.angle_sd_rad[:, hinges.column] * np.abs(hinges.factor),
        depth_sd_m=dict(zip(names, np.median(wide.depth_sd_m, axis=0).tolist(), strict=True)),
        unseen=unseen,
        limits_touched={name: share for name, share in shares.items() if share},
        frames=recording.frames,
        seconds=seconds,
        notes=notes,
    )


def _depth_error(problem: Problem, state: State) -> float | None:
    observed = problem.observed
    if observed.depth_m is None or observed.depth_weight is None:
        return None
    away = np.abs(observed.in_camera(points_of(problem, state), state.height_m)[..., 2] - observed.depth_m)
    return float(np.median(away[observed.depth_weight > 0]))


def _lengths(setting: Setting, sure: Uncertainty) -> dict[str, Interval]:
    """Return the lengths of the child; the logarithm of each is that of overall size and its own together."""
    lengths = lengths_of(setting.child.model)
    covariance = sure.shared_covariance[1:, 1:]
    result = {}
    for index, size in enumerate(setting.sizes, start=1):
        row = np.zeros(len(covariance))
        row[0] = row[index] = 1.0
        value = lengths[size.name]
        half = QUANTILE * np.sqrt(row @ covariance @ row + 2 * (CENTRE_M / value) ** 2)
        result[size.name] = Interval(value, float(value * np.exp(-half)), float(value * np.exp(half)))
    return result


def _unseen(setting: Setting, sure: Uncertainty, joints: tuple[str, ...]) -> tuple[str, ...]:
    usual = np.array([item.sd for item in usual_of(setting.hinges)[ROOT:]])
    unseen = np.median(sure.angle_sd_rad, axis=0) > UNSEEN * usual
    return tuple(name for name, column in zip(joints, setting.hinges.column, strict=True) if unseen[column])
