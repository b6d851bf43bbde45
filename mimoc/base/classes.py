"""Classes of a user's own and their names, and what public functions say of arguments of other classes."""

import os
import sys
from collections.abc import Callable
from functools import wraps
from importlib import import_module
from typing import Any, ParamSpec, TypeVar

from mimoc.base.errors import MimocError

P = ParamSpec("P")
R = TypeVar("R")
PATH = (str, os.PathLike)


def import_class(name: str, example: str) -> type[Any]:
    """Return the class named `module:Class`, or raise a MimocError with an *example* of such a name."""
    module_name, _, attribute = name.partition(":")
    if not attribute:
        raise MimocError(f"'{name}' does not name a class; write MODULE:CLASS, such as {example}")
    sys.path.insert(0, "")
    try:
        module = import_module(module_name.removesuffix(".py"))
    except ImportError as error:
        raise MimocError(f"'{name}': {error}; run this command in the folder of the module") from None
    finally:
        sys.path.remove("")
    if not hasattr(module, attribute):
        raise MimocError(f"'{name}': the module has no class '{attribute}'")
    return getattr(module, attribute)


def class_name(thing: object) -> str:
    """Return the class of an object, as `module:Class`."""
    return f"{type(thing).__module__}:{type(thing).__qualname__}"


def takes(expected: str, *classes: type | str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Let a function refuse a first argument of any other class in one line; see `check_class`."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        code: Any = function.__code__
        first = code.co_varnames[0]

        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            if args or first in kwargs:
                check_class(function.__name__, args[0] if args else kwargs[first], expected, *classes)
            return function(*args, **kwargs)

        return checked

    return decorate


def check_class(function: str, given: object, expected: str, *classes: type | str) -> None:
    """Raise a TypeError unless an argument has one of some classes, by name where an import would be for this alone."""
    types = tuple(kind for kind in classes if isinstance(kind, type))
    if not isinstance(given, types) and not {kind.__name__ for kind in type(given).__mro__}.intersection(classes):
        raise TypeError(f"{function}: expected {expected}, got {described(given)}")


def described(given: object) -> str:
    """Return what something is that was given in place of something else."""
    name = type(given).__name__
    if hasattr(given, "possible_agents"):
        return f"{name}, a world with several infants"
    if hasattr(given, "num_envs"):
        return f"{name}, a vector environment"
    if hasattr(given, "step") and hasattr(given, "reset"):
        return f"{name}, an environment"
    return f"{given!r:.60}".replace("\n", " ")
