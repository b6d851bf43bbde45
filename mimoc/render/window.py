"""A window that shows an infant as it moves: MuJoCo's own viewer, in step with the environment."""

import atexit
import threading
import time
import warnings

import glfw
import mujoco
import mujoco.viewer

from mimoc.base.errors import RenderingError
from mimoc.render.camera import FROM_THE_SIDE

DISTANCE_M = 1.4
"""From where an infant of any age is seen as a whole."""

PATIENCE_S = 5.0
"""How long the viewer may take to close."""


class Window:
    """The viewer of one environment; it runs no faster than real time, so that one sees what happens."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, root_body: str):
        """Open the window, looking at a body; raise a RenderingError if there is no screen."""
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
