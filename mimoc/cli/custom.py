"""Classes that a user names on the command line."""

import sys
from importlib import import_module
from typing import Any

from mimoc.errors import MimocError


def import_object(name: str) -> Any:
    """Return an instance of a class that is named as `module:Class`; the module can be in the current folder.

    Raises:
        MimocError: If there is no such module or class, or it cannot be made without arguments.
    """
    module_name, _, class_name = name.partition(":")
    if not class_name:
        raise MimocError(f"'{name}' does not name a class; write MODULE:CLASS, such as my_task:Stillness")
    sys.path.insert(0, "")
    try:
        module = import_module(module_name.removesuffix(".py"))
    except ImportError as error:
        raise MimocError(f"'{name}': {error}; run this command in the folder of the module") from None
    finally:
        sys.path.remove("")
    if not hasattr(module, class_name):
        raise MimocError(f"'{name}': the module has no class '{class_name}'")
    try:
        return getattr(module, class_name)()
    except TypeError as error:
        raise MimocError(f"'{name}': {error}; give all its arguments defaults") from None
