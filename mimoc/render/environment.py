"""What an environment shows of itself: pictures, or a window."""

import atexit
import threading
import time
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from mimoc.base.errors import RenderingError, check_name
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.world import WorldManifest
from mimoc.render.opengl import has_screen
from mimoc.render.renderer import Picture

if TYPE_CHECKING:  # It loads SciPy, which most environments do without.
    from mimoc.render.body_camera import BodyCamera

MODES = ("human", "rgb_array")
LARGEST_PX = 16384  # Largest width and height of a picture: OpenGL draws none that is larger.


def available_modes() -> list[str]:
    """Return the render modes that work here: a window only where there is a screen."""
    return [mode for mode in MODES if mode != "human" or has_screen()]


def check_rendering(mode: object, width_px: object, height_px: object) -> None:
    """Raise an UnknownNameError for a render mode, or a ValueError for a size that pictures cannot have."""
    if mode is not None:
        check_name("render mode", mode, MODES)
    for size_px in (width_px, height_px):
        if isinstance(size_px, bool) or not isinstance(size_px, (int, np.integer)) or not 1 <= size_px <= LARGEST_PX:
            raise ValueError(f"expected a width and a height from 1 to {LARGEST_PX} pixels, got {size_px!r}")


class EnvRenderer:
    """Shows the state of one model in Gymnasium's render mode `human` or `rgb_array`; without a mode, nothing."""

    def __init__(
        self,
        mode: str | None,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        manifest: Manifest | WorldManifest,
        root_bodies: Sequence[str],
        size_px: tuple[int, int],
    ):
        """Look at some bodies, all that is attached to them, and the objects near them, in a window for `human`.

        What pictures of this width and height need is opened with the first one.

        Raises:
            RenderingError: If the mode needs a screen, and there is none.
        """
        self._mode, self._manifest, self._root_bodies, self._size_px = mode, manifest, root_bodies, size_px
        self._camera: BodyCamera | None = None
        self._window: Window | None = None
        self._show_model(model, data)

    def set_model(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Show another model of the same parts from now on, such as that of the infant at another age.

        Raises:
            RenderingError: If OpenGL has no room for it.
        """
        if self._camera is not None:
            self._camera.use_model(model)
        self._show_model(model, data)

    def start_again(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Show another model from now on, that may have other parts, from where it is best seen."""
        self.close()
        self._show_model(model, data)

    def show(self) -> None:
        """Show the state in the window, if there is one."""
        if self._window is not None:
            self._window.show()

    def render(self) -> Picture | None:
        """Return a picture of the state, (height, width, 3), in `rgb_array`, else None, or raise a RenderingError."""
        if self._mode != "rgb_array":
            return None
        if self._camera is None:
            from mimoc.render.body_camera import BodyCamera, company, view_of_scene
            from mimoc.render.camera import FROM_THE_SIDE

            beside = company(self._manifest, self._root_bodies, self._data)
            view = view_of_scene(FROM_THE_SIDE, self._manifest, self._root_bodies, self._data)
            self._camera = BodyCamera(self._model, self._root_bodies, *self._size_px, view, beside=beside)
            self._camera.turn(self._data)
        return self._camera.render(self._data)

    def close(self) -> None:
        """Free the OpenGL context and close the window; closing twice is fine, and pictures can be drawn again."""
        if self._camera is not None:
            self._camera.close()
            self._camera = None
        if self._window is not None:
            self._window.close()
            self._window = None

    def _show_model(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Show a model from now on; MuJoCo's viewer needs a new window for that."""
        self._model, self._data = model, data
        if self._window is not None:
            self._window.close()
        if self._mode == "human":
            self._window = Window(model, data, self._root_bodies[0])


DISTANCE_M = 1.4  # From where an infant of any age is seen as a whole.
PATIENCE_S = 5.0  # How long the viewer may take to close.


class Window:
    """The viewer of one environment; it runs no faster than real time, so that one sees what happens."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, root_body: str):
        """Open the window, looking at a body; raise a RenderingError if there is no screen."""
        import glfw
        import mujoco.viewer

        from mimoc.render.camera import FROM_THE_SIDE

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # GLFW warns, and says no.
            if not glfw.init():
                raise RenderingError(
                    "no window can be shown, because there is no screen here; use render_mode='rgb_array' for pictures"
                )
        self._data = data
        others = set(threading.enumerate())
        self._viewer = mujoco.viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False)
        self._threads = set(threading.enumerate()) - others
        atexit.register(self.close)
        self._start_s = self._ahead_s()
        with self._viewer.lock():
            self._viewer.cam.lookat[:] = data.body(root_body).xpos
            self._viewer.cam.azimuth, self._viewer.cam.elevation = FROM_THE_SIDE
            self._viewer.cam.distance = DISTANCE_M

    def show(self) -> None:
        """Show the simulation as it is now, when its time has come; nothing, if the user has closed the window."""
        if not self._viewer.is_running():
            return
        early_s = self._ahead_s() - self._start_s
        if early_s < 0:  # The simulation is slower than real time, or was reset: count from now on.
            self._start_s += early_s
        time.sleep(max(early_s, 0.0))
        self._viewer.sync()

    def close(self) -> None:
        """Close the window; closing twice is fine. If Python ended while the viewer still did, it would crash."""
        atexit.unregister(self.close)
        self._viewer.close()
        for thread in self._threads:
            thread.join(PATIENCE_S)

    def _ahead_s(self) -> float:
        """Return how far the simulation's clock is ahead of the wall's, but for a constant."""
        return self._data.time - time.monotonic()
