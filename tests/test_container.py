"""The container's definition is enough: its steps, run in an empty environment, give a mimoc that passes its test."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import Distribution, distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from support.full import FULL

import mimoc

CHECKOUT = Path(__file__).resolve().parents[1]
DEFINITION = CHECKOUT / "containers" / "mimoc.def"
SCRIPTS = ("post", "environment", "runscript", "test")
OFFLINE = {"PIP_NO_DEPS": "1", "PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_QUIET": "1"}


@dataclass(frozen=True)
class Container:
    """An empty environment after the steps of the definition, in a folder that stands for `/`."""

    root: Path
    sections: Mapping[str, str]

    def run(self, script: str, *arguments: str, **environment: str) -> subprocess.CompletedProcess:
        inside = f"{self.sections['environment']}\n{script}".replace("/opt/", f"{self.root}/opt/")
        clean = {"PATH": os.defpath, "HOME": str(self.root), "TMPDIR": str(self.root)} | environment
        command = ["/bin/sh", "-c", inside, "sh", *arguments]
        return subprocess.run(command, cwd=self.root, env=clean, capture_output=True, text=True, timeout=300)


@pytest.fixture(scope="module")
def sections() -> dict[str, str]:
    header, *parts = re.split(r"^%(\w+).*\n", DEFINITION.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {"header": header, **dict(zip(parts[::2], parts[1::2], strict=True))}


@pytest.fixture(scope="module")
def container(wheel, sections, tmp_path_factory) -> Container:
    """Return the environment that the definition's steps make of nothing, with the packages that pip would fetch.

    Those are the ones that mimoc's wheel asks for, and what they ask for: they come from here, each by itself, and
    none besides them, so that one mimoc imports and does not ask for is missed.
    """
    root = tmp_path_factory.mktemp("root")
    (root / "opt/wheels").mkdir(parents=True)
    (root / "opt/wheels" / wheel.name).write_bytes(wheel.read_bytes())
    steps = sections["post"][sections["post"].index("python3 -m venv") :].replace("/opt/", f"{root}/opt/")
    here = f"{Path(sys.executable).parent}:{os.defpath}"
    subprocess.run(["/bin/sh", "-ec", steps], env={"PATH": here, "HOME": str(root), **OFFLINE}, check=True, timeout=300)
    (packages,) = (root / "opt/mimoc/lib").glob("python3.*/site-packages")
    (extras,) = re.findall(r'"\$wheel\[(.+)\]"', steps)
    for package in needed(f"mimoc[{extras}]"):
        link(package, packages)
    return Container(root, sections)


def needed(requirement: str) -> Iterator[Distribution]:
    """Yield all that a requirement asks for, directly or not, but for what is wanted itself."""
    seen: set[str] = set()
    waiting = [Requirement(requirement)]
    while waiting:
        wanted = waiting.pop()
        if str(wanted) in seen:
            continue
        seen.add(str(wanted))
        found = distribution(wanted.name)
        if wanted.name != "mimoc":
            yield found
        asked = [Requirement(line) for line in found.requires or ()]
        extras = wanted.extras or {""}
        waiting += [
            each for each in asked if not each.marker or any(each.marker.evaluate({"extra": x}) for x in extras)
        ]


def link(package: Distribution, folder: Path) -> None:
    for top in {file.parts[0] for file in package.files or ()} - {"..", "__pycache__"}:
        if not (folder / top).exists():
            (folder / top).symlink_to(Path(str(package.locate_file(top))))


def test_it_starts_from_debian(sections):
    assert re.search(r"^Bootstrap: docker\nFrom: debian:\w+-slim$", sections["header"], re.MULTILINE)


def test_each_section_is_there_once(sections):
    assert set(sections) == {"header", "labels", "help", "files", *SCRIPTS}
    assert DEFINITION.read_text(encoding="utf-8").count("\n%") == len(sections) - 1


def test_it_brings_the_wheel_and_nothing_else(sections, wheel):
    ((source, target),) = map(str.split, sections["files"].split("\n\n")[0].strip().splitlines())
    assert target == "/opt/wheels/"
    assert Path("dist", wheel.name).match(source)


def test_it_installs_what_draws_without_a_screen(sections):
    (known,) = re.findall(r'^packages="(.+)"$', (CHECKOUT / ".ci" / "opengl").read_text(), re.MULTILINE)
    (installed,) = re.findall(r"apt-get install ([^\n]+\\\n)([^\n]+)", sections["post"])
    packages = {word for line in installed for word in line.split() if word[0] not in "-\\"}
    assert packages == {*known.split(), "ca-certificates", "python3", "python3-venv"}


@pytest.mark.parametrize("name", SCRIPTS)
def test_each_script_is_a_shell_script_without_here_documents(sections, name):
    """Apptainer keeps the indentation of a section, where a here-document would have no end."""
    subprocess.run(["/bin/sh", "-n", "-c", sections[name]], check=True)
    assert "<<" not in sections[name]


def test_the_help_names_what_to_do(sections):
    for said in ("apptainer build", "apptainer run", "apptainer test", "--nv", "APPTAINERENV_MUJOCO_GL"):
        assert said in sections["help"]


@FULL
def test_its_steps_leave_a_mimoc_that_lacks_nothing(container):
    done = container.run("python -m pip check", **OFFLINE)
    assert done.returncode == 0, done.stdout + done.stderr
    assert not (container.root / "opt/wheels").exists()


@FULL
def test_what_nothing_asks_for_is_not_there(container):
    for library in ("pytest", "hypothesis", "sphinx"):
        assert "No module named" in container.run(f"python -c 'import {library}'").stderr


@FULL
@pytest.mark.slow
def test_it_passes_its_own_test(container):
    """Builds, validates, runs with sight, records and replays, draws, learns; and leaves nothing behind."""
    before = set(container.root.iterdir())
    done = container.run(container.sections["test"])
    assert done.returncode == 0, done.stdout + done.stderr
    for said in ("try: mimoc run infant", "ok: within one SD", "20 control steps", "infant.png"):
        assert said in done.stdout
    left = {path.name for path in set(container.root.iterdir()) - before}
    assert {name for name in left if not name.startswith("torchinductor_")} <= {".cache", ".config"}


@FULL
def test_its_own_test_fails_as_soon_as_a_command_does(container):
    done = container.run(container.sections["test"].replace("mimoc build infant.yaml", "mimoc build nowhere.yaml"))
    assert (done.returncode, done.stdout) == (2, "")


@FULL
def test_running_it_is_running_mimo(container):
    done = container.run(container.sections["runscript"], "--version")
    assert (done.returncode, done.stdout) == (0, f"mimoc {mimoc.__version__}\n")


@FULL
def test_how_it_draws_can_be_chosen_from_outside(container):
    assert container.run("echo $MUJOCO_GL").stdout == "egl\n"
    assert container.run("echo $MUJOCO_GL", MUJOCO_GL="osmesa").stdout == "osmesa\n"


@FULL
def test_the_hosts_python_packages_stay_outside(container):
    done = container.run("python -c 'import sys; print(sys.path)'", PYTHONPATH="/somewhere")
    assert done.returncode == 0
    assert "/somewhere" not in done.stdout


def test_the_task_says_what_it_lacks_to_build_it():
    env = {"PATH": os.defpath, "APPTAINER": ""}
    task = ["bash", ".ci/task", "container"]
    done = subprocess.run(task, cwd=CHECKOUT, env=env, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert ".ci/task container needs Apptainer or Singularity; install one of them" in done.stdout
