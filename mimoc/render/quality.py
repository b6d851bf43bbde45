"""MuJoCo's settings of how to draw, changed for a while."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

Setting = tuple[Any, str, float]
"""A part of a model's `vis`, the name of one of its numbers, and what it is to be."""


@contextmanager
def drawn_with(settings: Iterable[Setting]) -> Iterator[None]:
    """Change settings of a model, and change them back in the end."""
    wanted = tuple(settings)
    usual = [(part, name, getattr(part, name)) for part, name, _ in wanted]
    try:
        for part, name, value in wanted:
            setattr(part, name, value)
        yield
    finally:
        for part, name, value in usual:
            setattr(part, name, value)
