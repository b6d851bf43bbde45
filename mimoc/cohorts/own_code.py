"""Functions of the user's own, which a cohort file names as `module:function`."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from importlib import import_module, invalidate_caches
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mimoc.errors import MimocError


def import_function(name: str, folder: str) -> Callable[..., Any]:
    """Return a function that is named as `module:function`; the module can be in a folder.

    Raises:
        MimocError: If there is no such module or function.
    """
    module_name, _, function = name.partition(":")
    with _found_in(folder):
        _forget_another(module_name, folder)
        try:
            module = import_module(module_name)
        except ImportError as error:
            raise MimocError(f"'{name}': {error}; put the module beside the cohort file, or install it") from None
    if not callable(found := getattr(module, function, None)):
        raise MimocError(f"'{name}': the module has no function '{function}'")
    return found


def digest_of(name: str, folder: str) -> str:
    """Return the digest of the file of a function's module, so that jobs with an older version are done again.

    Raises:
        MimocError: If there is no such module.
    """
    module_name = name.partition(":")[0]
    with _found_in(folder):
        try:
            spec = _beside(module_name, folder) or find_spec(module_name)
        except (ImportError, ValueError):
            spec = None
        except Exception as error:  # Whatever the package that the module is in does when it is imported.
            raise MimocError(f"'{name}': its package cannot be imported ({error}); mend it") from None
    if spec is None:
        raise MimocError(f"'{name}': there is no module '{module_name}'; put it beside the cohort file, or install it")
    source = Path(spec.origin or "")
    return f"sha256:{sha256(source.read_bytes()).hexdigest()}" if source.is_file() else ""


def _beside(module: str, folder: str) -> ModuleSpec | None:
    """Return where a module is in a folder; None if it is not there, or is part of a package."""
    return None if "." in module else PathFinder.find_spec(module, [folder])


def _forget_another(module: str, folder: str) -> None:
    """Forget a module of the same name that was imported from elsewhere, such as from beside another cohort file."""
    known, wanted = sys.modules.get(module), _beside(module, folder)
    if known and wanted and getattr(known, "__file__", None) != wanted.origin:
        del sys.modules[module]


@contextmanager
def _found_in(folder: str) -> Iterator[None]:
    """Let modules in a folder be found."""
    invalidate_caches()
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)
