"""Names that are imported when they are first used, and calls that wait for an import."""

import ast
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from mimoc.base.errors import RenderingError, problem_of_loading_mujoco


def names_of(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package, from what it imports `if TYPE_CHECKING`.

    Python skips these imports; each is made when its name is first asked for.
    """
    loader: Any = sys.modules[package].__loader__
    conditions = [node for node in ast.parse(loader.get_source(package)).body if isinstance(node, ast.If)]
    blocks = [node.body for node in conditions if ast.unparse(node.test) == "TYPE_CHECKING"]
    imports = [node for block in blocks for node in block if isinstance(node, ast.ImportFrom)]
    origins = {item.asname or item.name: (str(node.module), item.name) for node in imports for item in node.names}

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


def when_imported(name: str, call: Callable[[], None]) -> None:
    """Call a function as soon as a module is imported: at once if it has been, otherwise after the first import."""
    if name in sys.modules:
        call()
    else:
        sys.meta_path.insert(0, _WaitingLoader(name, call))


class _WaitingLoader:
    """Finder and loader of one module, which loads it as others do, then makes the call and withdraws.

    It has no base of `importlib.abc`, whose import takes as long as half of mimoc's.
    """

    loader: Any  # The loader that the module would have had.

    def __init__(self, name: str, call: Callable[[], None]):
        self.name = name
        self.call = call

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != self.name:
            return None
        others = (finder for finder in sys.meta_path if finder is not self)
        spec: Any = next(filter(None, (finder.find_spec(fullname, path, target) for finder in others)), None)
        if spec:
            self.loader, spec.loader = spec.loader, self
        return spec

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return self.loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        spec: Any = module.__spec__
        module.__loader__ = spec.loader = self.loader
        self.loader.exec_module(module)
        sys.meta_path.remove(self)
        self.call()
