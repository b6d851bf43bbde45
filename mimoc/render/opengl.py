"""An OpenGL context to draw in, with or without a screen, beside a triton that brings an LLVM of its own."""

import atexit
import ctypes
import importlib
import os
import sys
import threading
import warnings
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mimoc.base.errors import RenderingError

_NO_OPENGL = (
    "no picture can be drawn, because OpenGL does not start here ({}); install EGL or OSMesa "
    "(Debian: apt-get install libegl1, or libosmesa6), and choose with MUJOCO_GL=egl or MUJOCO_GL=osmesa"
)
_PLATFORM = "PYOPENGL_PLATFORM"
_MESA_THREADS = "LP_NUM_THREADS"
"""How many threads Mesa draws with where there is no graphics card. A forked process has none of them, and waits for
them for ever; without any, small pictures are drawn as fast."""


def open_context(width: int, height: int) -> Any:
    """Return a current OpenGL context for pictures of up to this size, in pixels; `free()` it after use.

    `MUJOCO_GL` says which library draws. Without it, a screen is used where there is one, and EGL or
    OSMesa where there is none; other than for MuJoCo's own renderer, it need not be set before the first import.

    A process that is forked after this, as those of Gymnasium's `AsyncVectorEnv` are, can draw as well: Mesa does it
    without threads, unless `LP_NUM_THREADS` says otherwise. The driver of a graphics card may not let it: then start
    processes with `context="spawn"` or `"forkserver"`. A process that learns with torch after this can do so.

    Raises:
        RenderingError: If none of them works.
    """
    os.environ.setdefault(_MESA_THREADS, "0")
    isolate_triton()
    failures = []
    for name in _backends():
        platform, modules = os.environ.get(_PLATFORM), set(sys.modules)
        try:
            return _open(name, width, height)
        except Exception as error:  # Each OpenGL library fails with errors of its own.
            failures.append(f"{name}: {type(error).__name__}")
            # The PyOpenGL that was imported for this library is of no use to the next one.
            for module in set(sys.modules) - modules:
                if module.split(".")[0] == "OpenGL":
                    del sys.modules[module]
            os.environ.pop(_PLATFORM, None)
            if platform is not None:
                os.environ[_PLATFORM] = platform
    raise RenderingError(_NO_OPENGL.format(", ".join(failures)))


@contextmanager
def current(context: Any) -> Iterator[None]:
    """Draw in an OpenGL context within; afterwards, the one of before is current again, or none.

    Python may free the context of an object that is gone in the midst of this, which makes that one current for a
    moment: what is being drawn goes on where it was. Where none is current, any thread can use and free it.

    Raises:
        RenderingError: If another thread draws in it.
    """
    before = getattr(_in_this_thread, "context", None)
    _in_this_thread.context = context
    try:
        _make_current(context)
        yield
    finally:
        _in_this_thread.context = before
        if before is None:
            _leave_context()
        else:
            _make_current(before)


_in_this_thread = threading.local()


def _make_current(context: Any) -> None:
    try:
        context.make_current()
    except Exception as error:  # Each OpenGL library fails with errors of its own.
        raise RenderingError(
            f"OpenGL cannot draw in this thread ({type(error).__name__}), as another one is drawing with the same"
            " context; use an environment in one thread at a time"
        ) from None


def _leave_context() -> None:
    if os.environ.get(_PLATFORM) == "egl":
        egl = importlib.import_module("OpenGL.EGL")
        nothing = egl.EGL_NO_SURFACE, egl.EGL_NO_SURFACE, egl.EGL_NO_CONTEXT
        egl.eglMakeCurrent(importlib.import_module("mujoco.egl").EGL_DISPLAY, *nothing)
    elif "glfw" in sys.modules:
        importlib.import_module("glfw").make_context_current(None)


class Finalizer(weakref.finalize):
    """Frees what an object draws with: when called, when the object is gone, or at exit while OpenGL is still there.

    Make it once the context is open. What is registered for the exit last runs first: a plain `weakref.finalize` comes
    after OpenGL has gone if anything in the process used one before OpenGL was loaded.
    """

    def __init__(self, owner: object, free: Callable[..., None], *arguments: Any):
        super().__init__(owner, free, *arguments)
        self.atexit = False
        atexit.register(self)

    def __call__(self, _: object = None) -> None:
        """Free it; the second time, do nothing."""
        atexit.unregister(self)
        super().__call__()

    def detach(self) -> Any:
        """Leave it to others to free it."""
        atexit.unregister(self)
        return super().detach()


def has_screen() -> bool:
    """Return whether there is a screen that windows could be shown on."""
    return sys.platform != "linux" or any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY")))


def _open(backend: str, width: int, height: int) -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Without a screen GLFW warns, and then makes no context.
        context = importlib.import_module(f"mujoco.{backend}").GLContext(width, height)
        context.make_current()
        if backend == "glfw" and not importlib.import_module("glfw").get_current_context():
            raise ConnectionError
    return context


def _backends() -> Iterator[str]:
    wished = os.environ.get("MUJOCO_GL", "").lower().strip()
    if wished in {"egl", "osmesa", "glfw", "cgl"}:
        yield wished
    elif sys.platform == "darwin":
        yield "cgl"
    elif sys.platform != "linux":
        yield "glfw"
    else:
        if has_screen():
            yield "glfw"
        yield from ("egl", "osmesa")


def set_fog(start_m: float, end_m: float) -> None:
    """Let what the current context draws fade from one distance to another; MuJoCo sets this once for a context."""
    opengl = importlib.import_module("OpenGL.GL")
    opengl.glFogf(opengl.GL_FOG_START, start_m)
    opengl.glFogf(opengl.GL_FOG_END, end_m)


def opengl_driver() -> str:
    """Return what draws here, `egl, llvmpipe (LLVM 15.0.6, 256 bits)`, say, or raise a RenderingError."""
    context = open_context(8, 8)
    try:
        with current(context):
            opengl = importlib.import_module("OpenGL.GL")
            renderer = opengl.glGetString(opengl.GL_RENDERER)
    finally:
        context.free()
    return f"{type(context).__module__.split('.')[1]}, {renderer.decode(errors='replace')}"


_LIBRARY = "triton._C.libtriton"


def isolate_triton() -> None:
    """Load triton's library so that it uses its own LLVM, if triton is installed and not loaded yet.

    Mesa draws without a graphics card by means of LLVM, whose symbols the OpenGL libraries make global in the process.
    A triton that is loaded later finds that LLVM before the one it brings, and the process ends without a message;
    torch builds for CUDA load it with the first optimizer. RTLD_DEEPBIND makes it look at itself first. What is
    loaded stays so when triton is imported. A library that cannot be loaded is left for triton itself to tell of.
    """
    if sys.platform != "linux" or not hasattr(os, "RTLD_DEEPBIND") or _LIBRARY in sys.modules:
        return
    with suppress(ImportError, ValueError, OSError):  # ValueError: something else is called triton here.
        triton = find_spec("triton")
        for folder in (triton.submodule_search_locations or ()) if triton else ():
            library = Path(folder, "_C", "libtriton.so")
            if library.is_file():
                ctypes.CDLL(str(library), os.RTLD_LAZY | os.RTLD_LOCAL | os.RTLD_DEEPBIND)
