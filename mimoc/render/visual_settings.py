"""MuJoCo's visual settings of a model, changed for a while."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from copy import copy
from typing import Any

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
