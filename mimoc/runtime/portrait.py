"""Pictures of an infant from outside."""

import weakref
from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle import Bundle
from mimoc.runtime.beads import Beads, add_beads, join_beads, scene_for, skin_beads
from mimoc.runtime.model import load_model
from mimoc.runtime.opengl import open_context
from mimoc.runtime.poses import pose_of
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
        self,
        model: mujoco.MjModel,
        root_bodies: Sequence[str],
        width: int,
        height: int,
        view: View = FROM_THE_SIDE,
    ):
        """Open an OpenGL context for pictures of what hangs on some bodies.

        Args:
            model: The model.
            root_bodies: Names of the bodies.
            width: In pixels.
            height: In pixels.
            view: From where they are seen.

        Raises:
            RenderingError: If there is no OpenGL here.
        """
        model.vis.global_.offwidth, model.vis.global_.offheight = width, height
        self._model = model
        self.view = view
        self._seen = np.isin(model.body_rootid[model.geom_bodyid], [model.body(root).id for root in root_bodies])
        self._viewport = mujoco.MjrRect(0, 0, width, height)
        self._gl = open_context(width, height)
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        self._scene = mujoco.MjvScene(model, MAX_GEOMS)
        self._close = weakref.finalize(self, _free, self._context, self._gl)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)

    def paint(self, data: mujoco.MjData, beads: Beads | None = None) -> Picture:
        """Return a picture of all of it, and of some beads, shape (height, width, 3)."""
        self._gl.make_current()
        scene = self._scene if beads is None else scene_for(beads, self._model, MAX_GEOMS)
        camera, options, perturbation = self._camera(data), mujoco.MjvOption(), mujoco.MjvPerturb()
        everything = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateCamera(self._model, data, camera, scene)  # Or shadows are those of the camera before.
        mujoco.mjv_updateScene(self._model, data, options, perturbation, camera, everything, scene)
        if beads is not None:
            add_beads(scene, beads)
        mujoco.mjr_render(self._viewport, scene, self._context)
        upside_down = np.empty((self._viewport.height, self._viewport.width, 3), np.uint8)
        mujoco.mjr_readPixels(upside_down, None, self._viewport, self._context)
        return upside_down[::-1].copy()

    def close(self) -> None:
        """Free the OpenGL context; closing twice is fine."""
        self._close()

    def place(self, data: mujoco.MjData) -> FloatArray:
        """Return where the camera is, shape (3,), in the world, [m]."""
        camera = self._camera(data)
        return camera.lookat - camera.distance * _camera_axes(self.view)[0]

    def _camera(self, data: mujoco.MjData) -> mujoco.MjvCamera:
        """Return a camera just far enough away to see everything from top to toe."""
        centres, radii = data.geom_xpos[self._seen], self._model.geom_rbound[self._seen]
        low, high = (centres - radii[:, None]).min(axis=0), (centres + radii[:, None]).max(axis=0)
        camera = mujoco.MjvCamera()
        camera.lookat[:] = (low + high) / 2
        camera.azimuth, camera.elevation = self.view
        camera.distance = MARGIN * self._distance_m(centres - camera.lookat, radii)
        return camera

    def _distance_m(self, centres: FloatArray, radii: FloatArray) -> float:
        """Return from how far the camera sees all of some balls, whose centres are told from where it looks at."""
        ahead, *across = _camera_axes(self.view) @ centres.T
        half_height = np.tan(np.radians(self._model.vis.global_.fovy) / 2)
        half_angles = np.arctan([half_height * self._viewport.width / self._viewport.height, half_height])
        needed = [
            np.abs(offset) / np.tan(half) + radii / np.sin(half) - ahead
            for offset, half in zip(across, half_angles, strict=True)
        ]
        return float(np.max(needed))


def towards(view: View, data: mujoco.MjData, body: str) -> View:
    """Return a view as a body sees it that is turned about the vertical and may lie on its back or its face."""
    across_x, across_y = data.body(body).xmat.reshape(3, 3)[:2, 1]  # Its left, which stays level.
    azimuth, elevation = view
    return azimuth + float(np.degrees(np.arctan2(-across_x, across_y))), elevation


def portrait(
    bundle: Bundle, pose: str | None = None, width: int = 640, height: int = 480, *, skin: bool = False
) -> Picture:
    """Return a picture of an infant in a pose, shape (height, width, 3).

    Args:
        bundle: The infant.
        pose: A keyframe; else the bundle's own.
        width: In pixels.
        height: In pixels.
        skin: Whether to show the points of its skin, and which of them feel something.

    Raises:
        UnknownNameError: If the bundle has no such pose.
        RenderingError: If there is no OpenGL here, or no skin to show.
    """
    manifest = bundle.manifest
    pose = pose_of(manifest, pose)
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    beads = skin_beads(bundle, model, data) if skin else None
    view = towards(FROM_THE_SIDE, data, manifest.root_body)
    return _paint_once(Painter(model, [manifest.root_body], width, height, view), data, beads)


def lineup(bundles: Sequence[Bundle], width: int = 640, height: int = 480, *, skin: bool = False) -> Picture:
    """Return a picture of several infants that stand in a row, to scale, shape (height, width, 3).

    Args:
        bundles: The infants, from the left.
        width: In pixels.
        height: In pixels.
        skin: Whether to show the points of their skin, and which of them feel something.

    Raises:
        RenderingError: If there is no OpenGL here, or no skin to show.
    """
    places_m = _places_m(bundles)
    model, roots = _in_a_row(bundles, places_m)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    beads = join_beads(map(_standing_beads, bundles, places_m)) if skin else None
    return _paint_once(Painter(model, roots, width, height, FROM_BEFORE), data, beads)


def _places_m(bundles: Sequence[Bundle]) -> list[float]:
    """Return where each infant stands in a row, along y."""
    halves_m = [cm_to_m(ELBOW_ROOM * bundle.manifest.child.length_cm / 2) for bundle in bundles]
    return list(accumulate((half + before for half, before in zip(halves_m[1:], halves_m, strict=False)), initial=0.0))


def _in_a_row(bundles: Sequence[Bundle], places_m: Sequence[float]) -> tuple[mujoco.MjModel, list[str]]:
    """Return a model of several infants in the world of the first, and the roots of their bodies."""
    first = bundles[0]
    row = mujoco.MjSpec.from_string(
        _text(first, first.manifest.scene), include=dict(first.files), assets=_assets(first)
    )
    for key in row.keys:
        row.delete(key)
    roots = [first.manifest.root_body]
    for number, (bundle, y_m) in enumerate(zip(bundles[1:], places_m[1:], strict=True), start=1):
        infant = mujoco.MjSpec.from_string(_text(bundle, "infant.xml"), assets=_assets(bundle))
        infant.option.integrator, infant.option.timestep = row.option.integrator, row.option.timestep
        prefix = f"infant {number}: "
        row.attach(infant, frame=row.worldbody.add_frame(pos=[0, y_m, 0]), prefix=prefix)
        roots.append(prefix + bundle.manifest.root_body)
    for light in row.lights:
        light.pos = light.pos + np.array([0.0, places_m[-1] / 2, 0.0])
    return row.compile(), roots


def _standing_beads(bundle: Bundle, y_m: float) -> Beads:
    """Return the skin of an infant that stands somewhere along y."""
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    beads = skin_beads(bundle, model, data)
    return replace(beads, positions=beads.positions + np.array((0.0, y_m, 0.0)))


def _paint_once(painter: Painter, data: mujoco.MjData, beads: Beads | None = None) -> Picture:
    try:
        return painter.paint(data, beads)
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
