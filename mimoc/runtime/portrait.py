"""Pictures of an infant from outside."""

import weakref
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle import Bundle
from mimoc.errors import UnknownNameError
from mimoc.runtime.model import load_model
from mimoc.runtime.opengl import open_context

Picture = npt.NDArray[np.uint8]
FloatArray = npt.NDArray[np.float64]

MAX_GEOMS = 2000
AZIMUTH_DEG, ELEVATION_DEG = 160.0, -15.0
"""From where an infant is looked at: from before it and a little above."""
MARGIN = 1.05
"""How much further away than needed to see all of it."""


class Painter:
    """A camera that looks at one infant, and the OpenGL context it needs."""

    def __init__(self, model: mujoco.MjModel, root_body: str, width: int, height: int):
        """Open an OpenGL context for pictures of this size, in pixels.

        Raises:
            RenderingError: If there is no OpenGL here.
        """
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        self._model = model
        self._root = model.body(root_body).id
        self._viewport = mujoco.MjrRect(0, 0, width, height)
        self._gl = open_context(width, height)
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        self._scene = mujoco.MjvScene(model, MAX_GEOMS)
        self._close = weakref.finalize(self, _free, self._context, self._gl)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)

    def paint(self, data: mujoco.MjData) -> Picture:
        """Return a picture of the whole infant, shape (height, width, 3)."""
        self._gl.make_current()
        camera, options, perturbation = self._camera(data), mujoco.MjvOption(), mujoco.MjvPerturb()
        everything = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateCamera(self._model, data, camera, self._scene)  # Or shadows are those of the camera before.
        mujoco.mjv_updateScene(self._model, data, options, perturbation, camera, everything, self._scene)
        mujoco.mjr_render(self._viewport, self._scene, self._context)
        upside_down = np.empty((self._viewport.height, self._viewport.width, 3), np.uint8)
        mujoco.mjr_readPixels(upside_down, None, self._viewport, self._context)
        return upside_down[::-1].copy()

    def close(self) -> None:
        """Free the OpenGL context; closing twice is fine."""
        self._close()

    def _camera(self, data: mujoco.MjData) -> mujoco.MjvCamera:
        """Return a camera just far enough away to see the infant from top to toe."""
        mine = self._model.body_rootid[self._model.geom_bodyid] == self._root
        centres, radii = data.geom_xpos[mine], self._model.geom_rbound[mine]
        low, high = (centres - radii[:, None]).min(axis=0), (centres + radii[:, None]).max(axis=0)
        camera = mujoco.MjvCamera()
        camera.lookat[:] = (low + high) / 2
        camera.azimuth, camera.elevation = AZIMUTH_DEG, ELEVATION_DEG
        camera.distance = MARGIN * self._distance_m(centres - camera.lookat, radii)
        return camera

    def _distance_m(self, centres: FloatArray, radii: FloatArray) -> float:
        """Return from how far the camera sees all of some balls, whose centres are told from where it looks at."""
        ahead, *across = _camera_axes() @ centres.T
        half_height = np.tan(np.radians(self._model.vis.global_.fovy) / 2)
        half_angles = np.arctan([half_height * self._viewport.width / self._viewport.height, half_height])
        needed = [
            np.abs(offset) / np.tan(half) + radii / np.sin(half) - ahead
            for offset, half in zip(across, half_angles, strict=True)
        ]
        return float(np.max(needed))


def portrait(bundle: Bundle, pose: str | None = None, width: int = 640, height: int = 480) -> npt.NDArray[np.uint8]:
    """Return a picture of an infant in a pose, shape (height, width, 3).

    Raises:
        UnknownNameError: If the bundle has no such pose.
        RenderingError: If there is no OpenGL here.
    """
    manifest = bundle.manifest
    pose = pose or manifest.pose
    if pose not in manifest.poses:
        raise UnknownNameError("pose", pose, manifest.poses)
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    painter = Painter(model, manifest.root_body, width, height)
    try:
        return painter.paint(data)
    finally:
        painter.close()


def _camera_axes() -> FloatArray:
    """Return the unit vectors ahead, right and up of the camera, in rows."""
    azimuth, elevation = np.radians([AZIMUTH_DEG, ELEVATION_DEG])
    ahead = [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    right = [np.sin(azimuth), -np.cos(azimuth), 0.0]
    return np.array([ahead, right, np.cross(right, ahead)])


def _free(context: mujoco.MjrContext, gl: Any) -> None:
    gl.make_current()
    context.free()
    gl.free()
