"""OpenGL contexts that are used again: one that is opened anew compiles all its shaders, which takes 0.3 s."""

import os
import threading
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import pytest

from mimoc.render import renderer
from mimoc.render.opengl import open_context


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
        """Keep a context for the next one to be opened."""
        if self._are_kept:
            self._kept[_here()].append(context)
        else:
            context.free()

    def free(self) -> None:
        """Free those that are kept, and keep no more."""
        self._are_kept = False
        for context in self._kept.pop(_here(), []):
            context.free()


class _Reused:
    """An OpenGL context that is given back instead of being freed."""

    def __init__(self, context: Any, contexts: Contexts) -> None:
        self._context, self._contexts, self.make_current = context, contexts, context.make_current

    def free(self) -> None:
        self._contexts.take_back(self._context)


def _here() -> tuple[int, int]:
    return os.getpid(), threading.get_ident()


@pytest.fixture(scope="session", autouse=True)
def _contexts_are_used_again() -> Iterator[None]:
    """Have all that is drawn drawn in contexts that were drawn in before; `open_context` still opens new ones."""
    contexts = Contexts()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(renderer, "open_context", contexts.open)
        yield
        contexts.free()
