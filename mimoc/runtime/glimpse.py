"""What an infant in a pose would see, with several kinds of sight."""

from collections.abc import Collection, Sequence
from contextlib import closing

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle import Bundle
from mimoc.errors import UnknownNameError
from mimoc.runtime.model import load_model
from mimoc.runtime.poses import pose_of
from mimoc.runtime.senses.eyes import Drawn, Eyes
from mimoc.runtime.senses.vision import filters, perceive
from mimoc.schema.manifest import VisionEntry


def glimpse(
    bundle: Bundle, sights: Sequence[Sequence[VisionEntry]], pose: str | None = None, down_deg: float = 0.0
) -> list[list[npt.NDArray[np.uint8]]]:
    """Return what each of some sights makes of one and the same view, shape (height, width, 3) each.

    Args:
        bundle: The infant; it need not have a sense of vision.
        sights: In rows; all of one eye, size and supersampling.
        pose: Another than the bundle's own.
        down_deg: How far the eye looks down from straight ahead.

    Raises:
        UnknownNameError: If the infant has no such pose or no such eye.
        RenderingError: If there is no OpenGL here.
    """
    model = load_model(bundle)
    first, pose = sights[0][0], pose_of(bundle.manifest, pose)
    (name,) = first.cameras
    _require("camera of this infant", name, [model.camera(index).name for index in range(model.ncam)])
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    data.camera(name).xmat = _lowered(data.camera(name).xmat, down_deg)
    drawn, fovy_deg = _draw(model, data, first), float(model.camera(name).fovy[0])
    return [[perceive(drawn, filters(sight, fovy_deg))[0] for sight in row] for row in sights]


def _require(kind: str, name: str, known: Collection[str]) -> None:
    if name not in known:
        raise UnknownNameError(kind, name, known)


def _draw(model: mujoco.MjModel, data: mujoco.MjData, sight: VisionEntry) -> Drawn:
    larger = sight.supersample
    size_px = larger * sight.width_px, larger * sight.height_px
    with closing(Eyes(model, sight.cameras, *size_px, sight.unseen)) as eyes:
        return eyes(data)


def _lowered(world_from_camera: npt.NDArray[np.float64], down_deg: float) -> npt.NDArray[np.float64]:
    """Return the rotation of a camera, nine numbers, after it has turned downwards about its x axis, on its right."""
    cos, sin = np.cos(np.radians(down_deg)), np.sin(np.radians(down_deg))
    camera_from_lowered = [[1, 0, 0], [0, cos, sin], [0, -sin, cos]]
    return (world_from_camera.reshape(3, 3) @ camera_from_lowered).ravel()
