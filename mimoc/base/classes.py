"""Classes of a user's own, and their names."""

import sys
from importlib import import_module
from typing import Any

from mimoc.base.errors import MimocError


def import_class(name: str, example: str) -> type[Any]:
    """Return the class that is named as `module:Class`; the module can be in the current folder.

    Args:
        name: Names of module and class.
        example: What such a name looks like, for the message.

    Raises:
        MimocError: If there is no such module or class.
    """
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
