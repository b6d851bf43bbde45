"""What a recording says of an infant's points, and how far those of a model are from it."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from mimoc.motion.point_recording import MINI_RGBD_CAMERA, Camera, FloatArray, PointRecording
from mimoc.movement.retargeting.skeleton import Pose

STRAIGHT_DOWN_DEG = 90.0
"""Pitch of a camera whose axis is vertical: the angle by which it looks down, below the horizon."""
OUTLIER = 6.0  # Distance in standard deviations of noise beyond which a point hardly counts (Geman and McClure 1987).


@dataclass(frozen=True)
class Channel:
    """Differences of one kind at f frames: model less recording, over the noise."""

    errors: FloatArray  # Shape (f, k, c).
    by_frame: FloatArray  # Derivatives by unknowns of the frame, shape (f, k, c, n).
    by_shared: FloatArray  # Derivatives by what all frames share, the height and then sizes, shape (f, k, c, 1 + s).
    weight: FloatArray  # Confidence, 0 where a point is not seen, shape (f, k).

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

    places: FloatArray  # Shape (t, k, 2) in pixels, or (t, k, 3) in [m].
    weight: FloatArray  # Shape (t, k).
    depth_m: FloatArray | None
    depth_weight: FloatArray | None
    camera: Camera
    noise: float  # Standard deviation of places.
    depth_noise_m: float
    turn: FloatArray  # Axes of the camera as rows, `camera_from_world`, shape (3, 3).

    @classmethod
    def of(
        cls, recording: PointRecording, noise: float, depth_noise_m: float, pitch_deg: float = STRAIGHT_DOWN_DEG
    ) -> Self:
        """Take the points of a recording; those without finite coordinates have no weight."""
        seen = np.asarray(np.isfinite(recording.positions).all(-1))
        weight = np.where(seen, np.clip(np.nan_to_num(recording.confidence), 0.0, 1.0), 0.0)
        depth_m = depth_weight = None
        if recording.unit == "px" and recording.depth_m is not None:
            known = np.isfinite(recording.depth_m)
            depth_m = np.where(known, recording.depth_m, 0.0)
            depth_weight = np.where(known, weight, 0.0)
        places = np.where(seen[..., None], recording.positions, 0.0)
        camera = recording.camera or MINI_RGBD_CAMERA
        turn = camera_from_world(pitch_deg)
        return cls(places, weight, depth_m, depth_weight, camera, noise, depth_noise_m, turn)

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

        A camera at the height h, whose axes are the rows of T, has the point p at (X, Y, Z) = T (p - (0, 0, h)): it
        sees it at the pixel (f_x X / Z + c_x, f_y Y / Z + c_y), and at the depth Z. Points in space are at
        p + (0, 0, h): then h is how much higher than ours their zero lies below the floor.

        Args:
            part: The frames.
            pose: Of these frames; its first k points are those of the recording.
            jacobian: Of these points, shape (3, f, k, n).
            height_m: The height h.
        """
        k = self.places.shape[1]
        points = pose.points_m[:, :, :k, 0]
        sizes = pose.points_m[:, :, :k, 1:]
        if self.in_space:
            yield self._places_in_space(part, points, sizes, jacobian, height_m)
            return
        seen = np.moveaxis(self.in_camera(np.moveaxis(points, 0, -1), height_m), -1, 0)
        by_frame = np.tensordot(self.turn, jacobian, 1)
        by_height = np.broadcast_to(-self.turn[:, 2][:, None, None, None], (*seen.shape, 1))
        by_shared = np.concatenate([by_height, np.tensordot(self.turn, sizes, 1)], axis=-1)
        yield self._pixels(part, seen, by_frame, by_shared)
        if self.depth_m is not None and self.depth_weight is not None:
            scale = self.depth_noise_m
            errors = (seen[2] - self.depth_m[part])[..., None]
            frame, shared = by_frame[2][:, :, None], by_shared[2][:, :, None]
            yield Channel(errors / scale, frame / scale, shared / scale, self.depth_weight[part])

    def in_camera(self, points_m: FloatArray, height_m: float) -> FloatArray:
        """Return where points in the world are in the frame of the camera; components come last."""
        return (points_m - np.array([0.0, 0.0, height_m])) @ self.turn.T

    def project(self, points_m: FloatArray, height_m: float) -> FloatArray:
        """Return where points are as the recording has them; components of the points come last."""
        if self.in_space:
            return points_m + np.array([0.0, 0.0, height_m])
        return self.camera.project(self.in_camera(points_m, height_m))

    def _pixels(self, part: slice, seen: FloatArray, by_frame: FloatArray, by_shared: FloatArray) -> Channel:
        """Return differences in the picture; *seen* and its derivatives are in the frame of the camera."""
        errors, frame, shared = [], [], []
        for axis in (0, 1):
            focal, centre = self.camera.focal_px[axis], self.camera.centre_px[axis]
            across = focal / seen[2] / self.noise
            inward = across * seen[axis] / seen[2]
            errors.append(across * seen[axis] + (centre - self.places[part, :, axis]) / self.noise)
            frame.append(across[..., None] * by_frame[axis] - inward[..., None] * by_frame[2])
            shared.append(across[..., None] * by_shared[axis] - inward[..., None] * by_shared[2])
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


def camera_from_world(pitch_deg: float) -> FloatArray:
    """Return the axes of a camera as rows: to the right, downwards in its picture, and into it.

    The upper edge of its picture is level and looks to world y. With the pitch t, the axes are (1, 0, 0),
    (0, -sin t, -cos t) and (0, cos t, -sin t).
    """
    sine, cosine = np.sin(np.radians(pitch_deg)), np.cos(np.radians(pitch_deg))
    return np.array([[1.0, 0.0, 0.0], [0.0, -sine, -cosine], [0.0, cosine, -sine]])
