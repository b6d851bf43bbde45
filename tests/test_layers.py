"""Imports between rooms run down, and each library has its homes."""

import ast
import re
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
import yaml
from support.rooms import FILES, FLOOR_OF, Import, all_imports, arrows, imports, module_graph, room_of, runs_up

import mimoc
from mimoc.compiler import building, model_check
from mimoc.schema import InfantSpec
from mimoc.schema.names import PAIRED_GROUPS, STRENGTH_GROUPS, all_limb_bodies, trunk_bodies

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
        ("mimoc.studies.notebook", "from mimoc.cli.console import show", ("studies", "cli")),
        ("mimoc.body.grow", "from mimoc.stray import x", ("body", "stray")),
    ],
)
def test_an_import_that_runs_up_is_found(module, source, arrow):
    assert [one for one in arrows(imports(module, source)) if runs_up(one)] == [arrow]


@pytest.mark.parametrize("source", ["import yaml", "import_module('yaml')", "import_module(f'yaml.{name}')"])
def test_a_library_in_another_room_is_found(source):
    assert strays(imports("mimoc.fits.tables", source)) == ["mimoc.fits.tables:1 imports yaml"]


CONFIGS = sorted((Path(__file__).parents[1] / "configs").glob("*.yaml"))
IDENTIFIER = re.compile(r"^[A-Za-z_][A-Za-z0-9_]*$", re.ASCII)


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_geoms_meshes_textures_and_cameras_are_named_by_identifiers_of_their_own(path):
    """MuJoCo's USD exporter makes prims of geoms and cameras; MIMo has no names for geoms that are against it."""
    model = model_check.compile_model(building.build(InfantSpec.model_validate(yaml.safe_load(path.read_text()))).files)
    kinds = {"geom": model.ngeom, "mesh": model.nmesh, "tex": model.ntex, "camera": model.ncam, "light": model.nlight}
    for kind, count in kinds.items():
        names = [getattr(model, kind)(index).name for index in range(count)]
        assert [name for name in names if not IDENTIFIER.match(name)] == [], kind
        assert len(set(names)) == len(names), kind


def test_toys_are_named_by_identifiers():
    data = {"mimoc": 1, "name": "x", "age_months": 9, "scene": {"kind": "room", "toys": {"count": [20, 20]}}}
    model = model_check.compile_model(building.build(InfantSpec.model_validate(data)).files)
    toys = [model.body(body).name for body in range(model.nbody) if model.body(body).name.startswith("toy")]
    assert len(toys) == 20
    assert all(map(IDENTIFIER.match, toys))


ROOT = Path(mimoc.__file__).parent
RUNNING = (
    *("runtime/*.py", "policies/*.py", "policies/control/*.py"),
    *("components/tasks/*/run.py", "components/actuation/run.py", "components/senses/*/run.py", "recording/*.py"),
)
RUNNING_FILES = sorted(path for pattern in RUNNING for path in ROOT.glob(pattern))
OF_BUILDING = ("build", "spec")  # Beginnings of the names of files of tasks and actuation models that build.
# What columns, postures and rhythms are of: they are named like parts of the body.
NAMED_LIKE_PARTS = {
    "recording/movement_groups.py",
    *(f"policies/{name}.py" for name in ("control/infant", "control/postures", "general_movements", "movement_law")),
}

CAMERAS = {"eye_left", "eye_right"}
PARTS = {*trunk_bodies(), *all_limb_bodies(), *(set(STRENGTH_GROUPS) - set(PAIRED_GROUPS)), *CAMERAS}
"""Groups of both sides, such as `legs`, are also words for what a manifest has."""
SIDED = re.compile(r"\b(robot:|act:|(left|right)_[a-z])")


def literals(source: str) -> Iterator[tuple[int, str]]:
    tree = ast.parse(source)
    alone = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in alone:
            yield node.lineno, node.value


def names(source: str) -> list[str]:
    """Return the texts of a module that name a part of the body, with their lines."""
    return [f"{line}: {text}" for line, text in literals(source) if text in PARTS or SIDED.search(text)]


@pytest.mark.parametrize("path", RUNNING_FILES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_no_part_of_the_body_is_named_where_an_infant_runs(path):
    if not path.name.startswith(OF_BUILDING) and path.relative_to(ROOT).as_posix() not in NAMED_LIKE_PARTS:
        assert names(path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    "source", ['model.body("head")', 'HANDS = ("left_hand",)', 'x = f"robot:{side}_elbow"', 'camera("eye_left")']
)
def test_a_module_that_names_one_is_found(source):
    assert names(source)


def test_the_manifest_names_only_what_the_model_has(built):
    for removed in ([], ["left_hand", "right_eye"], ["right_upper_arm", "left_upper_leg", "right_foot"]):
        bundle = built(body={"remove": removed})
        env, anatomy = mimoc.InfantEnv(bundle), bundle.manifest.anatomy
        limbs = (*anatomy.arms, *anatomy.legs)
        bodies = {anatomy.head, *anatomy.trunk, *(limb.root for limb in limbs), *(eye.body for eye in anatomy.eyes)}
        bodies |= {limb.end for limb in limbs if limb.end}
        assert not bodies & set(removed)
        assert all(env.model.body(name).id > 0 for name in bodies)
        assert all(env.model.camera(eye.camera).bodyid[0] == env.model.body(eye.body).id for eye in anatomy.eyes)
        hinges = [joint for group in anatomy.groups.values() for joint in group]
        assert sorted(hinges) == sorted(env.model.joint(index).name for index in range(1, env.model.njnt))
