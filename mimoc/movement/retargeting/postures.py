"""Where a fit starts: postures of each limb from a library, the likeliest sequence of them by dynamic programming."""

from typing import NamedTuple

import numpy as np
from scipy.stats import norm, qmc

from mimoc.motion.point_recording import FloatArray
from mimoc.movement.retargeting.observations import Observed
from mimoc.movement.retargeting.skeleton import ROOT, IntArray, Shape, Skeleton, exponential

LIBRARY = 1024  # Postures of a limb that are tried.
KEPT = 48  # Postures of these that are kept in each frame, to make sequences of.
SPREAD_OF_TRUNK = 0.05
"""Distance from what is seen that is taken for usual, as a share of the trunk: the library is not dense."""
FAR = 4.0  # Distance beyond which a point costs no more, in usual distances.
SPEED_M_S = 0.25  # Usual speed of points of a limb.
COARSE_M = 0.02  # Distance of points in neighbouring postures of the library.
SINK_M = 0.01  # Depth below the floor that is taken for usual.
ALIKE_OF_TRUNK = 0.05  # Distance at which postures look alike, as a share of the trunk.
ALIKE_WIDER = 1.5
"""Standard deviation of the angles that are compared, relative to usual ones: infants may move otherwise."""
ALIKE_HZ = 5.0  # Frames per second in which postures that look alike are searched.
_ARM = "shoulder", "elbow", "hand"


class AngleBounds(NamedTuple):
    """Bounds of the angle of each hinge unknown, shape (u,), [rad]."""

    sd: FloatArray  # Standard deviations of usual angles.
    low: FloatArray
    high: FloatArray


class Scale(NamedTuple):
    """Scale of a recording."""

    trunk: float  # Length of the trunk in the unit of the recording.
    height_m: float  # Height of the camera.
    rate_hz: float  # Frames per second.


def likely_postures(
    skeleton: Skeleton,
    shape: Shape,
    observed: Observed,
    x: FloatArray,
    bounds: AngleBounds,
    scale: Scale,
) -> FloatArray:
    """Return unknowns whose limbs are in likely postures, shape (t, n).

    A limb that is seen bent may point to the camera or away from it, and least squares do not get from one to the
    other. So postures are drawn from what is usual, and of those that look right in each frame the sequence is taken
    whose sum of squares is least (Viterbi): of distances from what is seen, of depth below the floor, and of movement
    from frame to frame.

    The unknowns x have the root in place, shape (t, n).
    """
    result = x.copy()
    for columns in _limbs(skeleton.hinges.names):
        points = skeleton.points_moved(columns)
        points = points[points < observed.places.shape[1]]
        if len(points):
            library = _library(x[0], columns, bounds)
            places_m = skeleton.pose(library, shape).points_m[:, :, points, 0]
            result[:, columns] = library[_sequence(places_m, points, observed, x, scale)][:, columns]
    return result


def spread_of_alike(
    skeleton: Skeleton,
    shape: Shape,
    observed: Observed,
    x: FloatArray,
    bounds: AngleBounds,
    scale: Scale,
    centre: FloatArray,
) -> FloatArray:
    """Return how far the angles of postures that look like the fitted ones are from these, shape (t, u).

    It is the root of the weighted mean square over a library of postures of each limb; of the squares d^2 of distances
    of their points from the fitted ones, as they are seen and over `ALIKE_OF_TRUNK`, weights are exp(-sum d^2 / 2). A
    limb that points to the camera looks like one that points away, so this is wide where the Hessian of a fit is not.
    Hinges of the trunk are in no limb: 0. See `likely_postures` for the arguments; *centre* are usual angles, shape
    (u,).
    """
    frames = np.unique(np.r_[0 : len(x) : max(1, round(scale.rate_hz / ALIKE_HZ)), len(x) - 1])
    turns = exponential(x[frames, 3:ROOT])[0]
    median_pose = np.median(x, axis=0)
    fitted_m = np.moveaxis(skeleton.pose(x[frames], shape).points_m[..., 0], 0, -1)
    squares = np.zeros((len(frames), x.shape[1] - ROOT))
    for columns in _limbs(skeleton.hinges.names):
        points = skeleton.points_moved(columns)
        points = points[points < observed.places.shape[1]]
        if not len(points):
            continue
        centre_pose = median_pose.copy()
        centre_pose[columns] = centre[columns - ROOT]
        library = _library(centre_pose, columns, bounds._replace(sd=ALIKE_WIDER * bounds.sd))
        places_m = skeleton.pose(library, shape).points_m[:, :, points, 0]
        for index, frame in enumerate(frames):
            world_m = np.einsum("ij,jmk->mki", turns[index], places_m) + x[frame, :3]
            fitted = observed.project(fitted_m[index, points], scale.height_m)
            away = observed.project(world_m, scale.height_m) - fitted
            cost = (away**2).sum((-1, -2)) / (ALIKE_OF_TRUNK * scale.trunk) ** 2
            cost += (np.minimum(world_m[..., 2], 0.0) ** 2).sum(-1) / SINK_M**2
            weights = np.exp((cost.min() - cost) / 2)
            squares[index, columns - ROOT] = weights @ (library[:, columns] - x[frame, columns]) ** 2 / weights.sum()
    return np.stack([np.sqrt(np.interp(np.arange(len(x)), frames, column)) for column in squares.T], axis=1)


def _sequence(places_m: FloatArray, points: IntArray, observed: Observed, x: FloatArray, scale: Scale) -> IntArray:
    """Return the likeliest posture of each frame, as indices of the library, shape (t,)."""
    turns = exponential(x[:, 3:ROOT])[0]
    step_m = np.hypot(SPEED_M_S / scale.rate_hz, COARSE_M)
    totals = np.zeros(KEPT)
    before = np.zeros((KEPT, 3 * len(points)))
    back = []
    kept = []
    for frame, turn in enumerate(turns):
        world_m = np.einsum("ij,jmk->mki", turn, places_m) + x[frame, :3]
        cost = _cost(world_m, points, observed, frame, scale)
        best = np.argpartition(cost, KEPT)[:KEPT]
        flat = world_m[best].reshape(KEPT, -1)
        # |a - b|^2 = |a|^2 + |b|^2 - 2 a b for each pair of postures in this frame and the one before.
        squared_distances = (flat**2).sum(1)[:, None] + (before**2).sum(1) - 2 * flat @ before.T
        moves = np.zeros((KEPT, KEPT)) if frame == 0 else squared_distances / step_m**2 / len(points)
        through = moves + totals
        back.append(through.argmin(axis=1))
        totals = through.min(axis=1) + cost[best]
        before = flat
        kept.append(best)
    current = int(totals.argmin())
    sequence: list[np.intp] = []
    for choices, sources in zip(reversed(kept), reversed(back), strict=True):
        sequence.append(choices[current])
        current = int(sources[current])
    return np.array(sequence[::-1], np.intp)


def _cost(world_m: FloatArray, points: IntArray, observed: Observed, frame: int, scale: Scale) -> FloatArray:
    """Return how far postures are from what is seen in a frame, squared and over what is usual, shape (m,)."""
    projected = observed.project(world_m, scale.height_m)
    usual = SPREAD_OF_TRUNK * scale.trunk
    squares = ((projected - observed.places[frame, points]) ** 2).sum(-1) / usual**2
    cost = (observed.weight[frame, points] * np.minimum(squares, FAR**2)).sum(-1)
    if observed.depth_m is not None and observed.depth_weight is not None:
        away = (observed.in_camera(world_m, scale.height_m)[..., 2] - observed.depth_m[frame, points]) / COARSE_M
        cost += (observed.depth_weight[frame, points] * np.minimum(away**2, FAR**2)).sum(-1)
    if not observed.in_space:
        cost += (np.minimum(world_m[..., 2], 0.0) ** 2).sum(-1) / SINK_M**2
    return cost


def _library(x: FloatArray, columns: IntArray, bounds: AngleBounds) -> FloatArray:
    """Return unknowns with a limb in usual postures, the root at the origin, shape (m, n).

    They are the points of Halton's sequence, made normal, and so without random numbers.
    """
    unit = qmc.Halton(len(columns), scramble=False).random(LIBRARY + 1)[1:]
    hinges = columns - ROOT
    angles = x[columns] + norm.ppf(unit) * bounds.sd[hinges]
    result = np.tile(x, (LIBRARY, 1))
    result[:, :ROOT] = 0.0
    result[:, columns] = np.clip(angles, bounds.low[hinges], bounds.high[hinges])
    return result


def _limbs(names: tuple[str, ...]) -> list[IntArray]:
    groups: dict[str, list[int]] = {}
    for index, name in enumerate(names):
        side, _, part = name.removeprefix("robot:").partition("_")
        if side == "hip":
            continue
        limb = side if side == "head" else f"{side} {'arm' if part.startswith(_ARM) else 'leg'}"
        groups.setdefault(limb, []).append(ROOT + index)
    return [np.array(group, np.intp) for group in groups.values()]
