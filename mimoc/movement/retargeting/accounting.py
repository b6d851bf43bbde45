"""The account of a fit: its errors, and how far its result can be trusted."""

import numpy as np

from mimoc.motion.point_recording import FloatArray
from mimoc.movement.retargeting.fitting import Problem, State
from mimoc.movement.retargeting.one_camera import of_one_camera
from mimoc.movement.retargeting.prior import usual_of
from mimoc.movement.retargeting.result import QUANTILE, Account, Interval
from mimoc.movement.retargeting.setting import Setting, points_of
from mimoc.movement.retargeting.sizes import lengths_of
from mimoc.movement.retargeting.skeleton import ROOT
from mimoc.movement.retargeting.uncertainty import Uncertainty

UNSEEN = 0.8
"""Share of the usual spread of a hinge that its standard deviation must keep, in half of the frames, for it to count as
unseen: then its interval is about as wide as what infants do at all."""
CENTRE_M = 0.0003
"""How far a joint's centre is from where the model of the fitted child has it, as a standard deviation: between its two
joints, a length is no better known (D: from fits to known motions)."""
NOT_SEEN = "what was filmed does not tell these angles; they are what is usual, and their intervals say little"
TOUCHED_RAD = np.radians(0.1)
"""Distance from an end of its range at which a hinge touches it."""


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
    half_m, factors = QUANTILE * float(np.sqrt(wide.shared_covariance[0, 0])), setting.height_factors
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
    lengths, covariance = lengths_of(setting.child.model), sure.shared_covariance[1:, 1:]
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
