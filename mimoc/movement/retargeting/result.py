"""What a fit of a child and its motion to a recording gives, and how far it can be trusted."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.schema.infant import InfantSpec

LEVEL = 0.9  # Probability with which the true value is meant to lie in an interval.
QUANTILE = 1.645  # Half the width of such an interval, in standard deviations of a normal distribution.


@dataclass(frozen=True, slots=True)
class Interval:
    """A value, and the interval in which the true one lies with a probability of 90 %."""

    value: float
    low: float
    high: float

    def contains(self, value: float) -> bool:
        """Return whether a value lies in the interval."""
        return self.low <= value <= self.high

    def to_data(self) -> dict[str, float]:
        """Return it as plain data."""
        return {"value": _rounded(self.value), "low": _rounded(self.low), "high": _rounded(self.high)}


@dataclass(frozen=True)
class Account:
    """How well a motion fits its recording, and what the recording cannot tell."""

    unit: str
    """Unit of errors of reprojection: `px`, or `m` for points in space."""
    error_median: float
    """Median distance of the points of the model from those recorded, over points and frames."""
    error_p95: float
    """95th percentile of the same distances."""
    trunk: float
    """Length from the neck to the middle of the hips, as recorded, in the same unit."""
    error_of_trunk: Mapping[str, float]
    """Median distance by point, as a share of `trunk`; `error_share` is that of all points."""
    depth_error_m: float | None
    """Median distance in depth; None if the recording has none."""
    noise: float
    """Estimated standard deviation of a recorded coordinate, in the unit."""
    depth_noise_m: float | None
    """Estimated standard deviation of a recorded depth; None if the recording has none."""
    size_is_known: bool
    """Whether depth, points in space or the camera's height give absolute size; otherwise the average child of the
    age is assumed, and only proportions come from the recording."""
    lengths_m: Mapping[str, Interval]
    camera_height_m: Interval | None
    """Height of the camera above the floor; None for points in space."""
    joints: tuple[str, ...]
    """Hinges of the model that were fitted, j of them."""
    angle_sd_rad: FloatArray
    """Standard deviation of each of their angles at each frame, shape (t, j); with one camera and no depth, also
    for postures that look alike, and calibrated (`mimoc.movement.retargeting.uncertainty`)."""
    depth_sd_m: Mapping[str, float]
    """Standard deviation of the height of each point above the floor, median over frames."""
    unseen: tuple[str, ...]
    """Hinges of which the recording says next to nothing: their angles are what is usual, and their standard deviations
    about as large as the spread of infants' postures."""
    limits_touched: Mapping[str, float]
    """Share of frames in which a hinge is at an end of its range; hinges that never are, are left out."""
    frames: int
    seconds: float
    """Processor time of the fit, without compiling the child."""
    camera_pitch_deg: Interval | None = None
    """Angle by which the camera looks down, below the horizon: 90 if it looks straight down; as it was given, taken
    for granted (then without any width) or estimated. None for points in space."""
    notes: tuple[str, ...] = ()
    """What was assumed, and what was left undone, one line each."""

    @property
    def error_share(self) -> float:
        """Median error as a share of `trunk`, which `to_data` calls `error_median_of_trunk`."""
        return self.error_median / self.trunk

    @property
    def frames_per_s(self) -> float:
        """Frames fitted in a second of processor time."""
        return self.frames / max(self.seconds, 1e-9)

    @property
    def angle_sd_deg(self) -> dict[str, float]:
        """Standard deviation of the angle of each hinge, median over frames."""
        return dict(zip(self.joints, np.degrees(np.median(self.angle_sd_rad, axis=0)).tolist(), strict=True))

    def to_data(self) -> dict[str, Any]:
        """Return it as plain data for JSON; standard deviations by frame are left out."""
        return {
            "unit": self.unit,
            "error_median": _rounded(self.error_median),
            "error_p95": _rounded(self.error_p95),
            "error_median_of_trunk": _rounded(self.error_share),
            "error_p95_of_trunk": _rounded(self.error_p95 / self.trunk),
            "error_of_trunk": _all_rounded(self.error_of_trunk),
            "depth_error_m": None if self.depth_error_m is None else _rounded(self.depth_error_m),
            "noise": _rounded(self.noise),
            "depth_noise_m": None if self.depth_noise_m is None else _rounded(self.depth_noise_m),
            "size_is_known": self.size_is_known,
            "lengths_m": {name: interval.to_data() for name, interval in self.lengths_m.items()},
            "camera_height_m": self.camera_height_m and self.camera_height_m.to_data(),
            "camera_pitch_deg": self.camera_pitch_deg and self.camera_pitch_deg.to_data(),
            "angle_sd_deg": _all_rounded(self.angle_sd_deg),
            "depth_sd_m": _all_rounded(self.depth_sd_m),
            "unseen": list(self.unseen),
            "limits_touched": _all_rounded(self.limits_touched),
            "frames": self.frames,
            "seconds": _rounded(self.seconds),
            "frames_per_s": _rounded(self.frames_per_s),
            "notes": list(self.notes),
        }


@dataclass(frozen=True)
class Retargeted:
    """The child in a recording, and its motion; the recording has t frames and k points."""

    recording: PointRecording
    spec: InfantSpec
    bundle: Bundle
    rate_hz: float
    """Frames per second, those of the recording."""
    qpos: FloatArray
    """Configurations of the bundle's model, shape (t, nq): z is upwards, and the floor is at 0."""
    camera_height_m: float | None
    """Height of the camera above the floor; None for points in space."""
    fitted: FloatArray
    """Where the points of the model are, as the recording has them: shape (t, k, 2) in pixels or (t, k, 3) in [m]; NaN
    for points that the model does not have."""
    account: Account
    """How far the motion can be trusted."""


def _rounded(value: float) -> float:
    return float(f"{value:.5g}")


def _all_rounded(values: Mapping[str, float]) -> dict[str, float]:
    return {name: _rounded(value) for name, value in values.items()}
