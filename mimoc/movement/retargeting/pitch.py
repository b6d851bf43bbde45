"""By which angle a camera looks down, from how the trunk of an infant who lies appears in its picture."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.errors import RecordingError
from mimoc.motion.body_points import body_points, locate
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.movement.retargeting.observations import STRAIGHT_DOWN_DEG, camera_from_world
from mimoc.movement.retargeting.result import LEVEL, Interval
from mimoc.movement.retargeting.start import SHOULDERS, TRUNK, on_ground

CANDIDATES_DEG = np.arange(15.0, STRAIGHT_DOWN_DEG + 1)
"""Angles that are tried: all are taken to be equally likely before."""
PROPORTIONS_SD = 0.06
"""How far the points of a trunk are from those of the average child's, as a share of its length (D: with it, intervals
of simulated films at 30 to 90 degrees hold the truth; the survey has .06-.08 for widths of shoulders and hips)."""
CLEARLY = 1.25
"""Difference of log likelihood from which a camera is taken to be slanted (D: of simulated films, those at 45 degrees
have 1.3 and more, those from straight above .8 and less)."""
ALIKE = 0.17
"""Distance of the points from those of a trunk that lies, likewise, above which this says nothing: one that turns."""

STRAIGHT = "the camera is taken to look straight down on a level floor"
SLANTED = (
    "the trunk looks foreshortened: the camera is taken to look down at {deg:.0f} degrees below the horizon"
    " ({low:.0f} to {high:.0f}, 90 %), the upper edge of its picture level; if you know the angle, say it"
    " (camera_pitch_deg=, --camera-pitch; 90 is straight down)"
)
GIVEN = "the camera looks down at {deg:g} degrees below the horizon, as given, the upper edge of its picture level"


@dataclass(frozen=True)
class Pitch:
    """The angle by which a camera looks down, below the horizon: 90 degrees if it looks straight down."""

    deg: Interval
    note: str


def pitch_of(recording: PointRecording, model: mujoco.MjModel, given_deg: float | None) -> Pitch:
    """Return the given angle or, if the trunk is clearly foreshortened, that which makes it look like one that lies.

    For the angle t, rays to neck, shoulders and hips meet the floor at z_k(t), complex numbers; those of the average
    child who lies are w_k. Their distance is min_a |a z(t) - w|, the median over frames d(t), over the trunk's length;
    the likelihood of t is exp(-d(t)^2 / (2 sd^2)), with the SD of proportions of bodies. Raises a RecordingError if the
    angle is impossible, or the trunk were above the horizon then.
    """
    if given_deg is not None:
        if recording.unit == "m":
            raise RecordingError(f"{recording.name}: points in space have no camera; leave camera_pitch_deg= out")
        if not 0 < given_deg <= STRAIGHT_DOWN_DEG:
            raise RecordingError(
                f"camera_pitch_deg={given_deg:g}: give degrees below the horizon, above 0 and up to 90"
            )
        trunk = recording.select(TRUNK).filled()
        if not np.isfinite(on_ground(trunk, camera_from_world(given_deg))[np.isfinite(trunk.positions).all(-1)]).all():
            reason = f"with camera_pitch_deg={given_deg:g} the trunk would be above the horizon in some frames"
            raise RecordingError(f"{recording.name}: {reason}; give the angle by which the camera looks down")
        return Pitch(Interval(given_deg, given_deg, given_deg), GIVEN.format(deg=given_deg))
    straight = Pitch(Interval(STRAIGHT_DOWN_DEG, STRAIGHT_DOWN_DEG, STRAIGHT_DOWN_DEG), STRAIGHT)
    names = (*TRUNK, *SHOULDERS)
    if recording.unit == "m" or not {*names} <= {*recording.names} or not all(body_points(model, names)):
        return straight
    trunk = recording.select(names).filled()
    if not np.isfinite(trunk.positions).all():
        return straight
    lying_m = locate(model, model.key("supine").qpos[None], names)[0]
    distance = np.array([_distance(on_ground(trunk, camera_from_world(t)), lying_m) for t in CANDIDATES_DEG])
    losses = distance**2 / (2 * PROPORTIONS_SD**2)
    best = int(losses.argmin())
    if losses[-1] - losses[best] < CLEARLY or distance[best] > ALIKE:
        return straight
    shares = np.cumsum(np.exp(losses[best] - losses))
    low, high = (CANDIDATES_DEG[np.searchsorted(shares / shares[-1], q)] for q in ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    deg = Interval(float(CANDIDATES_DEG[best]), float(min(low, CANDIDATES_DEG[best])), float(high))
    return Pitch(deg, SLANTED.format(deg=deg.value, low=deg.low, high=deg.high))


def _distance(ground: FloatArray, lying_m: FloatArray) -> float:
    """Return the median distance of points on the ground, shape (t, k, 2), from those of one who lies, shape (k, 3)."""
    if not np.isfinite(ground).all():
        return np.inf
    seen, lying = ground @ [1, 1j], lying_m[:, :2] @ [1, 1j]
    seen, lying = seen - seen.mean(axis=1, keepdims=True), lying - lying.mean()
    distances = []
    for side in (seen, seen.conj()):  # On its back, and on its belly.
        factor = (side.conj() * lying).sum(axis=1) / (np.abs(side) ** 2).sum(axis=1)
        distances.append(np.median(np.sqrt((np.abs(factor[:, None] * side - lying) ** 2).sum(axis=1))))
    return float(min(distances) / np.abs(lying[0] - (lying[1] + lying[2]) / 2))
