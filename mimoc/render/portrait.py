"""Pictures of an infant from outside."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.bundle.poses import pose_of
from mimoc.render.averaging import average_down
from mimoc.render.camera import (
    FROM_BEFORE,
    FROM_THE_SIDE,
    LENS_DEG,
    MARGIN,
    Balls,
    Shot,
    View,
    balls_of,
    clearest,
    frame,
    towards,
    walls_of,
)
from mimoc.render.opengl import Finalizer, open_context
from mimoc.render.quality import drawn_with
from mimoc.render.touch_markers import Beads, add_beads, join_beads, scene_for, skin_beads
from mimoc.units import cm_to_m

Picture = npt.NDArray[np.uint8]

MAX_GEOMS = 2000
STILL, MOVING = 3, 2
"""How many times larger pictures are drawn and then averaged down, which smooths the edges of shadows too: those that
are looked at for long, and those of a film."""
LARGEST_PX = 4096
"""Side of what is drawn: a picture that would be larger is drawn as it is, with MuJoCo's smoothing."""
SAMPLES = 8
"""Of a pixel, for MuJoCo's smoothing."""
ROW_LENS_DEG = 10.0
"""For infants in a row: from so far away that those at the ends do not turn their faces."""
ELBOW_ROOM = 0.5
"""Distance of infants in a row, as a share of their length."""
BESIDE_M = 1.0
"""How far beyond the ends of a row things cast shadows."""


class Painter:
    """A camera that looks at one infant or at several, and the OpenGL context it needs."""

    def __init__(
        self,
        model: mujoco.MjModel,
        root_bodies: Sequence[str],
        width: int,
        height: int,
        view: View = FROM_THE_SIDE,
        lens_deg: float = LENS_DEG,
        finer: int = MOVING,
        margin: float = MARGIN,
    ):
        """Open an OpenGL context for pictures of what hangs on some bodies.

        Args:
            model: The model.
            root_bodies: Names of the bodies.
            width: In pixels.
            height: In pixels.
            view: From where they are seen.
            lens_deg: Vertical field of view, where there is space for it.
            finer: How many times larger pictures are drawn and then averaged down, if that is not too large.
            margin: How much wider the lens is than what it has to show.

        Raises:
            RenderingError: If there is no OpenGL here.
        """
        self._model, self.view, self._lens_deg, self._margin = model, view, lens_deg, margin
        self._finer = finer if finer * max(width, height) <= LARGEST_PX else 1
        self._seen = np.isin(model.body_rootid[model.geom_bodyid], [model.body(root).id for root in root_bodies])
        self._viewport = mujoco.MjrRect(0, 0, self._finer * width, self._finer * height)
        self._gl = open_context(self._viewport.width, self._viewport.height)
        settings = (
            (model.vis.global_, "offwidth", self._viewport.width),
            (model.vis.global_, "offheight", self._viewport.height),
            (model.vis.quality, "offsamples", 0 if self._finer > 1 else SAMPLES),
        )
        with drawn_with(settings):
            self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        self._scene = mujoco.MjvScene(model, MAX_GEOMS)
        self._close = Finalizer(self, _free, self._context, self._gl)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)

    @property
    def aspect(self) -> float:
        """Width of the pictures over their height."""
        return self._viewport.width / self._viewport.height

    def balls(self, data: mujoco.MjData) -> Balls:
        """Return what it looks at."""
        return balls_of(self._model, data, self._seen)

    def turn(self, data: mujoco.MjData) -> None:
        """Look from now on from where the walls leave space."""
        walls = walls_of(self._model, data)
        self.view = clearest(self.balls(data), walls, self.view, self.aspect, self._lens_deg)

    def shot(self, data: mujoco.MjData) -> Shot:
        """Return the shot that shows everything from top to toe."""
        walls = walls_of(self._model, data)
        return frame(self.balls(data), walls, self.view, self.aspect, self._lens_deg, self._margin)

    def paint(self, data: mujoco.MjData, beads: Beads | None = None, shot: Shot | None = None) -> Picture:
        """Return a picture of all of it, or of a shot, and of some beads, shape (height, width, 3)."""
        self._gl.make_current()
        shot = shot or self.shot(data)
        scene = self._scene if beads is None else scene_for(beads, self._model, MAX_GEOMS)
        self._compose(data, shot, scene)
        if beads is not None:
            add_beads(scene, beads)
        mujoco.mjr_render(self._viewport, scene, self._context)
        upside_down = np.empty((self._viewport.height, self._viewport.width, 3), np.uint8)
        mujoco.mjr_readPixels(upside_down, None, self._viewport, self._context)
        if self._finer == 1:
            return upside_down[::-1].copy()
        return np.rint(average_down(upside_down[::-1].astype(np.float32), self._finer)).astype(np.uint8)

    def close(self) -> None:
        """Free the OpenGL context; closing twice is fine."""
        self._close()

    def _compose(self, data: mujoco.MjData, shot: Shot, scene: mujoco.MjvScene) -> None:
        """Fill a scene with what a shot shows."""
        camera, options, perturbation = mujoco.MjvCamera(), mujoco.MjvOption(), mujoco.MjvPerturb()
        camera.lookat[:], camera.distance = shot.lookat_m, shot.depth_m
        camera.azimuth, camera.elevation = shot.view
        everything = mujoco.mjtCatBit.mjCAT_ALL
        with drawn_with([(self._model.vis.global_, "fovy", shot.fovy_deg)]):
            mujoco.mjv_updateCamera(self._model, data, camera, scene)  # Or shadows are those of the camera before.
            mujoco.mjv_updateScene(self._model, data, options, perturbation, camera, everything, scene)
        for light in scene.lights[: scene.nlight]:
            if light.type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL and not light.headlight:
                light.pos[:2] += shot.lookat_m[:2]  # The sun is everywhere; the shadows it draws are around a point.


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
    painter = Painter(model, [manifest.root_body], width, height, view, finer=STILL)
    painter.turn(data)
    return _paint_once(painter, data, beads)


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
    painter = Painter(model, roots, width, height, FROM_BEFORE, ROW_LENS_DEG, STILL)
    return _paint_once(painter, data, beads)


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
    row.visual.map.shadowclip = max(row.visual.map.shadowclip, places_m[-1] / 2 + BESIDE_M)
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


def _free(context: mujoco.MjrContext, gl: Any) -> None:
    gl.make_current()
    context.free()
    gl.free()
