"""A user's class that acts, named on the command line as `module:Class`."""

import inspect
import re
import traceback
from difflib import get_close_matches
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.classes import import_class
from mimoc.base.errors import PolicyError
from mimoc.policies.policy import PolicyMaker
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import Observation
from mimoc.schema.kinds import POLICIES

CLASS = re.compile(r"([A-Za-z_][\w.]*):[A-Za-z_]\w*")
EXAMPLE = "my_policy:Kicker"


def class_or_text(text: str) -> str | PolicyMaker:
    """Return what makes the policy of a class, if a text names one as `module:Class`; the text otherwise.

    Only what a user names may be given here, and nothing that is read from a file: the module is imported.
    """
    return partial(ClassPolicy, name=text) if is_class(text) else text


def is_class(text: str) -> bool:
    """Return whether a text names a class, and not a policy with its argument, or a misspelling of one."""
    match = CLASS.fullmatch(text)
    if match is None or match[1] in POLICIES:
        return False
    package = match[1].partition(".")[0]
    is_here = Path(package).is_dir() or Path(f"{package}.py").is_file()
    return is_here or find_spec(package) is not None or not get_close_matches(package, POLICIES, cutoff=0.8)


class ClassPolicy:
    """A policy of a user's class, which is made anew for each infant.

    The class is called with the environment, or, if it takes two arguments, with the spaces of observations and
    actions. `act(observation)` returns the action; `reset()`, if there is one, is called whenever an episode begins.
    """

    def __init__(self, env: Infant, name: str):
        """Make an object of the class; raise a PolicyError if that fails, or it cannot act."""
        made = import_class(name, EXAMPLE)
        self._name, self._shape = name, env.action_space.shape
        arguments = (env.observation_space, env.action_space) if _takes_spaces(made) else (env,)
        self._object: Any = self._call("cannot be made", made, *arguments)
        if not callable(getattr(self._object, "act", None)):
            raise PolicyError(f"'{name}': has no method 'act'; write one that returns the action for an observation")

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action, shape (n,); raise a PolicyError if there is none."""
        action = np.asarray(self._call("act failed", self._object.act, observation))
        if action.shape != self._shape or action.dtype.kind not in "fiu" or not np.isfinite(action).all():
            wanted = f"an array of {self._shape} finite numbers, not of {action.shape} {action.dtype}"
            raise PolicyError(f"'{self._name}': act must return {wanted}")
        return action.astype(np.float32)

    def reset(self) -> None:
        """Begin an episode."""
        if hasattr(self._object, "reset"):
            self._call("reset failed", self._object.reset)

    def _call(self, what: str, function: Any, *arguments: Any) -> Any:
        try:
            return function(*arguments)
        except Exception as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            where = f"{Path(place.filename).name}:{place.lineno}"
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise PolicyError(f"'{self._name}': {what} in {where}: {reason}") from error


def _takes_spaces(made: Any) -> bool:
    try:
        parameters = inspect.signature(made).parameters.values()
    except (TypeError, ValueError):
        return False
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(one.kind in positional and one.default is inspect.Parameter.empty for one in parameters) == 2
