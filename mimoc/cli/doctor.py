"""`mimoc doctor`."""

import os
import platform
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from importlib.metadata import PackageNotFoundError, requires, version
from importlib.util import find_spec
from typing import NamedTuple

import typer

from mimoc.base.errors import problem_of_loading_mujoco
from mimoc.cli.terminal import FAILED_CHECK

EXTRAS: Mapping[str, str] = {
    "report": "plots and pages",
    "record": "videos, recordings, Parquet",
    "minari": "export to Minari",
    "train": "training",
    "toys": "Toys4K",
    "gpu": "many infants on a GPU",
    "slurm": "cohorts on SLURM",
    "ray": "cohorts on Ray",
    "live": "a running infant in a browser",
    "multi": "several infants in one world",
}
"""What each optional part of the installation is for."""
ESSENTIAL = "MuJoCo"  # What nothing works without.
PATIENCE_S = 10.0  # How long to wait for a program of the system.


class AbsentError(Exception):
    """Something is not here, which may be as it should be."""


class Finding(NamedTuple):
    """What was found out about one thing."""

    what: str
    state: str  # `ok`, `none` if it is not here, or `broken`.
    text: str


def doctor() -> None:
    """Say what works on this machine, and what to install for the rest; the exit code is 1 if no infant can move."""
    from rich.text import Text

    from mimoc.cli import console

    looks, findings = [*_looks()], list[Finding]()
    with console.progress("looking at this machine") as show:
        for what, look in looks:
            show(len(findings), len(looks))
            findings.append(_tried(what, look))
    styles = {"ok": "green", "none": "dim", "broken": "red"}
    width = max(len(finding.what) for finding in findings)
    for what, state, text in findings:
        line = Text.assemble((f"{state:6}", styles[state]), f" {what:{width}}  {text}")
        console.open_console().print(line, soft_wrap=True)
    if any(finding.what == ESSENTIAL and finding.state != "ok" for finding in findings):
        raise typer.Exit(FAILED_CHECK)


def _looks() -> Iterator[tuple[str, Callable[[], str]]]:
    yield "mimoc", lambda: version("mimoc")
    yield "machine", _machine
    yield ESSENTIAL, _build
    yield "OpenGL", lambda: import_module("mimoc.render.opengl").opengl_driver()
    for extra in EXTRAS:
        yield f"mimoc[{extra}]", lambda extra=extra: _extra(extra)
    yield "torch", _torch
    query = "--query-gpu=name,driver_version,memory.total"
    yield "NVIDIA GPU", lambda: _told("nvidia-smi", query, "--format=csv,noheader")
    yield "SLURM", lambda: f"partitions {_told('sinfo', '--noheader', '--format=%P')}"
    yield "Ray cluster", lambda: _told("ray", "status").partition("\n")[0]


def _tried(what: str, look: Callable[[], str]) -> Finding:
    try:
        return Finding(what, "ok", look())
    except AbsentError as absence:
        return Finding(what, "none", str(absence))
    except Exception as error:  # Whatever is wrong is what is looked for.
        text = problem_of_loading_mujoco(error) or str(error)
        return Finding(what, "broken", " ".join(text.split()) or type(error).__name__)


def _machine() -> str:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return f"Python {platform.python_version()}, {platform.platform(terse=True)}, {platform.machine()}, {cores} cores"


def _build() -> str:
    import mimoc

    with mimoc.make(mimoc.InfantSpec(mimoc=1, name="doctor", age_months=9)) as env:
        env.reset(seed=0)
        env.step(env.action_space.sample())
    return f"{version('mujoco')}; infants compile and move"


def _extra(extra: str) -> str:
    wanted = re.compile(rf"([\w.-]+).*extra == ['\"]{extra}['\"]")
    names = [match[1] for requirement in requires("mimoc") or () if (match := wanted.match(requirement))]
    try:
        packages = [f"{name} {version(name)}" for name in names]
    except PackageNotFoundError:
        packages = []
    if not packages:
        raise AbsentError(f"for {EXTRAS[extra]}: pip install 'mimoc[{extra}]'")
    return f"{EXTRAS[extra]} ({', '.join(packages)})"


def _torch() -> str:
    if find_spec("torch") is None:
        raise AbsentError("comes with mimoc[train]")
    from mimoc.training import torch_devices

    return f"{version('torch')}, {torch_devices()}"


def _told(*command: str) -> str:
    if not shutil.which(command[0]):
        raise AbsentError(f"no command '{command[0]}'")
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE_S)
    if done.returncode:
        raise OSError(done.stderr.strip() or f"'{command[0]}' ends with code {done.returncode}")
    return ", ".join(done.stdout.split("\n")).strip(", ")
