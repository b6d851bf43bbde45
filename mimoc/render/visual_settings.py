"""MuJoCo's visual settings of a model, changed for a while."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

Setting = tuple[Any, str, float]
"""A part of a model's `vis`, the name of one of its fields, and the value that it gets."""


@contextmanager
def visual_settings(settings: Iterable[Setting]) -> Iterator[None]:
    """Change visual settings of a model, and restore them in the end."""
    wanted = tuple(settings)
    usual = [(part, name, getattr(part, name)) for part, name, _ in wanted]
    try:
        for part, name, value in wanted:
            setattr(part, name, value)
        yield
    finally:
        for part, name, value in usual:
            setattr(part, name, value)
