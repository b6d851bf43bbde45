"""The wheel alone is enough: installed elsewhere, it builds an infant that plain MuJoCo opens."""

import ast
import re
import sys
import tomllib
import zipfile
from collections.abc import Callable
from email.parser import BytesParser
from functools import cache
from pathlib import Path

import mujoco
import pytest
from support.full import FULL
from support.installed import install

import mimoc

CHECKOUT = Path(__file__).resolve().parents[1]
Run = Callable[..., str]


@pytest.fixture(scope="module")
def run(wheel, tmp_path_factory) -> Run:
    """Return a function that runs a program of a new environment with the wheel, in an empty folder."""
    program_of = install(tmp_path_factory.mktemp("environment"), wheel)

    def run(program: str, *arguments: object) -> str:
        done = program_of(program, *arguments)
        assert done.returncode == 0, f"{program} {arguments}: {done.stdout}{done.stderr}"
        return done.stdout

    return run


@pytest.fixture(scope="module")
def installed(run) -> Path:
    return Path(run("python", "-c", "import mimoc; print(mimoc.__file__)").strip()).parent


def test_the_wheel_has_everything_and_nothing_else(wheel):
    with zipfile.ZipFile(wheel) as archive:
        inside = {name: archive.read(name) for name in archive.namelist() if ".dist-info/" not in name}
    assert inside == {
        **_files(CHECKOUT / "mimoc", "mimoc"),
        **_files(CHECKOUT / "data", "mimoc/data"),
        **_files(CHECKOUT / "configs", "mimoc/configs"),
    }
    configs = "newborn six_months nine_months eighteen_months two_years five_finger individual one_arm"
    who = (f"who/{size}_for_age" for size in ("length", "weight", "head_circumference", "arm_circumference"))
    expected = {
        *("mimoc/py.typed", "mimoc/data/README.md"),
        *(f"mimoc/templates/{name}.j2" for name in ("infant.xml", "scene.xml", "README.md")),
        *(f"mimoc/data/{name}.csv" for name in ("anthrokids", "anthrokids_published_fits", "postures", *who)),
        *(f"mimoc/configs/{name}.yaml" for name in configs.split()),
    }
    assert expected <= inside.keys()


def test_the_wheel_says_what_it_is(wheel):
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        metadata = BytesParser().parsebytes(archive.read(name))
        assert any(name.endswith("/LICENSE") for name in archive.namelist())
    assert (metadata["Name"], metadata["Version"]) == ("mimoc", mimoc.__version__)
    assert metadata["License-Expression"] == "MIT"
    extras = "multi report toys record minari train gpu slurm ray live test pages docs dev"
    assert set(metadata.get_all("Provides-Extra") or ()) == set(extras.split())


@pytest.mark.full
def test_mimoc_comes_from_the_wheel(run, installed):
    assert CHECKOUT not in installed.parents
    assert (installed / "data/anthrokids.csv").is_file()
    assert not run("python", "-c", f"import sys; print([p for p in sys.path if p == {str(CHECKOUT)!r}] or '')").strip()


@pytest.mark.full
def test_a_config_that_ships_builds_and_plain_mujoco_opens_it(run, installed, tmp_path):
    out = tmp_path / "infant"
    assert str(out) in run("mimoc", "build", installed / "configs/nine_months.yaml", "-o", out)
    for file in ("scene.xml", "infant.xml"):
        model = mujoco.MjModel.from_xml_path(str(out / file))
        assert model.nu == 44
        mujoco.mj_step(model, mujoco.MjData(model))
    assert mimoc.read_bundle(out).files == mimoc.build(CHECKOUT / "configs" / "nine_months.yaml").files


@FULL
def test_the_examples_of_the_help_can_be_written_and_built(run):
    run("mimoc", "new", "nine_months.yaml", "--like", "nine_months")
    assert "out/nine_months" in run("mimoc", "build", "nine_months.yaml", "-o", "out/nine_months")


@FULL
def test_commands_work_elsewhere(run):
    assert "within one SD of the mean of WHO's boys and girls" in run("mimoc", "validate", "--against", "who")
    assert "mimoc build" in run("python", "-m", "mimoc", "--help")
    assert run("mimoc", "--version").strip() == f"mimoc {mimoc.__version__}"


@FULL
def test_gymnasium_finds_the_environment_of_the_wheel(run, installed, tmp_path):
    run("mimoc", "build", installed / "configs/newborn.yaml", "-o", tmp_path / "newborn")
    code = f"""
import gymnasium
env = gymnasium.make("mimoc:mimoc/Infant-v0", bundle={str(tmp_path / "newborn")!r})
env.reset(seed=0)
env.step(env.action_space.sample())
print(type(env.unwrapped).__module__)
"""
    assert run("python", "-c", code).strip() == "mimoc.runtime.env"


def _files(folder: Path, name: str) -> dict[str, bytes]:
    return {
        f"{name}/{path.relative_to(folder).as_posix()}": path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


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
