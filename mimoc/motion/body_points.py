"""Where the points that cameras see are on a simulated infant, and what a camera above it sees of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.motion.labels import MINI_RGBD_POINTS, SIDES
from mimoc.motion.point_recording import MINI_RGBD_CAMERA, Camera, FloatArray, PointRecording

HEAD_POINT = 0.54
"""Height of the point `head` above the skull's centre, in half heights of the skull (from fits of a prototype; D)."""
_BODIES = {"hand": ("fingers", "mfknuckle"), "foot": ("toes",)}
"""Bodies whose origins are the points that BODY_25 lacks; the first that the infant has counts. The hands of an infant
have `fingers` if they are mittens, or else `mfknuckle`."""
_MIDDLE = {"nose": "Nose", "neck": "Neck", "mid_hip": "MidHip"}
"""Names of points without a side in BODY_25."""


@dataclass(frozen=True, slots=True)
class BodyPoint:
    """A point that is fixed to a body."""

    body: int
    offset_m: FloatArray  # In the body's frame, shape (3,).


def body_points(model: mujoco.MjModel, names: Sequence[str], prefix: str = "") -> list[BodyPoint | None]:
    """Return where points are on an infant, whose names in the model begin with a prefix if it shares a world.

    None stands for points of parts that it does not have.
    """
    return [_point(model, name, prefix) for name in names]


def film(
    model: mujoco.MjModel,
    qpos: FloatArray,
    rate_hz: float,
    names: Sequence[str] = MINI_RGBD_POINTS,
    camera: Camera = MINI_RGBD_CAMERA,
    height_m: float = 1.08,
) -> PointRecording:
    """Return what a camera that looks straight down from above the origin sees, its y axis pointing to world -y.

    Args:
        model: The infant; all *names* must be on it.
        qpos: Its configurations, shape (t, nq).
        rate_hz: Frames per second.
        names: Points to see.
        camera: The camera, without noise or rounding.
        height_m: Its height above the floor.
    """
    places_m = locate(model, qpos, names)
    seen = np.stack([places_m[..., 0], -places_m[..., 1], height_m - places_m[..., 2]], axis=-1)
    confidence = np.ones(places_m.shape[:2])
    return PointRecording(
        "simulated", rate_hz, tuple(names), camera.project(seen), confidence, camera, depth_m=seen[..., 2]
    )


def locate(model: mujoco.MjModel, qpos: FloatArray, names: Sequence[str], prefix: str = "") -> FloatArray:
    """Return where points are in the world at each configuration, shape (t, k, 3); NaN for parts it does not have."""
    points = body_points(model, names, prefix)
    data = mujoco.MjData(model)
    known = [index for index, point in enumerate(points) if point]
    bodies = [point.body for point in points if point]
    offsets_m = np.array([point.offset_m for point in points if point])
    places_m = np.full((len(qpos), len(names), 3), np.nan)
    for places, configuration in zip(places_m, qpos, strict=True):
        data.qpos[:] = configuration
        mujoco.mj_kinematics(model, data)
        world_offsets_m = np.einsum("kij,kj->ki", data.xmat[bodies].reshape(-1, 3, 3), offsets_m)
        places[known] = data.xpos[bodies] + world_offsets_m
    return places_m


def _point(model: mujoco.MjModel, name: str, prefix: str) -> BodyPoint | None:
    side, _, part = name.partition("_")
    if name == "head":
        skull = _find(model, mujoco.mjtObj.mjOBJ_GEOM, f"{prefix}head")
        if skull < 0:
            return None
        half_height_m = np.array([0.0, 0.0, model.geom_size[skull].max()])
        return BodyPoint(int(model.geom_bodyid[skull]), model.geom_pos[skull] + HEAD_POINT * half_height_m)
    if side in SIDES and part in _BODIES:
        bodies = (_find(model, mujoco.mjtObj.mjOBJ_BODY, f"{prefix}{side}_{body}") for body in _BODIES[part])
        return next((BodyPoint(body, np.zeros(3)) for body in bodies if body >= 0), None)
    label = _MIDDLE.get(name) or side[:1].upper() + part.title().replace("_", "")  # `left_big_toe` is `LBigToe`.
    site = _find(model, mujoco.mjtObj.mjOBJ_SITE, f"{prefix}BODY_25:{label}")
    return BodyPoint(int(model.site_bodyid[site]), model.site_pos[site].copy()) if site >= 0 else None


def _find(model: mujoco.MjModel, kind: mujoco.mjtObj, name: str) -> int:
    return mujoco.mj_name2id(model, kind, name)
