"""The cameras of an infant's eyes."""

import math
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.components.senses.vision.filters import distances
from mimoc.render.renderer import SHARED, Renderer, Setting, Shown, assets_of

Drawn = npt.NDArray[np.uint8]  # Shape (cameras, height, width, 3).
MIN_SLICES = 12
SLICES_PER_ROOT_PX = 2.0
"""Sides of drawn balls and limbs, per square root of the picture's height in pixels, at most what the model asks for:
the outline of a limb half as wide as the picture is then within a third of a pixel of a round one.
`benchmarks/vision.py` measures the time that this saves and the difference in the pictures."""
STACKS_PER_SLICE = 2 / 3
PLAIN = [int(mujoco.mjtRndFlag.mjRND_SHADOW), int(mujoco.mjtRndFlag.mjRND_REFLECTION)]  # What eyes do without.
HIDDEN_GROUP = 4  # A group of geoms that MuJoCo does not draw unless asked to, and eyes never ask for.


@dataclass(frozen=True, slots=True)
class View:
    """What some cameras draw, and how far away it is."""

    drawn: Drawn
    distances_m: npt.NDArray[np.float32]
    """Along the line of sight, shape (cameras, height, width)."""


class Eyes:
    """Some cameras of one model, which draw as little as possible: no shadows, reflections, or smooth edges.

    What they draw is gathered once for all cameras, since moving the vertices of skins takes as long as drawing them.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        cameras: Sequence[str],
        width_px: int,
        height_px: int,
        unseen: Collection[str] = (),
        shown: Shown = "skin",
    ):
        """Open an OpenGL context for pictures of this size; geoms and colours of the model may change later.

        *unseen* are bodies that are not drawn, *shown* is what is drawn of infants.

        Raises:
            RenderingError: If there is no OpenGL here, or none that draws such large pictures.
        """
        self._names, self._unseen_bodies = tuple(cameras), unseen
        self._parts = [mujoco.MjrRect(0, row * height_px, width_px, height_px) for row in range(len(cameras))]
        self._shape = len(cameras), height_px, width_px, 3
        self._size_px = (width_px, height_px * len(cameras))
        self._shared = SHARED.get()
        self.shares = self._shared is not None
        """Whether it draws with what other eyes draw with, a renderer in each thread."""
        self._settings = partial(_lean, height_px=height_px)
        self._shown: Shown = shown
        self._model = model
        self._find_names(model)
        self._assets = b"" if self._shared is None else assets_of(model, self._unseen_skins)
        self._renderer = self._open()

    def __call__(self, data: mujoco.MjData) -> Drawn:
        """Return what the cameras draw."""
        with self._drawn(data) as renderer:
            return renderer.read().reshape(self._shape)[:, ::-1]

    def view(self, data: mujoco.MjData) -> View:
        """Return what the cameras draw, and how far away it is."""
        with self._drawn(data) as renderer:
            pixels, depths = renderer.read_with_depths()
        extent_m, planes = self._model.stat.extent, self._model.vis.map
        distances_m = distances(depths, planes.znear * extent_m, planes.zfar * extent_m)
        return View(pixels.reshape(self._shape)[:, ::-1], distances_m.reshape(self._shape[:-1])[:, ::-1])

    @contextmanager
    def _drawn(self, data: mujoco.MjData) -> Iterator[Renderer]:
        """Draw what all cameras see, and yield what it can be read from."""
        renderer = self._renderer
        if self._shared is not None:
            renderer = self._open()
            renderer.show_model(self._model)
        with renderer.in_use():
            for number, (camera, part) in enumerate(zip(self._cameras, self._parts, strict=True)):
                if number == 0:
                    self._compose(renderer, camera, data)
                else:
                    renderer.turn_to(data, camera)
                renderer.draw(part)
            yield renderer

    def use_model(self, model: mujoco.MjModel) -> None:
        """Draw another model from now on, in which cameras and bodies have the same names.

        Raises:
            RenderingError: If OpenGL has no room for it.
        """
        self._model = model
        self._find_names(model)
        if self._shared is None:
            self._renderer.change_model(model)
        else:
            self._assets = assets_of(model, self._unseen_skins)

    def close(self) -> None:
        """Free the OpenGL context, unless it is shared; closing twice is fine."""
        if self._shared is None:
            self._renderer.close()

    def _open(self) -> Renderer:
        """Return a renderer of its own, or the shared one of this thread for the model's meshes and textures."""
        make = partial(Renderer, self._model, *self._size_px, self._settings, self._shown)
        return make() if self._shared is None else self._shared.of(self._assets, self._size_px, self._shown, make)

    def _find_names(self, model: mujoco.MjModel) -> None:
        self._groups, self._skin_groups = model.geom_group, model.skin_group
        self.fovy_deg = float(model.cam_fovy[model.camera(self._names[0]).id])
        """Vertical field of view."""
        self._cameras = [mujoco.MjvCamera() for _ in self._names]
        for camera, name in zip(self._cameras, self._names, strict=True):
            camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
            camera.fixedcamid = model.camera(name).id
        bodies = enumerate(model.geom_bodyid)
        self._unseen = [geom for geom, body in bodies if model.body(body).name in self._unseen_bodies]
        self._unseen_skins = [skin for skin in range(model.nskin) if _bones(model, skin) <= set(self._unseen_bodies)]

    def _compose(self, renderer: Renderer, camera: mujoco.MjvCamera, data: mujoco.MjData) -> None:
        """Fill the scene for a camera, whose light goes with it."""
        usual, usual_skins = self._groups[self._unseen], self._skin_groups[self._unseen_skins]
        self._groups[self._unseen] = self._skin_groups[self._unseen_skins] = HIDDEN_GROUP
        try:
            renderer.compose(data, camera)
            renderer.scene.flags[PLAIN] = 0
        finally:
            self._groups[self._unseen], self._skin_groups[self._unseen_skins] = usual, usual_skins


def _bones(model: mujoco.MjModel, skin: int) -> set[str]:
    first = model.skin_boneadr[skin]
    return {model.body(body).name for body in model.skin_bonebodyid[first : first + model.skin_bonenum[skin]]}


def _lean(model: mujoco.MjModel, height_px: int) -> tuple[Setting, ...]:
    """Return the settings with which MuJoCo draws pictures of a height, and no more."""
    quality = model.vis.quality
    slices = max(MIN_SLICES, math.ceil(SLICES_PER_ROOT_PX * math.sqrt(height_px)))
    return (
        (quality, "shadowsize", 0),
        (quality, "offsamples", 0),
        (quality, "numslices", min(quality.numslices, slices)),
        (quality, "numstacks", min(quality.numstacks, round(slices * STACKS_PER_SLICE))),
    )
