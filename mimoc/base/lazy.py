"""Packages whose names are imported when they are first used, so that each command loads only what it needs."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

from mimoc.base.errors import RenderingError, problem_of_loading_mujoco


def names_of(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package.

    Args:
        package: Its name.
        homes: The names that it has from each module, with spaces between them; `Model as Spec` is `Model` by another
            name.
    """
    origins: dict[str, tuple[str, str]] = {}
    for home, names in homes.items():
        for entry in names.replace(" as ", "=").split():
            name, _, alias = entry.partition("=")
            origins[alias or name] = home, name

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
