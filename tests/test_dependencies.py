"""What mimoc asks to be installed is what it imports: no more, no less, and each in one place."""

import ast
import re
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest

import mimoc

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
TOOLS = {"test", "pages", "docs", "dev"}  # What mimoc itself does not import.
EXTRAS = {name: needs for name, needs in PROJECT["optional-dependencies"].items() if name not in TOOLS}
MODULES = {  # What a distribution is imported as, where that is not its name.
    "pyyaml": "yaml",
    "pillow": "PIL",
    "stable-baselines3": "stable_baselines3",
    "warp-lang": "warp",
    "rsl-rl-lib": "rsl_rl",
}
BROUGHT_ALONG = {"torch": "stable-baselines3", "pydantic_core": "pydantic", "glfw": "mujoco", "websockets": "viser"}
"""What is imported without being asked for, and what needs it."""


def modules(needs: list[str]) -> set[str]:
    names = [re.split(r"[\s<>=!~;\[]", need, maxsplit=1)[0] for need in needs]
    return {MODULES.get(name, name.replace("-", "_")) for name in names}


def imported(folder: Path) -> set[str]:
    """Return the packages that modules of a folder import, wherever in them they do, or look for by name."""
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in folder.rglob("*.py")]
    nodes = [node for tree in trees for node in ast.walk(tree)]
    names = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    names += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom) and not node.level]
    return {name.partition(".")[0] for name in names} - sys.stdlib_module_names - {"mimoc"}


@cache
def imported_here() -> set[str]:
    return imported(Path(mimoc.__file__).parent)


def test_everything_that_the_core_needs_is_imported():
    assert modules(PROJECT["dependencies"]) <= imported_here()


@pytest.mark.parametrize("extra", EXTRAS)
def test_everything_that_an_extra_needs_is_imported(extra):
    assert modules(EXTRAS[extra]) <= imported_here()


def test_everything_that_is_imported_is_asked_for():
    asked_for = modules([*PROJECT["dependencies"], *(need for needs in EXTRAS.values() for need in needs)])
    assert asked_for >= imported_here() - BROUGHT_ALONG.keys()
    assert modules([*BROUGHT_ALONG.values()]) <= asked_for
