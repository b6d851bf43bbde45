"""OpenGL contexts that the eyes of many infants share."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from hashlib import sha256
from threading import Lock, get_ident

import mujoco
import numpy as np

from mimoc.render.renderer import Renderer, Shown

ASSETS = ("tex_", "mesh_", "hfield_", "skin_face", "skin_tex", "skin_vertnum", "mat_tex")
"""How the fields of a model begin that are uploaded to OpenGL when a renderer is made; all others are read for each
picture, the places of a skin's vertices among them."""


class SharedRenderers:
    """One renderer in each thread for all models of the same meshes and textures, and for each size of pictures."""

    def __init__(self):
        """Begin with none."""
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
        """Return how many there are."""
        return len(self._found)

    def close(self) -> None:
        """Free all OpenGL contexts; closing twice is fine."""
        for renderer in self._found.values():
            renderer.close()
        self._found.clear()


_SHARED: ContextVar[SharedRenderers | None] = ContextVar("shared_renderers", default=None)


@contextmanager
def sharing(renderers: SharedRenderers) -> Iterator[None]:
    """Let all eyes that are opened meanwhile draw with shared renderers from then on."""
    before = _SHARED.set(renderers)
    try:
        yield
    finally:
        _SHARED.reset(before)


def shared_renderers() -> SharedRenderers | None:
    """Return the renderers that eyes which are opened now share, or None for one of their own."""
    return _SHARED.get()


def assets_of(model: mujoco.MjModel) -> bytes:
    """Return a digest of what of a model is uploaded to OpenGL."""
    digest = sha256()
    for name in dir(model):
        if name.startswith(ASSETS) and isinstance(array := getattr(model, name), np.ndarray):
            digest.update(f"{name} {array.shape} ".encode() + array.tobytes())
    return digest.digest()
