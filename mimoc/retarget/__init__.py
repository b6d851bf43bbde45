"""The child in a recording of points, and the motion of its joints: a fit of a body to all frames at once.

`mimoc.retarget` is this package and its function: calling the package calls `mimoc.retarget.retargeting.retarget`.

Example:
    >>> import mimoc
    >>> from mimoc.motion.body_points import film
    >>> env = mimoc.make("nine_months.yaml").unwrapped
    >>> still = env.model.key("supine").qpos[None].repeat(12, axis=0)
    >>> result = mimoc.retarget(film(env.model, still, 30.0), age_months=9)
    >>> result.qpos.shape[0], result.account.error_share < 0.01
    (12, True)
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

__qualname__ = "retarget"


class _Callable(ModuleType):
    """A package that has the name of its function."""

    def __call__(self, *arguments: Any, **keywords: Any) -> Any:
        """Return what `mimoc.retarget.retargeting.retarget` returns."""
        return import_module("mimoc.retarget.retargeting").retarget(*arguments, **keywords)


sys.modules[__name__].__class__ = _Callable
