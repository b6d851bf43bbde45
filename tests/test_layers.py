"""Imports between rooms run down, and each library has its homes."""

import sys
from graphlib import TopologicalSorter

import pytest
from support.rooms import FILES, FLOOR_OF, Import, all_imports, arrows, imports, module_graph, room_of, runs_up

HOMES = {  # The rooms that may import each library.
    "OpenGL": "render",
    "PIL": "compiler render movement recording studies viewer",
    "array_api_compat": "runtime",
    "array_api_strict": "runtime",
    "av": "recording",
    "coacd": "components",
    "fast_simplification": "components",
    "glfw": "render",
    "gymnasium": "runtime components recording compat training viewer",
    "jinja2": "compiler studies",
    "lxml": "compiler",
    "matplotlib": "render",
    "minari": "recording",
    "mujoco": "bundle compiler render motion runtime components policies recording compat movement studies viewer",
    "mujoco_warp": "runtime components",
    "pettingzoo": "runtime",
    "platformdirs": "compiler components",
    "pyarrow": "recording studies",
    "pydantic": "schema bundle motion components policies",
    "pydantic_core": "schema motion",
    "ray": "studies",
    "rich": "cli",
    "rsl_rl": "training",
    "scipy": "base motion runtime components policies movement studies",
    "stable_baselines3": "training",
    "submitit": "studies",
    "tensorboard": "training",
    "tensordict": "training",
    "torch": "runtime components training",
    "trimesh": "components viewer",
    "typer": "cli",
    "viser": "viewer",
    "warp": "runtime components",
    "websockets": "viewer",
    "yaml": "schema",
}
EVERYWHERE = {"mimoc", "numpy", *sys.stdlib_module_names}


@pytest.fixture(scope="module")
def found() -> list[Import]:
    return all_imports()


def strays(found: list[Import]) -> list[str]:
    """Return the imports of libraries that are not at home where they are imported."""
    libraries = [(each, each.name.split(".")[0]) for each in found]
    return [
        f"{each.module}:{each.line} imports {library}"
        for each, library in libraries
        if library not in EVERYWHERE and room_of(each.module) not in HOMES.get(library, "").split()
    ]


def test_every_module_is_in_a_room(found):
    assert {room_of(each.module) for each in found} <= FLOOR_OF.keys()


def test_imports_between_rooms_run_down(found):
    assert len(found) > 4000
    assert {arrow: where for arrow, where in arrows(found).items() if runs_up(arrow)} == {}


def test_each_library_is_imported_where_it_is_at_home(found):
    assert strays(found) == []


def test_modules_do_not_import_each_other_in_a_circle(found):
    """Also within a room; what is imported only inside a function, or for types, counts too."""
    TopologicalSorter(module_graph(found)).prepare()  # Raises CycleError, which names them.


def test_no_file_is_a_drawer_for_odds_and_ends():
    assert not {path.stem for path in FILES} & {"utils", "util", "helpers", "helper", "misc", "common", "tools"}


@pytest.mark.parametrize(
    ("module", "source", "arrow"),
    [
        ("mimoc.runtime.env", "from mimoc.policies import rollout", ("runtime", "policies")),
        ("mimoc.runtime.env", "import mimoc.components.senses.touch.run", ("runtime", "components")),
        ("mimoc.bundle.io", "from ..compiler import pipeline", ("bundle", "compiler")),
        ("mimoc.body.grow", "def f():\n    from mimoc.bundle import io", ("body", "bundle")),
        ("mimoc.body.grow", "if TYPE_CHECKING:\n    from mimoc.compiler.mjcf.scene import X", ("body", "compiler")),
        ("mimoc.runtime.env", "CODE = 'mimoc.components.senses.touch.run'", ("runtime", "components")),
        ("mimoc.schema.infant", "import mimoc", ("schema", "mimoc")),
        ("mimoc.studies.bodies", "from mimoc.cli.console import show", ("studies", "cli")),
        ("mimoc.body.grow", "from mimoc.stray import x", ("body", "stray")),
    ],
)
def test_an_import_that_runs_up_is_found(module, source, arrow):
    assert [one for one in arrows(imports(module, source)) if runs_up(one)] == [arrow]


@pytest.mark.parametrize("source", ["import yaml", "import_module('yaml')", "import_module(f'yaml.{name}')"])
def test_a_library_in_another_room_is_found(source):
    assert strays(imports("mimoc.fits.tables", source)) == ["mimoc.fits.tables:1 imports yaml"]
