"""Try mimoc with several MuJoCos and Pythons, and print a table of what came of it: `make matrix`.

Each pair has an environment of its own under .matrix, where the tests that are marked `matrix` run. A MuJoCo that is
too old for mimoc only opens its bundles, without mimoc. One more environment has the oldest versions that mimoc and its
light extras admit, and runs all quick tests of reading, building and the command line. Every environment builds every
config, on the newest MuJoCo also with several kernels of OpenBLAS and locales: the bytes must be the same everywhere.
Logs are beside the environments. The exit code is 0 if all pass; a pair whose Python is not here is not run, and does
not pass.

    PYTHONS="3.11 /opt/python3.13/bin/python3"   versions to look for on the PATH, or paths
    MUJOCOS="3.5 3.17.0"                         versions; of a minor one the latest patch
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLACE = ROOT / ".matrix"
BUNDLES = PLACE / "bundles"
PYTHONS = os.environ.get("PYTHONS", "3.11 3.12 3.13").split()
MUJOCOS = os.environ.get("MUJOCOS", "3.5 3.8 3.11 3.14 3.17").split()
LIGHT_EXTRAS = ("report", "toys", "record", "minari", "slurm", "live")
"""Extras that are small enough to be tried in their oldest versions."""
QUICK_TESTS = ("tests/fits", "tests/schema", "tests/test_errors.py", "tests/cli", "tests/test_same_bytes.py")
WITHOUT_TRAINING = ("--ignore", "tests/cli/test_help.py", "-k", "not train", "-m", "not slow")
"""What needs PyTorch is left out."""
MACHINES = (
    *({"OPENBLAS_CORETYPE": core} for core in ("Prescott", "Sandybridge", "Haswell", "SkylakeX", "Zen")),
    *({"LC_ALL": name} for name in ("C", "tr_TR.UTF-8", "de_DE.UTF-8")),
    {"NPY_DISABLE_CPU_FEATURES": "X86_V4 X86_V3", "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"},
)
"""Variables that make this machine compute or write as another one; a locale has to be installed to have an effect."""
OPENING = "3.3.0"
"""The MuJoCo of MIMo and BabyBench, which is too old for mimoc."""
OPEN = """
import mujoco, pathlib, sys
for path in sorted(pathlib.Path(sys.argv[1]).glob("*/*.xml")):
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        sys.exit(f"{path.parent.name}/{path.name}: {error}")
    mujoco.mj_step(model, mujoco.MjData(model), nstep=10)
"""


DIGESTS: dict[str, str] = {}
"""Who was first to have each digest of all bundles; there must be only one."""


class TrialError(Exception):
    """Something that was tried did not work; the text says what."""


@dataclass(frozen=True)
class Environment:
    """A Python with some packages, in a folder of its own."""

    python: str
    """The program it is made with."""
    name: str
    wanted: tuple[str, ...]
    """What pip is told to install."""
    first: tuple[tuple[str, ...], ...] = ()
    """What this Python is run with before that; it may fail."""

    @property
    def folder(self) -> Path:
        """Where it is."""
        return PLACE / self.name

    def set_up(self) -> None:
        """Make it anew, unless it is there already."""
        ready, digest = self.folder / "ready", self._digest()
        if ready.is_file() and ready.read_text() == digest:
            return
        shutil.rmtree(self.folder, ignore_errors=True)
        self.log.write_text("")
        self._tell([self.python, "-m", "venv", str(self.folder)], {})
        for arguments in self.first:
            with suppress(TrialError):
                self.run(*arguments)
        self.run("-m", "pip", "install", *self.wanted)
        ready.write_text(digest)

    def run(self, *arguments: str, machine: Mapping[str, str] | None = None) -> str:
        """Run this Python, with some variables for another *machine*, and return the last line that it prints."""
        return self._tell([str(self.folder / "bin" / "python"), *arguments], machine or {})

    @property
    def log(self) -> Path:
        """The file with all that was run for it, and what that said."""
        return PLACE / f"{self.name}.log"

    def _tell(self, command: list[str], machine: Mapping[str, str]) -> str:
        variables, output = {**os.environ, **machine}, {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        done = subprocess.run(command, cwd=ROOT, env=variables, **output, text=True, check=False)
        words = [*(f"{name}='{value}'" for name, value in machine.items()), *command]
        with self.log.open("a") as log:
            log.write(f"$ {' '.join(words)}\n{done.stdout}\n")
        last = (done.stdout.strip().splitlines() or [""])[-1]
        if done.returncode:
            raise TrialError(last)
        return last

    def _digest(self) -> str:
        known = (self.python, *self.wanted, (ROOT / "pyproject.toml").read_text())
        return hashlib.sha256("\n".join(known).encode()).hexdigest()


def main() -> None:
    """Try every pair and print the table."""
    PLACE.mkdir(exist_ok=True)
    shutil.rmtree(BUNDLES, ignore_errors=True)
    table = {name: dict(row(name)) for name in PYTHONS}
    print()
    show(table)
    sys.exit(any(cell != "passed" for cells in table.values() for cell in cells.values()))


def row(name: str) -> Iterator[tuple[str, str]]:
    """Yield what comes of each MuJoCo with a Python: the newest first, which builds the bundles for the oldest."""
    python = shutil.which(name if os.sep in name else f"python{name}")
    for mujoco in reversed(MUJOCOS):
        needs = (f"mujoco=={_release(mujoco)}", "--editable", ".[test]")
        yield mujoco, cell(python, name, mujoco, needs, _test if mujoco != MUJOCOS[-1] else _test_as_other_machines)
    yield "oldest", cell(python, name, "oldest", (*oldest_versions(), "--editable", ".[test]"), _test_oldest)
    yield f"{OPENING}, opens", cell(python, name, OPENING, (f"mujoco=={OPENING}",), _open)
    if python is None:
        print(f"Python {name}: not run: there is none here")


def cell(
    python: str | None, name: str, mujoco: str, needs: tuple[str, ...], attempt: Callable[[Environment], str]
) -> str:
    """Return what comes of one pair."""
    if python is None:
        return "not run"
    environment = Environment(python, f"{name.strip(os.sep).replace(os.sep, '-')}-mujoco-{mujoco}", needs)
    try:
        environment.set_up()
        said, found = attempt(environment), "passed"
    except TrialError as failure:
        said, found = f"{failure} ({environment.log.relative_to(ROOT)})", "FAILED"
    print(f"Python {name}, MuJoCo {mujoco}: {found}: {said}", flush=True)
    return found


def oldest_versions() -> tuple[str, ...]:
    """Return the requirements of mimoc and its light extras, each pinned to the oldest version that it admits."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    needs = [*project["dependencies"], *(need for extra in LIGHT_EXTRAS for need in extras[extra])]
    return tuple(re.sub(r">=([\d.]+)[^;]*", r"==\1", need) for need in needs)


def show(table: dict[str, dict[str, str]]) -> None:
    """Print the table: a row for each Python."""
    columns = list(next(iter(table.values())))[::-1]
    width = max(len(name) for name in PYTHONS)
    print(" | ".join([" " * (width + 7), *(f"MuJoCo {column}" for column in columns)]))
    for name, cells in table.items():
        print(" | ".join([f"Python {name:{width}}", *(f"{cells[column]:{len(column) + 7}}" for column in columns)]))


def _release(version: str) -> str:
    return version if version.count(".") == 2 else f"{version}.*"


def _test(environment: Environment) -> str:
    """Run the tests that are marked, and build all infants for `_open` where nobody has yet."""
    marked = [str(path) for path in sorted(ROOT.glob("tests/**/test_*.py")) if "mark.matrix" in path.read_text()]
    said = environment.run("-m", "pytest", "-m", "matrix and (full or not full)", *marked)
    if not BUNDLES.exists():
        for spec in sorted((ROOT / "configs").glob("*.yaml")):
            environment.run("-m", "mimoc", "build", str(spec), "-o", str(BUNDLES / spec.stem))
    _check_bytes(environment, {})
    return said


def _test_as_other_machines(environment: Environment) -> str:
    """Do what `_test` does, and build everything as other machines do."""
    said = _test(environment)
    for machine in MACHINES:
        _check_bytes(environment, machine)
    return f"{said}; the same bytes on {len(MACHINES)} other machines"


def _test_oldest(environment: Environment) -> str:
    """Run the quick tests of reading, building and the command line."""
    said = environment.run("-m", "pytest", *QUICK_TESTS, *WITHOUT_TRAINING)
    _check_bytes(environment, {})
    return said


def _check_bytes(environment: Environment, machine: Mapping[str, str]) -> None:
    """Build everything and compare the digest with that of whoever was first."""
    digest = environment.run("-W", "ignore", ".ci/bytes.py", machine=machine)
    DIGESTS.setdefault(digest, f"{environment.name} {dict(machine)}")
    if len(DIGESTS) > 1:
        raise TrialError(f"bundles have other bytes: {DIGESTS}")


def _open(environment: Environment) -> str:
    if not BUNDLES.exists():
        raise TrialError("there are no bundles to open")
    environment.run("-c", OPEN, str(BUNDLES))
    return f"{len(list(BUNDLES.iterdir()))} bundles opened"


if __name__ == "__main__":
    main()
