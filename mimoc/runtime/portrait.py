"""Pictures of an infant from outside."""

import weakref
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle import Bundle
from mimoc.errors import UnknownNameError
from mimoc.runtime.model import load_model
from mimoc.runtime.opengl import open_context
from mimoc.units import cm_to_m

Picture = npt.NDArray[np.uint8]
FloatArray = npt.NDArray[np.float64]

MAX_GEOMS = 2000
View = tuple[float, float]
"""Azimuth and elevation of where a camera looks, [deg]."""
FROM_THE_SIDE: View = (160.0, -15.0)
"""From before an infant, a little to its right and above."""
FROM_BEFORE: View = (180.0, -5.0)
MARGIN = 1.05
"""How much further away than needed to see all of it."""
ELBOW_ROOM = 0.5
"""Distance of infants in a row, as a share of their length."""


class Painter:
    """A camera that looks at one infant or at several, and the OpenGL context it needs."""

    def __init__(
        self, model: mujoco.MjModel, root_bodies: Sequence[str], width: int, height: int, view: View = FROM_THE_SIDE
    ):
        """Open an OpenGL context for pictures of this size, in pixels, of what hangs on these bodies.

        Raises:
            RenderingError: If there is no OpenGL here.
        """
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        self._model = model
        self._view = view
        self._seen = np.isin(model.body_rootid[model.geom_bodyid], [model.body(root).id for root in root_bodies])
        self._viewport = mujoco.MjrRect(0, 0, width, height)
        self._gl = open_context(width, height)
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        self._scene = mujoco.MjvScene(model, MAX_GEOMS)
        self._close = weakref.finalize(self, _free, self._context, self._gl)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)

    def paint(self, data: mujoco.MjData) -> Picture:
        """Return a picture of all of it, shape (height, width, 3)."""
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
        """Return a camera just far enough away to see everything from top to toe."""
        centres, radii = data.geom_xpos[self._seen], self._model.geom_rbound[self._seen]
        low, high = (centres - radii[:, None]).min(axis=0), (centres + radii[:, None]).max(axis=0)
        camera = mujoco.MjvCamera()
        camera.lookat[:] = (low + high) / 2
        camera.azimuth, camera.elevation = self._view
        camera.distance = MARGIN * self._distance_m(centres - camera.lookat, radii)
        return camera

    def _distance_m(self, centres: FloatArray, radii: FloatArray) -> float:
        """Return from how far the camera sees all of some balls, whose centres are told from where it looks at."""
        ahead, *across = _camera_axes(self._view) @ centres.T
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
    return _paint_once(Painter(model, [manifest.root_body], width, height), model, data)


def lineup(bundles: Sequence[Bundle], width: int = 640, height: int = 480) -> Picture:
    """Return a picture of several infants that stand in a row, to scale, shape (height, width, 3).

    Raises:
        RenderingError: If there is no OpenGL here.
    """
    first = bundles[0]
    row = mujoco.MjSpec.from_string(
        _text(first, first.manifest.scene), include=dict(first.files), assets=_assets(first)
    )
    for key in row.keys:
        row.delete(key)
    roots, y_m = [first.manifest.root_body], 0.0
    for number, (bundle, before) in enumerate(zip(bundles[1:], bundles, strict=False), start=1):
        y_m += cm_to_m(ELBOW_ROOM * (bundle.manifest.child.length_cm + before.manifest.child.length_cm) / 2)
        infant = mujoco.MjSpec.from_string(_text(bundle, "infant.xml"), assets=_assets(bundle))
        infant.option.integrator, infant.option.timestep = row.option.integrator, row.option.timestep
        prefix = f"infant {number}: "
        row.attach(infant, frame=row.worldbody.add_frame(pos=[0, y_m, 0]), prefix=prefix)
        roots.append(prefix + bundle.manifest.root_body)
    for light in row.lights:
        light.pos = light.pos + np.array([0.0, y_m / 2, 0.0])
    model = row.compile()
    return _paint_once(Painter(model, roots, width, height, FROM_BEFORE), model, mujoco.MjData(model))


def _paint_once(painter: Painter, model: mujoco.MjModel, data: mujoco.MjData) -> Picture:
    try:
        mujoco.mj_forward(model, data)
        return painter.paint(data)
    finally:
        painter.close()


def _text(bundle: Bundle, name: str) -> str:
    return bundle.files[name].decode()


def _assets(bundle: Bundle) -> dict[str, bytes]:
    return {name: content for name, content in bundle.files.items() if name.startswith("assets/")}


def _camera_axes(view: View) -> FloatArray:
    """Return the unit vectors ahead, right and up of the camera, in rows."""
    azimuth, elevation = np.radians(view)
    ahead = [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    right = [np.sin(azimuth), -np.cos(azimuth), 0.0]
    return np.array([ahead, right, np.cross(right, ahead)])


def _free(context: mujoco.MjrContext, gl: Any) -> None:
    gl.make_current()
    context.free()
    gl.free()
