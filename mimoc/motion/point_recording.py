"""Recordings of points on an infant who was filmed: pixels of a camera, or places in space."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, Self, get_args

import numpy as np
import numpy.typing as npt
from scipy.signal import butter, sosfiltfilt

FloatArray = npt.NDArray[np.float64]
_PADDING = 9
"""Frames that are mirrored at both ends before filtering: three times the taps of the filter, as SciPy has it."""
CUTOFF_HZ = 6.0
"""Faster than this, infants hardly move: the low-pass filter of all measures of movement (Butterworth, order 2,
forwards and backwards)."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A pinhole camera without distortion: x to the right, y downwards, z away from it.

    Example:
        >>> import mimoc
        >>> import numpy as np
        >>> camera = mimoc.Camera(focal_px=(600, 600), centre_px=(320, 240), size_px=(640, 480))
        >>> camera.project(np.array([0.1, 0.0, 1.0]))
        array([380., 240.])
    """

    focal_px: tuple[float, float]
    """Focal lengths along x and y."""
    centre_px: tuple[float, float]
    """Where its axis meets the picture, from the middle of the top left pixel."""
    size_px: tuple[int, int]

    def project(self, points_m: FloatArray) -> FloatArray:
        """Return where points are seen, shape (..., 2), [px]: f x / z + c.

        Args:
            points_m: In the camera's frame, shape (..., 3); z is positive.
        """
        return np.asarray(self.focal_px) * points_m[..., :2] / points_m[..., 2:] + np.asarray(self.centre_px)


MINI_RGBD_CAMERA = Camera((588.679058, 590.256901), (322.220482, 237.467860), (640, 480))
"""The camera of MINI-RGBD (Hesse et al. 2018), a Kinect: what is taken for a camera of which nothing is known."""


@dataclass(frozen=True)
class PointRecording:
    """Points on one infant over t frames; k points, each with a name.

    Example:
        >>> import mimoc
        >>> import numpy as np
        >>> names = "neck", "left_hip", "right_hip"
        >>> seen = np.array([[[320, 100], [350, 250], [290, 250]]] * 90, dtype=float)
        >>> mimoc.PointRecording("still", 30.0, names, seen, np.ones((90, 3))).trunk
        150.0
    """

    name: str
    rate_hz: float
    names: tuple[str, ...]
    """Names of the points, k of `mimoc.motion.labels.POINTS`."""
    positions: FloatArray
    """Shape (t, k, 2): pixels of the camera, x to the right, y downwards; or shape (t, k, 3): [m], z upwards. NaN where
    a point is not seen."""
    confidence: FloatArray
    """How surely each is seen, from 0 (not seen) to 1, shape (t, k)."""
    camera: Camera | None = None
    """The camera of pixels; None if it is not known, and of places in space."""
    depth_m: FloatArray | None = None
    """Distance of each point along the camera's axis, shape (t, k); NaN where it is not known."""
    notes: tuple[str, ...] = ()
    """What had to be assumed, one line each."""

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self.positions)

    @property
    def unit(self) -> Literal["px", "m"]:
        """Unit of the positions."""
        return "px" if self.positions.shape[-1] == 2 else "m"

    @property
    def hips(self) -> FloatArray:
        """The middle of the hips, shape (t, 2) or (t, 3)."""
        return (self.path("left_hip") + self.path("right_hip")) / 2

    @property
    def trunk(self) -> float:
        """Median distance from the neck to the middle of the hips, in the unit of positions."""
        return float(np.nanmedian(np.linalg.norm(self.path("neck") - self.hips, axis=1)))

    def path(self, name: str) -> FloatArray:
        """Return the positions of a point, shape (t, 2) or (t, 3)."""
        return self.positions[:, self.names.index(name)]

    def window(self, start: int, stop: int, every: int = 1) -> Self:
        """Return some frames of it, or every second, third and so on of these."""
        part = slice(start, stop, every)
        depth_m = None if self.depth_m is None else self.depth_m[part]
        changes: dict[str, Any] = {"positions": self.positions[part], "confidence": self.confidence[part]}
        return replace(self, rate_hz=self.rate_hz / every, depth_m=depth_m, **changes)

    def select(self, names: Sequence[str]) -> Self:
        """Return the recording of some of its points, in this order."""
        index = [self.names.index(name) for name in names]
        depth_m = None if self.depth_m is None else self.depth_m[:, index]
        changes: dict[str, Any] = {"positions": self.positions[:, index], "confidence": self.confidence[:, index]}
        return replace(self, names=tuple(names), depth_m=depth_m, **changes)

    def filled(self) -> Self:
        """Return it with what is not seen interpolated linearly in time; a point that is never seen stays NaN.

        Confidence stays 0 there.
        """
        depth_m = None if self.depth_m is None else _filled(self.depth_m)
        return replace(self, positions=_filled(self.positions), depth_m=depth_m)

    def smoothed(self, cutoff_hz: float = CUTOFF_HZ) -> Self:
        """Return it, gaps filled, without what is faster than infants move, nor the steps of whole pixels.

        What has fewer than two frames in each cycle of the cutoff is only filled.
        """
        whole = self.filled()
        depth_m = None if whole.depth_m is None else low_passed(whole.depth_m, self.rate_hz, cutoff_hz)
        return replace(whole, positions=low_passed(whole.positions, self.rate_hz, cutoff_hz), depth_m=depth_m)


def low_passed(values: FloatArray, rate_hz: float, cutoff_hz: float = CUTOFF_HZ) -> FloatArray:
    """Return values, whose first axis is time, without what is faster than infants move, and without a delay.

    Values that are fewer than two, or have fewer than two frames in each cycle of the cutoff, stay as they are.
    """
    if rate_hz <= 2 * cutoff_hz or len(values) < 2:
        return values
    sections: Any = butter(2, cutoff_hz, fs=rate_hz, output="sos")
    return np.asarray(sosfiltfilt(sections, values, axis=0, padlen=min(_PADDING, len(values) - 1)))


def _filled(values: FloatArray) -> FloatArray:
    columns = values.reshape(len(values), -1).copy()
    time = np.arange(len(values))
    for column in columns.T:
        known = np.isfinite(column)
        if known.any() and not known.all():
            column[~known] = np.interp(time[~known], time[known], column[known])
    return columns.reshape(values.shape)


View = Literal["front", "back", "mirrored", "swapped"]
VIEWS: tuple[View, ...] = get_args(View)
Up = Literal["x", "y", "z", "-x", "-y", "-z"]
UPS: tuple[Up, ...] = get_args(Up)


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """What the files do not say, or say wrongly."""

    rate_hz: float | None = None
    """Frames per second; None if the files say it."""
    camera: Camera | None = None
    """The camera of pixels; None if the files say it, or nobody knows."""
    infant: int | str | None = None
    """Which of several persons is the infant: its identity in the files or, where they have none, its number in the
    first frame with several, from 0. None is the largest."""
    names: Mapping[str, str] = field(default_factory=dict)
    """Mimoc's names by the labels of the files, for those that it does not know or gets wrong."""
    view: View | None = "front"
    """What the camera sees of an infant: its `front`; its `back` where it lies on its belly; `mirrored` if the picture
    is, or y counts upwards; `swapped` if left and right are exchanged. None is for points that were checked before."""
    min_score: float | None = None
    """Confidence below which a point is taken not to be seen; None is what the format's own programs go by."""

    picture_px: tuple[int, int] | None = None
    """Width and height of the picture, for points that are shares of it; None if the camera says it, or the files."""
    up: Up | None = None
    """Which axis of places in space points upwards; None is z, where the format does not say it."""

    def least_score(self, usual: float) -> float:
        """Return the confidence below which a point is taken not to be seen, by what is usual in a format."""
        return usual if self.min_score is None else self.min_score
