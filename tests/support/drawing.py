"""What makes drawing fast where there is no graphics card, and changes no fact about a picture.

OpenGL contexts are used again, as one that is opened anew compiles all its shaders, which takes 0.3 s. Maps of shadows
are a quarter as wide, as filling the usual ones takes half the time of a picture.
"""

import os
import threading
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import mujoco
import pytest

from mimoc.render import renderer
from mimoc.render.opengl import open_context
from mimoc.render.renderer import visual_settings

MjrContext = mujoco.MjrContext
SHADOWS_PX = 1024  # The most that a map of shadows is wide.


class Contexts:
    """OpenGL contexts that are kept when they are freed."""

    def __init__(self) -> None:
        self._kept: defaultdict[tuple[int, int], list[Any]] = defaultdict(list)
        """By process and thread, as neither can use those of another."""
        self._are_kept = True

    def open(self, width: int, height: int) -> "_Reused":
        """Return a context that nobody else has; its size does not matter, as mimoc draws into buffers of its own."""
        kept = self._kept[_here()]
        context = kept.pop() if kept else open_context(width, height)
        context.make_current()
        return _Reused(context, self)

    def take_back(self, context: Any) -> None:
        if self._are_kept:
            self._kept[_here()].append(context)
        else:
            context.free()

    def free(self) -> None:
        self._are_kept = False
        for context in self._kept.pop(_here(), []):
            context.free()


class _Reused:
    """An OpenGL context that is given back instead of being freed."""

    def __init__(self, context: Any, contexts: Contexts) -> None:
        self._context, self._contexts, self.make_current = context, contexts, context.make_current

    def free(self) -> None:
        self._contexts.take_back(self._context)


def _with_small_shadows(model: mujoco.MjModel, *arguments: Any) -> mujoco.MjrContext:
    quality = model.vis.quality
    with visual_settings([(quality, "shadowsize", min(quality.shadowsize, SHADOWS_PX))]):
        return MjrContext(model, *arguments)


def _here() -> tuple[int, int]:
    return os.getpid(), threading.get_ident()


@pytest.fixture(scope="session", autouse=True)
def _drawing_is_fast() -> Iterator[None]:
    """Have all that is drawn drawn in contexts that were drawn in before; `open_context` still opens new ones."""
    contexts = Contexts()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(renderer, "open_context", contexts.open)
        patch.setattr(mujoco, "MjrContext", _with_small_shadows)
        yield
        contexts.free()
