"""The child in a recording of points, and the motion of its joints: a fit of a body to all frames at once.

`mimoc.retarget` is this package and the function that it is about: calling the package calls the function.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class _Callable(ModuleType):
    """A package that has the name of its function."""

    def __call__(self, *arguments: Any, **keywords: Any) -> Any:
        """Return what `mimoc.retarget.retargeting.retarget` returns."""
        return import_module("mimoc.retarget.retargeting").retarget(*arguments, **keywords)


sys.modules[__name__].__class__ = _Callable
