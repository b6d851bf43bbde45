"""Packages whose names are imported when they are first used, so that each command loads only what it needs."""

import ast
import inspect
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

from mimoc.base.errors import RenderingError, problem_of_loading_mujoco


def names_of(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package, from what it imports `if TYPE_CHECKING`.

    Python skips these imports; each is made when its name is first asked for.
    """
    blocks = [node.body for node in ast.parse(inspect.getsource(sys.modules[package])).body if isinstance(node, ast.If)]
    imports = [node for block in blocks for node in block if isinstance(node, ast.ImportFrom)]
    origins = {item.asname or item.name: (str(node.module), item.name) for node in imports for item in node.names}

    def get(name: str) -> Any:
        if name not in origins:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        home, original = origins[name]
        try:
            return getattr(import_module(home), original)
        except Exception as error:
            if not (problem := problem_of_loading_mujoco(error)):
                raise
            raise RenderingError(problem) from None

    names = sorted(origins)
    return get, lambda: names, names
