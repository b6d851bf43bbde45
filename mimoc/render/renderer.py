"""Off-screen drawing of a model: an OpenGL context, maybe shared, a scene, and the buffer pictures are read from."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from copy import copy
from functools import reduce
from hashlib import sha256
from operator import add
from threading import Lock, get_ident
from typing import Any, Literal

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import RenderingError
from mimoc.base.mujoco_layout import SOLIDS_GROUP
from mimoc.render.opengl import Finalizer, current, open_context

Setting = tuple[Any, str, Any]
"""A part of a model's `vis`, the name of one of its fields, and the number or colour that it gets."""


@contextmanager
def visual_settings(settings: Iterable[Setting]) -> Iterator[None]:
    """Change visual settings of a model, and restore them in the end."""
    wanted = tuple(settings)
    usual = [(part, name, copy(getattr(part, name))) for part, name, _ in wanted]
    try:
        for part, name, value in wanted:
            setattr(part, name, value)
        yield
    finally:
        for part, name, value in usual:
            setattr(part, name, value)


Picture = npt.NDArray[np.uint8]  # Red, green and blue, shape (height, width, 3).

Shown = Literal["skin", "solids"]
"""What is drawn of an infant: its skin, where it has one, or the solids that touch and are touched."""

SPARE_GEOMS = 100  # Room in a scene for what is drawn besides the model's geoms and sites.


class Renderer:
    """Draws one model at a time into a buffer of its own.

    It is made once and kept, since making one uploads all textures. Each has an OpenGL context of its own, so that
    closing one neither blackens the pictures of another nor mixes their textures.
    """

    scene: mujoco.MjvScene
    context: mujoco.MjrContext

    def __init__(
        self,
        model: mujoco.MjModel,
        width_px: int,
        height_px: int,
        settings: Callable[[mujoco.MjModel], Iterable[Setting]] = lambda model: (),
        shown: Shown = "skin",
    ):
        """Open an OpenGL context for a model, whose geoms and colours may change later, and a buffer of this size.

        The settings are the visual ones that meshes and buffers of a model are made with.

        Raises:
            RenderingError: If there is no OpenGL here, or none with room for such a large buffer.
        """
        self.buffer = mujoco.MjrRect(0, 0, width_px, height_px)
        self._settings = settings
        self._options, self._perturbation = mujoco.MjvOption(), mujoco.MjvPerturb()
        if shown == "solids":
            self._options.flags[mujoco.mjtVisFlag.mjVIS_SKIN] = False
            self._options.geomgroup[SOLIDS_GROUP] = True
        self._gl, self._busy = open_context(width_px, height_px), Lock()
        with current(self._gl):
            self._load(model)

    def change_model(self, model: mujoco.MjModel) -> None:
        """Draw another model in the same context, ten times faster than a new one, or raise a RenderingError."""
        with self.in_use():
            self._finalizer.detach()
            self.context.free()
            self._load(model)

    def show_model(self, model: mujoco.MjModel) -> None:
        """Draw another model from now on, whose meshes and textures are the same: nothing is uploaded."""
        self._model = model
        self.reserve(0)

    def reserve(self, geoms: int) -> None:
        """Make room in the scene for more geoms than those of the model."""
        needed = self._model.ngeom + self._model.nsite + SPARE_GEOMS + geoms
        if self.scene.maxgeom < needed:
            self.scene = mujoco.MjvScene(self._model, needed)

    def compose(self, data: mujoco.MjData, camera: mujoco.MjvCamera) -> None:
        """Fill the scene with what a camera is to show."""
        mujoco.mjv_updateCamera(self._model, data, camera, self.scene)  # Or shadows are those of the camera before.
        everything = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(self._model, data, self._options, self._perturbation, camera, everything, self.scene)

    def turn_to(self, data: mujoco.MjData, camera: mujoco.MjvCamera) -> None:
        """Show what `compose` has filled the scene with from another camera, whose light goes with it."""
        mujoco.mjv_updateCamera(self._model, data, camera, self.scene)
        mujoco.mjv_makeLights(self._model, data, self.scene)

    @contextmanager
    def in_use(self) -> Iterator[None]:
        """Draw and read within, any thread can outside of it; RenderingError if another one is, or it is closed."""
        with self._alone():
            if not self._finalizer.alive:
                raise RenderingError("nothing can be drawn with what has been closed; open it again")
            with current(self._gl):
                yield

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Keep other threads from drawing and closing meanwhile, or refuse if another one is doing so."""
        if not self._busy.acquire(blocking=False):
            raise RenderingError(
                "nothing can be drawn or closed in this thread while another one is drawing the same;"
                " use an environment in one thread at a time"
            )
        try:
            yield
        finally:
            self._busy.release()

    def draw(self, part: mujoco.MjrRect | None = None) -> None:
        """Draw the scene, while in use, into the buffer or into a part of it."""
        mujoco.mjr_render(part or self.buffer, self.scene, self.context)

    def read(self) -> Picture:
        """Return a new array with the pixels of the buffer, the lowest row first, while in use."""
        pixels = np.empty((self.buffer.height, self.buffer.width, 3), np.uint8)
        mujoco.mjr_readPixels(pixels, None, self.buffer, self.context)
        return pixels

    def read_with_depths(self) -> tuple[Picture, npt.NDArray[np.float32]]:
        """Return new arrays with the pixels of the buffer and their depths, the lowest row first, while in use.

        A depth, shape (height, width), is 0 at the near and 1 at the far plane, as OpenGL has it.
        """
        pixels = np.empty((self.buffer.height, self.buffer.width, 3), np.uint8)
        depths = np.empty((self.buffer.height, self.buffer.width), np.float32)
        mujoco.mjr_readPixels(pixels, depths, self.buffer, self.context)
        return pixels, depths

    def read_drawn(self) -> npt.NDArray[np.bool_]:
        """Return where anything is drawn, shape (height, width), the lowest row first, while in use."""
        depth = np.empty((self.buffer.height, self.buffer.width), np.float32)
        mujoco.mjr_readPixels(None, depth, self.buffer, self.context)
        return depth < 1  # OpenGL's depth where there is nothing is that of the far plane.

    def close(self) -> None:
        """Free the OpenGL context, once; RenderingError if another thread is drawing with it."""
        with self._alone():
            self._finalizer()

    def _load(self, model: mujoco.MjModel) -> None:
        """Make all that drawing a model takes, in the current OpenGL context: meshes, textures, and a buffer.

        Raises:
            RenderingError: If OpenGL has no room for that; its context is freed then.
        """
        self._model = model
        size = model.vis.global_
        width = self.buffer.width
        height = self.buffer.height
        try:
            with visual_settings(((size, "offwidth", width), (size, "offheight", height), *self._settings(model))):
                self.context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50)
        except mujoco.FatalError as error:
            self._gl.free()
            pixels = f"{width} x {height} pixels"
            raise RenderingError(f"OpenGL cannot draw {pixels} here ({error}); choose smaller pictures") from None
        self._finalizer = Finalizer(self, _free, self.context, self._gl)
        self.scene = mujoco.MjvScene(model, model.ngeom + model.nsite + SPARE_GEOMS)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self.context)


def _free(context: mujoco.MjrContext, gl: Any) -> None:
    with suppress(RenderingError), current(gl):  # At exit, a thread that was left alone may be drawing with it.
        context.free()
        gl.free()


def average_down(pictures: Any, times: int) -> Any:
    """Return pictures, of any array library, shape (..., height, width, colours), smaller so many times either way."""
    rows = reduce(add, (pictures[..., start::times, :, :] for start in range(times)))  # 8 times faster than a mean.
    return reduce(add, (rows[..., start::times, :] for start in range(times))) / float(times**2)


ASSETS = ("tex_", "mesh_", "hfield_", "skin_face", "skin_tex", "skin_vertnum", "mat_tex")
"""How the fields of a model begin that are uploaded to OpenGL when a renderer is made; all others are read for each
picture, the places of a skin's vertices among them."""


class SharedRenderers:
    """One renderer in each thread for all models of the same meshes and textures, and for each size of pictures."""

    def __init__(self):
        self._found: dict[tuple[int, bytes, tuple[int, int], Shown], Renderer] = {}
        self._opening = Lock()

    def of(self, assets: bytes, size_px: tuple[int, int], shown: Shown, make: Callable[[], Renderer]) -> Renderer:
        """Return the renderer of this thread for some assets, a size and what it shows, made when first asked for."""
        key = (get_ident(), assets, size_px, shown)
        if key not in self._found:
            with self._opening:
                self._found[key] = make()
        return self._found[key]

    def __len__(self) -> int:
        return len(self._found)

    def close(self) -> None:
        """Free all OpenGL contexts; closing twice is fine."""
        for renderer in self._found.values():
            renderer.close()
        self._found.clear()


SHARED: ContextVar[SharedRenderers | None] = ContextVar("shared_renderers", default=None)
"""The renderers that eyes which are opened now share, or None for one of their own."""


@contextmanager
def sharing(renderers: SharedRenderers) -> Iterator[None]:
    """Let all eyes that are opened meanwhile draw with shared renderers from then on."""
    before = SHARED.set(renderers)
    try:
        yield
    finally:
        SHARED.reset(before)


def assets_of(model: mujoco.MjModel, unseen_skins: Sequence[int] = ()) -> bytes:
    """Return a digest of what of a model is uploaded to OpenGL, but for where skins that are never drawn are painted.

    Hair is painted by age, and its owner never sees it, so that eyes of all ages can share a renderer.
    """
    digest = sha256()
    unseen = np.zeros(len(model.skin_texcoord), bool)
    for skin in unseen_skins:
        if (first := int(model.skin_texcoordadr[skin])) >= 0:
            unseen[first : first + model.skin_vertnum[skin]] = True
    for name in dir(model):
        if name.startswith(ASSETS) and isinstance(array := getattr(model, name), np.ndarray):
            kept = array[~unseen] if name == "skin_texcoord" else array
            digest.update(f"{name} {array.shape} ".encode() + kept.tobytes())
    return digest.digest()
