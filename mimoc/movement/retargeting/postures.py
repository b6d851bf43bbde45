"""Where a fit starts: postures of each limb from a library, the likeliest sequence of them by dynamic programming."""

import numpy as np
from scipy.stats import norm, qmc

from mimoc.motion.point_recording import FloatArray
from mimoc.movement.retargeting.observations import Observed
from mimoc.movement.retargeting.skeleton import ROOT, IntArray, Shape, Skeleton, exponential

LIBRARY = 1024  # Postures of a limb that are tried.
KEPT = 48  # Of them, those of each frame that sequences are made of.
SPREAD_OF_TRUNK = 0.05
"""Distance from what is seen that is taken for usual, as a share of the trunk: the library is not dense."""
FAR = 4.0  # Distance, in these, beyond which a point counts no more.
SPEED_M_S, COARSE_M = 0.25, 0.02  # Usual speed of points of a limb, and distance of neighbours in the library.
SINK_M = 0.01  # Depth below the floor that is taken for usual.
ALIKE_OF_TRUNK, ALIKE_WIDER, ALIKE_HZ = 0.05, 1.5, 5.0
"""Distance, as a share of the trunk, at which postures look alike; by how much postures that may be are more spread
than usual ones, since infants may move otherwise; and at how many frames a second they are looked for."""
_ARM = "shoulder", "elbow", "hand"


def likely_postures(
    skeleton: Skeleton,
    shape: Shape,
    observed: Observed,
    x: FloatArray,
    bounds: tuple[FloatArray, FloatArray, FloatArray],
    scale: tuple[float, float, float],
) -> FloatArray:
    """Return unknowns whose limbs are in likely postures, shape (t, n).

    A limb that is seen bent may point to the camera or away from it, and least squares do not get from one to the
    other. So postures are drawn from what is usual, and of those that look right in each frame the sequence is taken
    whose sum of squares is least (Viterbi): of distances from what is seen, of depth below the floor, and of movement
    from frame to frame.

    The unknowns x have the root in place, shape (t, n); bounds are standard deviation, least and largest angle of each
    hinge unknown, shape (u,), and scale the trunk in the unit of the recording, the height of the camera, and frames
    per second.
    """
    result = x.copy()
    for columns in _limbs(skeleton.hinges.names):
        points = skeleton.points_moved(columns)
        points = points[points < observed.places.shape[1]]
        if len(points):
            library = _library(x[0], columns, *bounds)
            places_m = skeleton.pose(library, shape).points_m[:, :, points, 0]
            result[:, columns] = library[_sequence(places_m, points, observed, x, scale)][:, columns]
    return result


def spread_of_alike(
    skeleton: Skeleton,
    shape: Shape,
    observed: Observed,
    x: FloatArray,
    bounds: tuple[FloatArray, FloatArray, FloatArray],
    scale: tuple[float, float, float],
    centre: FloatArray,
) -> FloatArray:
    """Return how far the angles of postures that look like the fitted ones are from these, shape (t, u).

    It is the root of the weighted mean square over a library of postures of each limb; of the squares d^2 of distances
    of their points from the fitted ones, as they are seen and over `ALIKE_OF_TRUNK`, weights are exp(-sum d^2 / 2). A
    limb that points to the camera looks like one that points away, so this is wide where the Hessian of a fit is not.
    Hinges of the trunk are in no limb: 0. See `likely_postures` for the arguments; *centre* are usual angles, shape
    (u,).
    """
    trunk, height_m, rate_hz = scale
    frames = np.unique(np.r_[0 : len(x) : max(1, round(rate_hz / ALIKE_HZ)), len(x) - 1])
    turns, usual = exponential(x[frames, 3:ROOT])[0], np.median(x, axis=0)
    fitted_m = np.moveaxis(skeleton.pose(x[frames], shape).points_m[..., 0], 0, -1)
    squares = np.zeros((len(frames), x.shape[1] - ROOT))
    for columns in _limbs(skeleton.hinges.names):
        points = skeleton.points_moved(columns)
        points = points[points < observed.places.shape[1]]
        if not len(points):
            continue
        middle = usual.copy()
        middle[columns] = centre[columns - ROOT]
        library = _library(middle, columns, ALIKE_WIDER * bounds[0], *bounds[1:])
        places_m = skeleton.pose(library, shape).points_m[:, :, points, 0]
        for index, frame in enumerate(frames):
            world_m = np.einsum("ij,jmk->mki", turns[index], places_m) + x[frame, :3]
            away = observed.project(world_m, height_m) - observed.project(fitted_m[index, points], height_m)
            cost = (away**2).sum((-1, -2)) / (ALIKE_OF_TRUNK * trunk) ** 2
            cost += (np.minimum(world_m[..., 2], 0.0) ** 2).sum(-1) / SINK_M**2
            weights = np.exp((cost.min() - cost) / 2)
            squares[index, columns - ROOT] = weights @ (library[:, columns] - x[frame, columns]) ** 2 / weights.sum()
    return np.stack([np.sqrt(np.interp(np.arange(len(x)), frames, column)) for column in squares.T], axis=1)


def _sequence(
    places_m: FloatArray, points: IntArray, observed: Observed, x: FloatArray, scale: tuple[float, float, float]
) -> IntArray:
    """Return the likeliest posture of each frame, as indices of the library, shape (t,)."""
    trunk, height_m, rate_hz = scale
    turns, step_m = exponential(x[:, 3:ROOT])[0], np.hypot(SPEED_M_S / rate_hz, COARSE_M)
    totals, before, back, kept = np.zeros(KEPT), np.zeros((KEPT, 3 * len(points))), [], []
    for frame, turn in enumerate(turns):
        world_m = np.einsum("ij,jmk->mki", turn, places_m) + x[frame, :3]
        cost = _cost(world_m, points, observed, frame, trunk, height_m)
        best = np.argpartition(cost, KEPT)[:KEPT]
        flat = world_m[best].reshape(KEPT, -1)
        squares = (flat**2).sum(1)[:, None] + (before**2).sum(1) - 2 * flat @ before.T
        moves = np.zeros((KEPT, KEPT)) if frame == 0 else squares / step_m**2 / len(points)
        through = moves + totals
        back.append(through.argmin(axis=1))
        totals = through.min(axis=1) + cost[best]
        before = flat
        kept.append(best)
    current, sequence = int(totals.argmin()), []
    for choices, sources in zip(reversed(kept), reversed(back), strict=True):
        sequence.append(choices[current])
        current = int(sources[current])
    return np.array(sequence[::-1], np.intp)


def _cost(
    world_m: FloatArray, points: IntArray, observed: Observed, frame: int, trunk: float, height_m: float
) -> FloatArray:
    """Return how far postures are from what is seen in a frame, squared and over what is usual, shape (m,)."""
    seen = observed.project(world_m, height_m)
    usual = SPREAD_OF_TRUNK * trunk
    squares = ((seen - observed.places[frame, points]) ** 2).sum(-1) / usual**2
    cost = (observed.weight[frame, points] * np.minimum(squares, FAR**2)).sum(-1)
    if observed.depth_m is not None and observed.depth_weight is not None:
        away = (observed.in_camera(world_m, height_m)[..., 2] - observed.depth_m[frame, points]) / COARSE_M
        cost += (observed.depth_weight[frame, points] * np.minimum(away**2, FAR**2)).sum(-1)
    if not observed.in_space:
        cost += (np.minimum(world_m[..., 2], 0.0) ** 2).sum(-1) / SINK_M**2
    return cost


def _library(x: FloatArray, columns: IntArray, sd: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return unknowns with a limb in usual postures, the root at the origin, shape (m, n).

    They are the points of Halton's sequence, made normal: no random numbers.
    """
    unit = qmc.Halton(len(columns), scramble=False).random(LIBRARY + 1)[1:]
    hinges = columns - ROOT
    angles = x[columns] + norm.ppf(unit) * sd[hinges]
    result = np.tile(x, (LIBRARY, 1))
    result[:, :ROOT] = 0.0
    result[:, columns] = np.clip(angles, low[hinges], high[hinges])
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
