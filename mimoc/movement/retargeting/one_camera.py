"""What one camera without depth leaves open: much more than the Hessian of the solution that was found says."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mimoc.motion.point_recording import FloatArray
from mimoc.movement.retargeting import prior
from mimoc.movement.retargeting.banded import BoolArray
from mimoc.movement.retargeting.fitting import Problem, State
from mimoc.movement.retargeting.postures import spread_of_alike
from mimoc.movement.retargeting.setting import Setting
from mimoc.movement.retargeting.sizes import at_sizes
from mimoc.movement.retargeting.skeleton import ROOT, exponential
from mimoc.movement.retargeting.uncertainty import Uncertainty, uncertainty_of

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
FLAT = 0.8
"""Cosine of the angle between the front of the trunk and the vertical from which it lies flat."""
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
    trunk, boundless = setting.recording.trunk, np.full_like(problem.low, np.inf)
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
        (spread, problem.low, problem.high),
        (trunk, state.height_m, problem.rate_hz),
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
