"""Environments that refuse calls after they were closed."""

from collections.abc import Callable
from functools import wraps
from inspect import isfunction
from typing import Any, TypeVar

from gymnasium.error import ClosedEnvironmentError

Environment = TypeVar("Environment", bound=type)
STAYS = {"close", "close_extras", "get_state"}  # Methods of any environment that can still be called.


def closable(*stays: str) -> Callable[[Environment], Environment]:
    """Let public methods of a class raise `ClosedEnvironmentError` once it is closed, but for `get_state` and *stays*.

    What OpenGL draws with is freed then, and drawing with it would end Python. Attributes can still be read, and
    closing an environment again does nothing.
    """

    def decorate(environment: Environment) -> Environment:
        for name, method in list(vars(environment).items()):
            if name == "close":
                setattr(environment, name, _once(method))
            elif isfunction(method) and not name.startswith("_") and name not in STAYS.union(stays):
                setattr(environment, name, _while_open(method))
        return environment

    return decorate


def _while_open(method: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(method)
    def checked(self: Any, *arguments: Any, **keywords: Any) -> Any:
        if self.closed:
            raise ClosedEnvironmentError(f"this environment is closed: make a new one before calling {method.__name__}")
        return method(self, *arguments, **keywords)

    return checked


def _once(close: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(close)
    def close_once(self: Any, *arguments: Any, **keywords: Any) -> None:
        if not self.closed:
            close(self, *arguments, **keywords)
            self.closed = True

    return close_once
