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
FILES = sorted(ROOT.rglob("*.py"))
MODULES = {
    ".".join(("mimoc", *path.relative_to(ROOT).with_suffix("").parts)).removesuffix(".__init__"): path for path in FILES
}


@dataclass(frozen=True)
class Layer:
    """Some modules that stand on one step of the way from a spec to an environment."""

    modules: tuple[str, ...]
    """Folders and modules under `mimoc`, without those in it that another layer names."""
    below: frozenset[str]
    """The other layers it may import."""
    libraries: frozenset[str]
    """The owned libraries it may import."""


def layer(modules: str, below: str = "", libraries: str = "") -> Layer:
    return Layer(tuple(modules.split()), frozenset(below.split()), frozenset(libraries.split()))


BASE = "version errors units streams geometry files"
LANGUAGE = f"{BASE} grammar language kinds quantities composition spec"
BUILDING = f"{LANGUAGE} schema bundle fits parts body mjcf looks build"
RUNNING = f"{LANGUAGE} bundle drawing terms run runtime reading measuring control"
KIND_FOLDERS = {
    "senses": "run",
    "tasks": "run",
    "actuation": "run",
    "delays": "run",
    "noise": "run",
    "companions": "run",
    "scenes": "build",
    "toys": "build",
    "objects": "build",
    "policies": "policies",
    "exporters": "recording",
    "columns": "reading",
    "motion": "motion",
}
"""Folders of kinds, and the layer of a file there whose prefix does not say it."""
PREFIXES = {"spec": "spec", "build": "build", "run": "run", "kernel": "device"}
"""Layer of the files in the kinds' folders that begin so: `build.py`, `build_points.py`. A record is a `spec`."""

LAYERS = {
    "version": layer("version base"),
    "signals": layer("base.interruption"),
    "errors": layer("base.errors base.lazy base.classes"),
    "units": layer("base.units base.mujoco_layout"),
    "streams": layer("base.random_streams"),
    "geometry": layer("geometry base.rounding", "errors units", "scipy"),
    "files": layer("bundle.files", "errors version geometry"),
    "grammar": layer("schema.base", "errors", "pydantic"),
    "part": layer("body.part", "geometry"),
    "parts": layer(
        "body.anatomy body.parts body.dimensions body.segments body.sections body.published_figures",
        "errors units geometry part kinds",
    ),
    "language": layer(
        "schema.body schema.entries schema.expressions schema.looks schema.names schema.quantities schema.source"
        " schema.yaml_document",
        "errors units grammar part parts",
        "pydantic yaml",
    ),
    "kinds": layer("base.kinds", "errors grammar part"),
    "quantities": layer("quantities", "kinds"),
    "composition": layer("schema.composition", "errors grammar language kinds", "pydantic"),
    "spec": layer("", "errors units grammar language kinds composition", "pydantic"),
    "schema": layer("schema plugins", f"{LANGUAGE} fits part parts", "pydantic"),
    "bundle": layer("bundle", f"{LANGUAGE} schema", "pydantic mujoco"),
    "fits": layer("fits", "errors units geometry"),
    "body": layer("body", f"{LANGUAGE} schema fits part parts"),
    "mjcf": layer("mjcf", f"{BASE} grammar language parts body", "jinja2 lxml platformdirs"),
    "looks": layer("looks", f"{BASE} grammar language body mjcf", "PIL"),
    "build": layer(
        "", f"{LANGUAGE} schema bundle parts body mjcf looks", "trimesh coacd fast_simplification platformdirs"
    ),
    "compiler": layer("compiler", BUILDING, "mujoco"),
    "drawing": layer("render", f"{BASE} bundle", "mujoco scipy glfw OpenGL PIL"),
    "plots": layer("render.plots", f"{BASE} quantities schema fits body", "matplotlib"),
    "terms": layer(
        "runtime.worlds runtime.term runtime.filter runtime.array_library runtime.term_contract",
        "errors",
        "mujoco torch array_api_compat array_api_strict",
    ),
    "run": layer(
        "base.model_fields base.state_form base.sound", f"{LANGUAGE} bundle drawing terms", "gymnasium mujoco scipy"
    ),
    "runtime": layer("runtime", f"{LANGUAGE} bundle drawing terms run", "gymnasium mujoco scipy"),
    "device": layer(
        "runtime.device",
        f"{LANGUAGE} bundle drawing terms run runtime",
        "gymnasium mujoco warp mujoco_warp torch array_api_compat",
    ),
    "multi": layer("runtime.parallel_env", "runtime", "pettingzoo"),
    "reading": layer("", "errors units kinds spec bundle terms run runtime", "mujoco"),
    "motion": layer("motion", f"{LANGUAGE} schema bundle", "mujoco pydantic scipy"),
    "measuring": layer(
        "quantities.measuring quantities.run_motion quantities.run_movement_units",
        "errors kinds quantities bundle terms runtime motion",
        "mujoco scipy",
    ),
    "control": layer("control", f"{LANGUAGE} bundle run", "mujoco scipy"),
    "policies": layer("policies", f"{RUNNING} motion", "mujoco pydantic"),
    "rollout": layer("runtime.rollout", f"{RUNNING} policies", "mujoco"),
    "recording": layer("recording", f"{RUNNING} rollout policies", "gymnasium av PIL mujoco pyarrow minari"),
    "training": layer(
        "training importers",
        f"{BUILDING} compiler {RUNNING} device plots rollout policies recording opening",
        "gymnasium mujoco stable_baselines3 torch tensorboard rsl_rl tensordict",
    ),
    "movement": layer(
        "movement",
        f"{BUILDING} compiler {RUNNING} motion plots rollout policies recording opening worlds",
        "mujoco scipy PIL",
    ),
    "worlds": layer("parallel", f"{BUILDING} compiler {RUNNING} multi training", "gymnasium"),
    "retargeting": layer(
        "retargeting", f"{BUILDING} compiler {RUNNING} motion rollout policies recording opening", "mujoco scipy"
    ),
    "studies": layer(
        "studies",
        f"{BUILDING} compiler {RUNNING} motion movement plots rollout policies recording training opening",
        "gymnasium mujoco scipy",
    ),
    "cohorts": layer(
        "cohorts",
        f"{BUILDING} compiler {RUNNING} rollout policies recording training studies",
        "pyarrow submitit ray",
    ),
    "reporting": layer(
        "reporting",
        f"{BUILDING} compiler {RUNNING} recording training cohorts plots",
        "jinja2 mujoco PIL",
    ),
    "opening": layer("environments recordings", f"{BUILDING} compiler {RUNNING} recording", "gymnasium"),
    "compat": layer("compat", f"{BUILDING} compiler {RUNNING} opening", "gymnasium mujoco"),
    "viewer": layer(
        "viewer",
        f"{BUILDING} compiler {RUNNING} motion retargeting rollout policies recording opening plots",
        "gymnasium mujoco PIL trimesh viser websockets",
    ),
    "mimoc": layer(
        "__init__ plugin vector_environments registration notebook",
        f"signals part {BUILDING} compiler {RUNNING} device multi rollout policies recording training cohorts "
        "reporting opening viewer studies motion movement retargeting worlds",
        "gymnasium",
    ),
    "cli": layer(
        "cli __main__",
        f"{BUILDING} compiler {RUNNING} plots rollout policies recording training cohorts reporting "
        "opening viewer studies mimoc signals motion movement retargeting",
        "typer rich",
    ),
}
"""The way from a spec to an environment, from the bottom up. A module belongs to the layer that names it, or else the
closest folder above it; those in the folders of kinds belong where their prefix says."""
LAYER_OF = {path: name for name, layer in LAYERS.items() for path in layer.modules}

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
    by_string: bool = False
    """Whether a string names it, instead of an import statement."""

    @property
    def where(self) -> str:
        return f"{self.module}:{self.line}"


def imports(module: str, source: str, *, is_package: bool = False) -> list[Import]:
    """Return every import of a module, wherever it stands, but for those that only a type checker sees in the cli.

    A string that is the name of a module of mimoc, or that `import_module` gets, counts as an import. Only the record
    of a kind names the code in its own folder, and what runs on a device, without importing it, which is what a record
    is for.
    """
    tree = ast.parse(source)
    for_types = set(_under_type_checking(tree)) if layer_of(module) == "cli" else set()
    result = []
    for node in ast.walk(tree):
        if node not in for_types:
            result += [Import(module, node.lineno, name) for name in _imported(node, module, is_package)]
            result += [Import(module, node.lineno, name, by_string=True) for name in _named(node)]
    return [item for item in result if not _is_code_of_record(item)]


def violations(found: list[Import]) -> list[str]:
    """Return what breaks the table, one line each."""
    return [f"{each.where} imports {each.name}: {reason}" for each in found if (reason := _reason_against(each))]


def layer_of(module: str) -> str | None:
    """Return the layer that a module of mimoc belongs to; in `base/` it is the one of its own name."""
    name = module.partition(".")[2] or "__init__"
    if name.partition(".")[0] in KIND_FOLDERS:
        return _layer_of_kind(module, name)
    while name not in LAYER_OF and name:
        name = name.rpartition(".")[0]
    return LAYER_OF.get(name)


def _layer_of_kind(module: str, name: str) -> str:
    """Return the layer of a module in a kind's folder: it declares, it builds, it runs, or it is for a device."""
    if module in MODULES and MODULES[module].name == "__init__.py":
        return "spec"
    prefix = name.rpartition(".")[2].partition("_")[0]
    return PREFIXES.get(prefix, KIND_FOLDERS[name.partition(".")[0]])


def module_of(name: str) -> str:
    """Return the module that a name is imported from: the name itself, or all of it but its end."""
    return name if name in MODULES or name.count(".") == 0 else name.rpartition(".")[0]


def _imported(node: ast.AST, module: str, is_package: bool) -> Iterator[str]:
    """Yield full names; of `from mimoc import body` a module's, of `from mimoc.body import grow_body` a function's."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        package = module.split(".") if is_package else module.split(".")[:-1]
        above = package[: len(package) - node.level + 1] if node.level else []
        origin = [*above, node.module] if node.module else above
        yield from (".".join([*origin, alias.name]) for alias in node.names)


def _named(node: ast.AST) -> Iterator[str]:
    """Yield what a string imports: `"mimoc.senses.touch.run"`, `import_module("torch")`, `import_module(f"av.{x}")`."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        name = node.value.partition(":")[0]
        if name in MODULES and name != "mimoc":
            yield name
    elif isinstance(node, ast.Call) and node.args and ast.unparse(node.func).split(".")[-1] == "import_module":
        (first, *_) = getattr(node.args[0], "values", [node.args[0]])  # The first part of an f-string.
        if isinstance(first, ast.Constant) and not first.value.startswith("mimoc"):
            yield first.value.rstrip(".")


def _is_code_of_record(item: Import) -> bool:
    """Return whether a kind's record names code of the kind, such as `mimoc.senses.touch.run`, or its device part."""
    folder = item.module.removeprefix("mimoc.").partition(".")[0]
    packages = (f"mimoc.{folder}.run_",) if folder == "quantities" else (f"{item.module}.", "mimoc.runtime.device.")
    return item.by_string and folder in (*KIND_FOLDERS, "quantities") and item.name.startswith(packages)


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
        return _reason_against_library(COMES_WITH.get(library, library), here)
    there = layer_of(module_of(each.name))
    if there is None:
        return "what it imports is in no layer"
    if there not in {here} | LAYERS[here].below:
        return f"{here} may not import {there}"
    return None


def _reason_against_library(library: str, here: str) -> str | None:
    if library in SHARED_LIBRARIES or library in LAYERS[here].libraries:
        return None
    homes = [name for name, layer in LAYERS.items() if library in layer.libraries]
    return f"{library} belongs to {', '.join(homes) or 'no layer'}"


@pytest.fixture(scope="module")
def all_imports() -> list[Import]:
    return [
        each
        for module, path in MODULES.items()
        for each in imports(module, path.read_text(encoding="utf-8"), is_package=path.name == "__init__.py")
    ]


def test_every_import_follows_the_layers(all_imports):
    assert len(all_imports) > 200
    assert not violations(all_imports), "\n".join(violations(all_imports))


def test_every_module_is_in_a_layer():
    assert [module for module in MODULES if layer_of(module) is None] == []


def test_the_table_itself_has_no_cycle():
    """So no set of imports that keeps to it can have one between layers."""
    names = LAYERS.keys()
    graph = {
        name: LAYERS[name].below & names for name in names if name != "mimoc"
    }  # All may be had from the front door.
    assert len(list(TopologicalSorter(graph).static_order())) == len(LAYERS)


def test_modules_do_not_import_each_other_in_a_circle(all_imports):
    """Also within a layer; what is imported only inside a function, or for types, counts too."""
    known = MODULES.keys()
    graph: dict[str, set[str]] = {name: set() for name in known}
    for each in all_imports:
        target = each.name if each.name in known else each.name.rpartition(".")[0]
        front_door = "mimoc" in (each.module, target)
        if target in known and target != each.module and not front_door and not each.module.startswith(f"{target}."):
            graph[each.module].add(target)
    TopologicalSorter(graph).prepare()  # Raises CycleError, which names them.


def test_no_file_is_a_drawer_for_odds_and_ends():
    assert not {path.stem for path in FILES} & {"utils", "util", "helpers", "helper", "misc", "common", "tools"}


@pytest.mark.parametrize(
    ("module", "source", "reason"),
    [
        ("mimoc.runtime.env", "from mimoc.body import grow_tree", "runtime may not import body"),
        ("mimoc.runtime.env", "import mimoc.fits.tables", "runtime may not import fits"),
        ("mimoc.runtime.env", "from mimoc import compiler", "runtime may not import compiler"),
        ("mimoc.senses.touch.run", "from ...body import tree", "run may not import body"),
        ("mimoc.senses.touch.run", "from mimoc.senses.touch import build", "run may not import build"),
        ("mimoc.tasks.reach.run", "from mimoc.runtime.env import InfantEnv", "run may not import runtime"),
        ("mimoc.tasks.reach.build", "from mimoc.tasks.reach.run import ReachTask", "build may not import run"),
        ("mimoc.senses.touch.build", "from mimoc.control import PositionTask", "build may not import control"),
        ("mimoc.senses.touch.spec", "from mimoc.body import BodyTree", "spec may not import body"),
        ("mimoc.senses.touch", "from mimoc.senses.touch import build", "spec may not import build"),
        ("mimoc.senses.touch.run_forces", "from mimoc.senses.touch.build_points import f", "run may not import build"),
        ("mimoc.senses.touch.build_points", "from mimoc.senses.touch.run import f", "build may not import run"),
        ("mimoc.senses.touch.run", "from mimoc.senses.touch.kernel import f", "run may not import device"),
        ("mimoc.senses.touch.run", "import warp", "warp belongs to device"),
        ("mimoc.senses.touch.specks", "from mimoc.body import grow", "run may not import body"),
        ("mimoc.toys.paint", "from mimoc.runtime.env import InfantEnv", "build may not import runtime"),
        ("mimoc.base.errors", "from mimoc.base.units import m_to_cm", "errors may not import units"),
        ("mimoc.training.trainer", "from mimoc.studies import run_experiment", "training may not import studies"),
        ("mimoc.render.portrait", "from mimoc.runtime.env import InfantEnv", "drawing may not import runtime"),
        ("mimoc.scenes.crib.build", "from mimoc.fits import load_tables", "build may not import fits"),
        ("mimoc.scenes.crib.build", "def f():\n    from mimoc import compiler", "build may not import compiler"),
        ("mimoc.runtime.env", "CODE = 'mimoc.body.grow'", "runtime may not import body"),
        ("mimoc.bundle.io", "import_module('mimoc.notebook')", "bundle may not import mimoc"),
        ("mimoc.fits.tables", "import_module('yaml')", "yaml belongs to language"),
        ("mimoc.fits.tables", "import_module(f'yaml.{name}')", "yaml belongs to language"),
        ("mimoc.senses.touch", "KIND = SenseKind(build='mimoc.senses.vision.build')", "spec may not import build"),
        (
            "mimoc.body.masses",
            "if TYPE_CHECKING:\n    from mimoc.mjcf.tree import SceneTree",
            "body may not import mjcf",
        ),
        ("mimoc.bundle.files", "from mimoc.bundle.io import Bundle", "files may not import bundle"),
        ("mimoc.compiler.pipeline", "from mimoc.runtime import make", "compiler may not import runtime"),
        ("mimoc.schema.base", "from mimoc.schema.infant import InfantSpec", "grammar may not import schema"),
        ("mimoc.schema.infant", "import mimoc", "schema may not import mimoc"),
        ("mimoc.fits.tables", "import yaml", "yaml belongs to language"),
        (
            "mimoc.base.errors",
            "import pydantic_core",
            "pydantic belongs to grammar, language, composition, spec, schema, bundle, motion, policies",
        ),
        ("mimoc.compiler.explain", "import typer", "typer belongs to cli"),
        ("mimoc.body.grow", "import numpy, torch", "torch belongs to terms, device, training"),
        ("mimoc.stray", "import math", "the module is in no layer"),
        ("mimoc.body.grow", "from mimoc import stray", "body may not import mimoc"),
    ],
)
def test_a_module_that_breaks_the_table_is_found(module, source, reason):
    assert [each.split(": ", 1)[1] for each in violations(imports(module, source))] == [reason]


def test_what_only_a_type_checker_sees_is_free_in_the_cli():
    source = "if TYPE_CHECKING:\n    import mujoco\nelse:\n    import yaml"
    assert [each.name for each in imports("mimoc.cli.console", source)] == ["yaml"]
    assert [each.name for each in imports("mimoc.bundle.io", source)] == ["mujoco", "yaml"]
