"""The cameras of an infant's eyes, and the OpenGL context they draw in."""

import math
from collections.abc import Collection, Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.errors import RenderingError
from mimoc.render.opengl import Finalizer, open_context
from mimoc.render.quality import Setting, drawn_with

Drawn = npt.NDArray[np.uint8]
"""Shape (cameras, height, width, 3)."""

LEAST_SLICES = 12
SLICES_PER_ROOT_PX = 2.0
"""Sides of drawn balls and limbs, per square root of the picture's height in pixels, at most what the model asks for:
the outline of a limb half as wide as the picture is then within a third of a pixel of a round one.
`benchmarks/vision.py` measures the time that this saves and the difference in the pictures."""
STACKS_PER_SLICE = 2 / 3
HIDDEN_GROUP = 5
"""One of the groups of geoms that MuJoCo does not draw unless asked to."""
SPARE_GEOMS = 100
"""Room in a scene for what is drawn besides the model's geoms and sites."""


class Eyes:
    """Some cameras of one model, which draw as little as possible: no shadows, reflections, or smooth edges."""

    def __init__(
        self, model: mujoco.MjModel, cameras: Sequence[str], width_px: int, height_px: int, unseen: Collection[str] = ()
    ):
        """Open an OpenGL context for pictures of this size.

        Args:
            model: The model, whose geoms and colours may change later.
            cameras: Names in the model.
            width_px: Of a picture.
            height_px: Of a picture.
            unseen: Bodies that are not drawn.

        Raises:
            RenderingError: If there is no OpenGL here, or none that draws such large pictures.
        """
        self._names, self._unseen_bodies = tuple(cameras), unseen
        self._views = [mujoco.MjrRect(0, row * height_px, width_px, height_px) for row in range(len(cameras))]
        self._whole = mujoco.MjrRect(0, 0, width_px, height_px * len(cameras))
        self._shape = len(cameras), height_px, width_px, 3
        self._options, self._perturbation = mujoco.MjvOption(), mujoco.MjvPerturb()
        self._gl = open_context(self._whole.width, self._whole.height)
        self._set_up(model)

    def __call__(self, data: mujoco.MjData) -> Drawn:
        """Return what the cameras draw."""
        self._gl.make_current()
        for camera, view in zip(self._cameras, self._views, strict=True):
            self._aim(camera, data)
            mujoco.mjr_render(view, self._scene, self._context)
        from_below = np.empty((self._whole.height, self._whole.width, 3), np.uint8)
        mujoco.mjr_readPixels(from_below, None, self._whole, self._context)
        return from_below.reshape(self._shape)[:, ::-1]

    def use_model(self, model: mujoco.MjModel) -> None:
        """Draw another model from now on, in which cameras and bodies have the same names.

        In an OpenGL context that is in use, this takes a tenth of the time that new eyes take.

        Raises:
            RenderingError: If OpenGL has no room for it.
        """
        self._gl.make_current()
        self._close.detach()
        self._context.free()
        self._set_up(model)

    def close(self) -> None:
        """Free the OpenGL context; closing twice is fine."""
        self._close()

    def _set_up(self, model: mujoco.MjModel) -> None:
        """Make what drawing a model needs, in the current OpenGL context."""
        self._model = model
        self._cameras = [_fixed_camera(model.camera(name).id) for name in self._names]
        bodies = enumerate(model.geom_bodyid)
        self._unseen = [geom for geom, body in bodies if model.body(body).name in self._unseen_bodies]
        self._scene = mujoco.MjvScene(model, model.ngeom + model.nsite + SPARE_GEOMS)
        for flag in (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION):
            self._scene.flags[flag] = 0
        self._context = _make_context(model, self._whole, self._shape[1], self._gl)
        self._close = Finalizer(self, _free, self._context, self._gl)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)

    def _aim(self, camera: mujoco.MjvCamera, data: mujoco.MjData) -> None:
        """Fill the scene for a camera, whose light goes with it."""
        mujoco.mjv_updateCamera(self._model, data, camera, self._scene)
        everything, groups = mujoco.mjtCatBit.mjCAT_ALL, self._model.geom_group
        usual = groups[self._unseen]
        groups[self._unseen] = HIDDEN_GROUP
        try:
            mujoco.mjv_updateScene(
                self._model, data, self._options, self._perturbation, camera, everything, self._scene
            )
        finally:
            groups[self._unseen] = usual


def _fixed_camera(index: int) -> mujoco.MjvCamera:
    camera = mujoco.MjvCamera()
    camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, index
    return camera


def _make_context(model: mujoco.MjModel, whole: mujoco.MjrRect, height_px: int, gl: Any) -> mujoco.MjrContext:
    """Return MuJoCo's context to draw a model into a buffer of exactly the size of all pictures.

    Raises:
        RenderingError: If OpenGL has no room for that; its context is freed then.
    """
    try:
        with drawn_with(_lean(model, whole, height_px)):
            return mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50)
    except mujoco.FatalError as error:
        gl.free()
        size = f"{whole.width} x {whole.height} pixels"
        raise RenderingError(f"OpenGL cannot draw {size} here ({error}); choose smaller pictures") from None


def _lean(model: mujoco.MjModel, whole: mujoco.MjrRect, height_px: int) -> tuple[Setting, ...]:
    """Return the settings of a model with which MuJoCo makes a context for pictures of a height, and no more."""
    size, quality = model.vis.global_, model.vis.quality
    slices = max(LEAST_SLICES, math.ceil(SLICES_PER_ROOT_PX * math.sqrt(height_px)))
    return (
        (size, "offwidth", whole.width),
        (size, "offheight", whole.height),
        (quality, "shadowsize", 0),
        (quality, "offsamples", 0),
        (quality, "numslices", min(quality.numslices, slices)),
        (quality, "numstacks", min(quality.numstacks, round(slices * STACKS_PER_SLICE))),
    )


def _free(context: mujoco.MjrContext, gl: Any) -> None:
    gl.make_current()
    context.free()
    gl.free()
