"""Positions in a YAML file: the path of a key, and a line and column."""

from typing import TypeAlias

KeyPath: TypeAlias = tuple[str | int, ...]
Place: TypeAlias = tuple[int, int]
"""Line and column, both from 1."""


def dotted(path: KeyPath) -> str:
    """Return a path as a user would write it: `scene.room.size_m[0]`."""
    return "".join(f"[{step}]" if isinstance(step, int) else f".{shown(step)}" for step in path).removeprefix(".")


def shown(text: str) -> str:
    """Return a text shortened and escaped for one line of a message."""
    short = text if len(text) <= 40 else text[:37] + "..."
    return short if short.isprintable() else ascii(short)[1:-1]
