"""Imports point one way, and each library has one home."""

import ast
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import mimoc

ROOT = Path(mimoc.__file__).parent


@dataclass(frozen=True)
class Layer:
    """Some modules that stand on one step of the pipeline."""

    modules: frozenset[str]
    """Top names under `mimoc`."""
    below: frozenset[str]
    """The other layers it may import."""
    libraries: frozenset[str]
    """The owned libraries it may import."""


def layer(modules: str, below: str = "", libraries: str = "") -> Layer:
    return Layer(frozenset(modules.split()), frozenset(below.split()), frozenset(libraries.split()))


COMPILING = "errors units base source schema fits body scene render bundle"
RUNNING = f"{COMPILING} pipeline explain runtime plot"

LAYERS = {
    "version": layer("version"),
    "errors": layer("errors"),
    "units": layer("units"),
    "base": layer("exchange files", "errors version"),
    "source": layer("source", "errors", "yaml"),
    "schema": layer("schema", "errors units source", "pydantic"),
    "fits": layer("fits", "errors units schema"),
    "body": layer("body", "errors units schema fits"),
    "scene": layer("scene", "errors units base schema body", "trimesh PIL coacd fast_simplification platformdirs"),
    "render": layer("render", "errors scene", "jinja2 lxml"),
    "bundle": layer("bundle", "errors base schema"),
    "pipeline": layer("pipeline validation availability blame supplies", COMPILING, "mujoco"),
    "explain": layer("explain", "errors bundle"),
    "runtime": layer("runtime", "errors units schema bundle", "gymnasium mujoco scipy glfw"),
    "plot": layer("plot", "errors units base schema fits body", "matplotlib"),
    "recording": layer("recording", "errors units base runtime", "gymnasium av PIL"),
    "training": layer("training experiments importers", RUNNING, "stable_baselines3 torch"),
    "cli": layer("cli console __main__", f"{RUNNING} recording training mimoc", "typer rich"),
    "mimoc": layer("__init__ making registration", f"{RUNNING} recording training", "gymnasium"),
}
"""What design.md says, and where the modules it does not name belong."""

MODULES_WITH_A_LIBRARY_OF_THEIR_OWN = {
    "gymnasium": {"runtime", "recording", "registration", "making"},
    "mujoco": {"runtime", "pipeline", "validation"},
    "typer": {"cli"},
    "rich": {"cli", "console"},
    "stable_baselines3": {"training"},
    "torch": {"training"},
}
"""Of layers with several modules: those that may import the library."""

SHARED_LIBRARIES = {"numpy", *sys.stdlib_module_names}
COMES_WITH = {"pydantic_core": "pydantic"}
"""Libraries that are part of another."""


@dataclass(frozen=True)
class Import:
    """One import, as it is written."""

    module: str
    """Full name of the importing module."""
    line: int
    name: str
    """Full name of what is imported."""

    @property
    def where(self) -> str:
        return f"{self.module}:{self.line}"


def imports(module: str, source: str, *, is_package: bool = False) -> list[Import]:
    """Return every import of a module, wherever it stands, but for those that only a type checker sees in the cli."""
    tree = ast.parse(source)
    for_types = set(_under_type_checking(tree)) if layer_of(module) == "cli" else set()
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt) and node not in for_types:
            found += [Import(module, node.lineno, name) for name in _imported(node, module, is_package)]
    return found


def violations(found: list[Import]) -> list[str]:
    """Return what breaks the table, one line each."""
    return [f"{each.where} imports {each.name}: {reason}" for each in found if (reason := _reason_against(each))]


def layer_of(module: str) -> str | None:
    """Return the layer that a module of mimoc belongs to."""
    top = [*module.split("."), "__init__"][1]
    return next((name for name, layer in LAYERS.items() if top in layer.modules), None)


def _imported(node: ast.stmt, module: str, is_package: bool) -> Iterator[str]:
    """Yield full names; of `from mimoc import body` a module's, of `from mimoc.units import m_to_cm` a function's."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        package = module.split(".") if is_package else module.split(".")[:-1]
        above = package[: len(package) - node.level + 1] if node.level else []
        origin = [*above, node.module] if node.module else above
        yield from (".".join([*origin, alias.name]) for alias in node.names)


def _under_type_checking(tree: ast.AST) -> Iterator[ast.AST]:
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) in {"TYPE_CHECKING", "typing.TYPE_CHECKING"}:
            for statement in node.body:
                yield from ast.walk(statement)


def _reason_against(each: Import) -> str | None:
    here, library = layer_of(each.module), each.name.split(".")[0]
    if here is None:
        return "the module is in no layer"
    if library != "mimoc":
        return _reason_against_library(each.module.split(".")[1:2], COMES_WITH.get(library, library), here)
    there = layer_of(each.name)
    if there is None:
        return "what it imports is in no layer"
    if there not in {here, "version"} | LAYERS[here].below:
        return f"{here} may not import {there}"
    return None


def _reason_against_library(top: list[str], library: str, here: str) -> str | None:
    if library in SHARED_LIBRARIES:
        return None
    if library not in LAYERS[here].libraries:
        homes = [name for name, layer in LAYERS.items() if library in layer.libraries]
        return f"{library} belongs to {', '.join(homes) or 'no layer'}"
    modules = MODULES_WITH_A_LIBRARY_OF_THEIR_OWN.get(library)
    if modules is not None and not modules & set(top):
        return f"{library} belongs to {', '.join(sorted(modules))}"
    return None


def _module_name(path: Path) -> str:
    parts = ("mimoc", *path.relative_to(ROOT).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = sorted(ROOT.rglob("*.py"))


@pytest.fixture(scope="module")
def all_imports() -> list[Import]:
    return [
        each
        for path in FILES
        for each in imports(_module_name(path), path.read_text(encoding="utf-8"), is_package=path.name == "__init__.py")
    ]


def test_every_import_follows_the_layers(all_imports):
    assert len(all_imports) > 200
    assert not violations(all_imports), "\n".join(violations(all_imports))


def test_every_module_is_in_exactly_one_layer():
    tops = {path.relative_to(ROOT).with_suffix("").parts[0] for path in FILES}
    homes = {top: [name for name, layer in LAYERS.items() if top in layer.modules] for top in tops}
    assert {top: found for top, found in homes.items() if len(found) != 1} == {}


def test_the_table_itself_has_no_cycle():
    """So no set of imports that keeps to it can have one between layers."""
    names = LAYERS.keys()
    graph = {
        name: LAYERS[name].below & names for name in names if name != "mimoc"
    }  # All may be had from the front door.
    assert len(list(TopologicalSorter(graph).static_order())) == len(LAYERS)


def test_modules_do_not_import_each_other_in_a_circle(all_imports):
    """Also within a layer; what is imported only inside a function, or for types, counts too."""
    known = {_module_name(path) for path in FILES}
    graph: dict[str, set[str]] = {name: set() for name in known}
    for each in all_imports:
        target = each.name if each.name in known else each.name.rpartition(".")[0]
        front_door = "mimoc" in (each.module, target)
        if target in known and target != each.module and not front_door and not each.module.startswith(f"{target}."):
            graph[each.module].add(target)
    TopologicalSorter(graph).prepare()  # Raises CycleError, which names them.


def test_each_owned_library_has_one_home():
    shared = {
        "mujoco": {"pipeline", "runtime"},
        "gymnasium": {"runtime", "recording", "mimoc"},
        "PIL": {"scene", "recording"},
    }
    for library in set().union(*(layer.libraries for layer in LAYERS.values())):
        homes = {name for name, layer in LAYERS.items() if library in layer.libraries}
        assert homes == shared.get(library, homes)
        assert len(homes) == len(shared.get(library, {library})), f"{library} lives in {homes}"


def test_no_file_is_a_drawer_for_odds_and_ends():
    assert not {path.stem for path in FILES} & {"utils", "util", "helpers", "helper", "misc", "common", "tools"}


@pytest.mark.parametrize(
    ("module", "source", "reason"),
    [
        ("mimoc.runtime.env", "from mimoc.body import grow", "runtime may not import body"),
        ("mimoc.runtime.env", "import mimoc.fits.tables", "runtime may not import fits"),
        ("mimoc.runtime.env", "from mimoc import scene", "runtime may not import scene"),
        ("mimoc.runtime.senses.touch", "from ...body import tree", "runtime may not import body"),
        ("mimoc.scene.world", "from mimoc.fits import load_tables", "scene may not import fits"),
        ("mimoc.scene.world", "def f():\n    from mimoc import pipeline", "scene may not import pipeline"),
        ("mimoc.body.grow", "if TYPE_CHECKING:\n    from mimoc.scene import SceneTree", "body may not import scene"),
        ("mimoc.files", "from mimoc.bundle import Bundle", "base may not import bundle"),
        ("mimoc.explain", "from mimoc.pipeline import build", "explain may not import pipeline"),
        ("mimoc.pipeline", "from mimoc.runtime import make", "pipeline may not import runtime"),
        ("mimoc.schema.spec", "import mimoc", "schema may not import mimoc"),
        ("mimoc.schema.spec", "import yaml", "yaml belongs to source"),
        ("mimoc.source", "import pydantic_core", "pydantic belongs to schema"),
        ("mimoc.body.grow", "from scipy.optimize import root", "scipy belongs to runtime"),
        ("mimoc.scene.world", "import mujoco", "mujoco belongs to pipeline, runtime"),
        ("mimoc.availability", "import mujoco", "mujoco belongs to pipeline, runtime, validation"),
        ("mimoc.__init__", "import gymnasium", "gymnasium belongs to making, recording, registration, runtime"),
        ("mimoc.body.grow", "import numpy, torch", "torch belongs to training"),
        ("mimoc.stray", "import math", "the module is in no layer"),
        ("mimoc.body.grow", "from mimoc import stray", "what it imports is in no layer"),
    ],
)
def test_a_module_that_breaks_the_table_is_found(module, source, reason):
    assert [each.split(": ", 1)[1] for each in violations(imports(module, source))] == [reason]


def test_what_only_a_type_checker_sees_is_free_in_the_cli():
    source = "if TYPE_CHECKING:\n    import mujoco\nelse:\n    import yaml"
    assert [each.name for each in imports("mimoc.console", source)] == ["yaml"]
    assert [each.name for each in imports("mimoc.bundle", source)] == ["mujoco", "yaml"]
