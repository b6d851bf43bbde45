import json
import os
import re
import subprocess
import sys
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import pytest

import mimoc

HEAVY = ["mujoco", "scipy", "pydantic", "yaml", "jinja2", "lxml", "trimesh", "PIL", "typer", "rich", "matplotlib"]


def python(*lines):
    """Return what some lines print, as JSON, in a Python of their own; anything on standard error is a failure."""
    code = "\n".join(("import json, sys", *lines))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def folder(bundle_at, tmp_path_factory):
    return mimoc.write_bundle(bundle_at(9), tmp_path_factory.mktemp("bundles") / "infant")


@pytest.mark.parametrize("package", [pytest.param("mimoc", marks=pytest.mark.extras), "mimoc.plugin", "mimoc.schema"])
def test_every_public_name_is_there(package):
    module = import_module(package)
    assert all(getattr(module, name) is not None for name in module.__all__)
    assert dir(module) == module.__all__ == sorted(module.__all__)
    assert len(module.__all__) > 10


def test_a_name_that_mimoc_does_not_have_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'mimoc' has no attribute 'biuld'"):
        _ = mimoc.biuld
    assert not hasattr(mimoc, "biuld")


def test_the_version_is_that_of_the_installed_package():
    assert mimoc.__version__ == version("mimoc")


def test_importing_mimoc_loads_nothing_heavy():
    heavy = [*HEAVY, "gymnasium", "numpy"]
    assert python("import mimoc", f"print(json.dumps([m for m in {heavy} if m in sys.modules]))") == []


def test_loading_a_spec_loads_no_mathematics_and_no_mujoco(folder):
    loaded = python(
        "from mimoc.schema import read_spec",
        "from mimoc.schema.source import read",
        f"read_spec(read({str(folder / 'spec.yaml')!r}))",
        f"print(json.dumps([m for m in {HEAVY} if m in sys.modules]))",
    )
    assert loaded == ["pydantic", "yaml"]


def test_running_a_bundle_loads_nothing_that_compiles(folder):
    loaded = python(
        "import mimoc",
        f"mimoc.make({str(folder)!r}).reset(seed=0)",
        f"print(json.dumps([m for m in sys.modules if m in {HEAVY} or m.startswith('mimoc.')]))",
    )
    assert not {"scipy", "jinja2", "lxml", "trimesh", "PIL", "typer", "rich", "matplotlib"} & set(loaded)
    assert not {"mimoc.body.tree", "mimoc.body.grow", "mimoc.compiler.mjcf", "mimoc.fits", "mimoc.compiler"} & set(
        loaded
    )


MAKE = "env = gymnasium.make({name!r}, bundle={folder!r}); print(json.dumps(list(env.reset(seed=0)[0])))"


@pytest.mark.full
@pytest.mark.parametrize(
    ("imports", "name"),
    [
        ("import mimoc, gymnasium", "mimoc/Infant-v0"),
        ("import gymnasium, mimoc", "mimoc/Infant-v0"),
        ("import gymnasium", "mimoc:mimoc/Infant-v0"),
        ("import mimoc, gymnasium", "mimoc:mimoc/Infant-v0"),
    ],
)
def test_gymnasium_makes_infants_whatever_was_imported_first(imports, name, folder):
    senses = python(imports, MAKE.format(name=name, folder=str(folder)))
    assert senses == ["proprioception", "vestibular"]


def test_gymnasium_is_loaded_as_without_mimoc():
    counted = "len(sys.meta_path)"
    before, waiting, after, loader = python(
        f"before = {counted}",
        "import mimoc",
        f"waiting = {counted}",
        "import gymnasium",
        "loader = type(gymnasium.envs.registration.__spec__.loader).__name__",
        f"print(json.dumps([before, waiting, {counted}, loader]))",
    )
    assert (before, waiting, after) == (before, before + 1, before)
    assert loader == "SourceFileLoader"


def test_registering_again_changes_nothing():
    assert python(
        "import gymnasium, mimoc",
        "from mimoc.runtime import register_envs",
        "before = dict(gymnasium.registry)",
        "register_envs()",
        "print(json.dumps(before == dict(gymnasium.registry)))",
    )


CHECKOUT = Path(__file__).resolve().parents[1]
GOALS = re.findall(r"^([a-z-]+):", (CHECKOUT / "Makefile").read_text(), re.MULTILINE)
TASKS = re.findall(r"^([a-z]+)\(\) ", (CHECKOUT / ".ci" / "task").read_text(), re.MULTILINE)
OF_MAKE = ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "TESTS")
"""Variables by which a `make` that runs this test would have its say."""


@pytest.mark.parametrize(("asked", "run"), [((), "tests"), (("TESTS=tests/runtime/device",), "tests/runtime/device")])
def test_make_test_runs_all_tests_or_the_part_that_is_named(asked, run):
    (tests,) = [line for line in recipes("test", *asked).splitlines() if line.strip().startswith('"tests: ')]
    assert tests.split()[-1] == f'{run}"'


def recipes(*asked: str) -> str:
    command = ["make", "--dry-run", "--always-make", *asked]
    env = {name: value for name, value in os.environ.items() if name not in OF_MAKE}
    return subprocess.run(command, cwd=CHECKOUT, env=env, capture_output=True, text=True, check=True, timeout=60).stdout


@pytest.mark.parametrize("goal", GOALS)
def test_the_shell_can_read_all_that_a_goal_runs(goal):
    """A comment sign in a variable of make once cut a recipe in the midst of a string."""
    read = subprocess.run(["sh", "-n"], input=recipes(goal), capture_output=True, text=True, timeout=60)
    assert (read.returncode, read.stderr) == (0, "")


def test_tasks_are_listed_with_what_they_do_and_others_refused():
    listed = subprocess.run([".ci/task"], cwd=CHECKOUT, capture_output=True, text=True, timeout=60, check=True)
    names = [line.split()[0] for line in listed.stdout.splitlines()]
    assert names == sorted(names)
    assert {*TASKS} == {*names, "needs"}
    refused = subprocess.run([".ci/task", "fuz"], cwd=CHECKOUT, capture_output=True, text=True, timeout=60, check=False)
    assert (refused.returncode, refused.stdout.splitlines()[0]) == (2, "'fuz' is not a task. The tasks are:")


def test_every_task_and_goal_that_a_page_names_exists():
    pages = [CHECKOUT / "README.md", CHECKOUT / "CONTRIBUTING.md", *(CHECKOUT / "docs").rglob("*.md")]
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    tasks = set(re.findall(r"\.ci/task ([a-z]+)", text))
    assert tasks
    assert tasks <= set(TASKS)
    assert set(re.findall(r"`make ([a-z-]+)`", text)) <= set(GOALS)
