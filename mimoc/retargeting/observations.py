"""What a recording says of an infant's points, and how far those of a model are from it."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from mimoc.motion.point_recording import MINI_RGBD_CAMERA, Camera, FloatArray, PointRecording
from mimoc.retargeting.skeleton import Pose

OUTLIER = 6.0
"""Distance in standard deviations of noise beyond which a point hardly counts (Geman and McClure 1987)."""


@dataclass(frozen=True)
class Channel:
    """Differences of one kind at f frames: model less recording, over the noise."""

    errors: FloatArray
    """Shape (f, k, c)."""
    by_frame: FloatArray
    """Derivatives by unknowns of the frame, shape (f, k, c, n)."""
    by_shared: FloatArray
    """Derivatives by what all frames share, the height and then sizes, shape (f, k, c, 1 + s)."""
    weight: FloatArray
    """Confidence, 0 where a point is not seen, shape (f, k)."""

    def robust(self, outlier: float) -> tuple[FloatArray, float]:
        """Return the weight of each point, shape (f, k), and the cost: sum w r^2 / (1 + r^2 / c^2).

        Its derivative is that of squares with the weight w / (1 + r^2 / c^2)^2, c the distance of an outlier.
        """
        squares = np.einsum("fkc,fkc->fk", self.errors, self.errors)
        share = 1 / (1 + squares / outlier**2)
        return self.weight * share**2, float((self.weight * squares * share).sum())


@dataclass(frozen=True)
class Observed:
    """The points of a recording that a model has, without gaps: these have no weight."""

    places: FloatArray
    """Shape (t, k, 2) in pixels, or (t, k, 3) in [m]."""
    weight: FloatArray
    """Shape (t, k)."""
    depth_m: FloatArray | None
    depth_weight: FloatArray | None
    camera: Camera
    noise: float
    """Standard deviation of places."""
    depth_noise_m: float

    @classmethod
    def of(cls, recording: PointRecording, noise: float, depth_noise_m: float) -> Self:
        """Take the points of a recording; those without finite coordinates have no weight."""
        seen = np.asarray(np.isfinite(recording.positions).all(-1))
        weight = np.where(seen, np.clip(np.nan_to_num(recording.confidence), 0.0, 1.0), 0.0)
        depth_m = depth_weight = None
        if recording.unit == "px" and recording.depth_m is not None:
            known = np.isfinite(recording.depth_m)
            depth_m, depth_weight = np.where(known, recording.depth_m, 0.0), np.where(known, weight, 0.0)
        places = np.where(seen[..., None], recording.positions, 0.0)
        return cls(places, weight, depth_m, depth_weight, recording.camera or MINI_RGBD_CAMERA, noise, depth_noise_m)

    @property
    def in_space(self) -> bool:
        """Whether places are in [m]."""
        return self.places.shape[-1] == 3

    @property
    def tells_size(self) -> bool:
        """Whether there is more than what one camera sees."""
        return self.in_space or self.depth_m is not None

    def channels(self, part: slice, pose: Pose, jacobian: FloatArray, height_m: float) -> Iterator[Channel]:
        """Yield differences and derivatives at some frames.

        A camera at the height h that looks straight down sees the point p at X = x, Y = -y, Z = h - z of its frame, at
        the pixel (f_x X / Z + c_x, f_y Y / Z + c_y), and at the depth Z. Points in space are at p + (0, 0, h): then h
        is how much higher than ours their zero lies below the floor.

        Args:
            part: The frames.
            pose: Of these frames; its first k points are those of the recording.
            jacobian: Of these points, shape (3, f, k, n).
            height_m: The height h.
        """
        k = self.places.shape[1]
        points, sizes = pose.points_m[:, :, :k, 0], pose.points_m[:, :, :k, 1:]
        if self.in_space:
            yield self._places_in_space(part, points, sizes, jacobian, height_m)
        else:
            yield self._pixels(part, points, sizes, jacobian, height_m)
        if self.depth_m is not None and self.depth_weight is not None:
            errors = (height_m - points[2] - self.depth_m[part])[..., None]
            shared = np.concatenate([np.ones((*errors.shape[:2], 1)), -sizes[2]], axis=-1)[:, :, None]
            scale = self.depth_noise_m
            yield Channel(errors / scale, -jacobian[2][:, :, None] / scale, shared / scale, self.depth_weight[part])

    def project(self, points_m: FloatArray, height_m: float) -> FloatArray:
        """Return where points are as the recording has them; components of the points come last."""
        if self.in_space:
            return points_m + np.array([0.0, 0.0, height_m])
        seen = np.stack([points_m[..., 0], -points_m[..., 1], height_m - points_m[..., 2]], axis=-1)
        return self.camera.project(seen)

    def _pixels(
        self, part: slice, points: FloatArray, sizes: FloatArray, jacobian: FloatArray, height_m: float
    ) -> Channel:
        depth = height_m - points[2]
        errors, frame, shared = [], [], []
        for axis, sign in ((0, 1.0), (1, -1.0)):
            focal, centre = self.camera.focal_px[axis], self.camera.centre_px[axis]
            across = sign * focal / depth / self.noise
            inward = across * points[axis] / depth
            errors.append(across * points[axis] + (centre - self.places[part, :, axis]) / self.noise)
            frame.append(across[..., None] * jacobian[axis] + inward[..., None] * jacobian[2])
            by_size = across[..., None] * sizes[axis] + inward[..., None] * sizes[2]
            shared.append(np.concatenate([-inward[..., None], by_size], axis=-1))
        return Channel(np.stack(errors, 2), np.stack(frame, 2), np.stack(shared, 2), self.weight[part])

    def _places_in_space(
        self, part: slice, points: FloatArray, sizes: FloatArray, jacobian: FloatArray, height_m: float
    ) -> Channel:
        errors = np.moveaxis(points, 0, -1) + np.array([0.0, 0.0, height_m]) - self.places[part]
        by_height = np.zeros((*errors.shape, 1))
        by_height[:, :, 2] = 1.0
        shared = np.concatenate([by_height, np.moveaxis(sizes, 0, 2)], axis=-1)
        return Channel(
            errors / self.noise, np.moveaxis(jacobian, 0, 2) / self.noise, shared / self.noise, self.weight[part]
        )
