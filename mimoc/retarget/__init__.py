"""Return the child of a recording of points and its motion: a fit of the body's sizes and of all frames at once.

A camera looks straight down on an infant who lies. With one camera and no depth, overall size is that of the average
child of the age, unless the camera's height is known; what else remains open is said in the account. Ctrl-C ends the
fit with the best motion so far.

This is a package, too: calling it calls `mimoc.retarget.retargeting.retarget`.

Args:
    recording: Points on the infant; neck and both hips must be among them.
    age_months: Age of the infant, from 0 to 24.
    spec: Child to start from, with its name, sex, hands and scene; by default, the average child.
    camera_height_m: Height of the camera above the floor, if it is known.
    progress: Called with the number of steps done, and of all.

Raises:
    RecordingError: If the recording has too few points or frames.
    SpecError: If there is no such child.

Example:
    >>> import mimoc
    >>> from mimoc.motion.body_points import film
    >>> env = mimoc.make("nine_months.yaml").unwrapped
    >>> still = env.model.key("supine").qpos[None].repeat(12, axis=0)
    >>> result = mimoc.retarget(film(env.model, still, 30.0), age_months=9)
    >>> result.qpos.shape[0], result.account.error_share < 0.01
    (12, True)
"""

import inspect
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

    @property
    def __signature__(self) -> inspect.Signature:
        """The signature of the function."""
        return inspect.signature(import_module("mimoc.retarget.retargeting").retarget)


sys.modules[__name__].__class__ = _Callable
