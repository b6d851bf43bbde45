"""An OpenGL context to draw in, with or without a screen."""

import importlib
import os
import sys
from collections.abc import Iterator
from typing import Any

from mimoc.errors import RenderingError

_NO_OPENGL = (
    "no picture can be drawn, because OpenGL does not start here ({}); install EGL or OSMesa "
    "(Debian: apt-get install libegl1, or libosmesa6), and choose with MUJOCO_GL=egl or MUJOCO_GL=osmesa"
)


def open_context(width: int, height: int) -> Any:
    """Return a current OpenGL context for pictures of up to this size, in pixels; `free()` it after use.

    `MUJOCO_GL` says which library draws. Without it, a screen is used where there is one, and EGL or
    OSMesa where there is none; other than for MuJoCo's own renderer, it need not be set before the first import.

    Raises:
        RenderingError: If none of them works.
    """
    failures = []
    for name in _backends():
        try:
            context = importlib.import_module(f"mujoco.{name}").GLContext(width, height)
            context.make_current()
        except Exception as error:  # Each OpenGL library has errors of its own, down to AttributeError.
            failures.append(f"{name}: {type(error).__name__}")
        else:
            return context
    raise RenderingError(_NO_OPENGL.format(", ".join(failures)))


def _backends() -> Iterator[str]:
    """Yield the modules of `mujoco` to try, the likeliest first."""
    wished = os.environ.get("MUJOCO_GL", "").lower().strip()
    if wished in {"egl", "osmesa", "glfw", "cgl"}:
        yield wished
    elif sys.platform == "darwin":
        yield "cgl"
    elif sys.platform != "linux":
        yield "glfw"
    else:
        if os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
            yield "glfw"
        yield from ("egl", "osmesa")
