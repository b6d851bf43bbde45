"""Every block of README.md works as it is printed, one after the other, in a fresh copy of the checkout."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from shutil import copytree, ignore_patterns
from typing import Any

import numpy as np
import pytest
import yaml
from PIL import Image
from support.commands import Outcome

import mimoc

CHECKOUT = Path(__file__).resolve().parents[1]
README = CHECKOUT / "README.md"
PYTHON = shlex.quote(sys.executable)

INSTEAD = {
    # What is installed here is taken as it is: of pip it is only asked whether it could install.
    r"\bpip install ": f"{PYTHON} -m pip install --quiet --dry-run --no-deps --no-build-isolation --no-index ",
    r"\bmake demo\b": "make demo --assume-old=.venv/.demo ROOMS=0:2",
    r"\bmake test\b": "make test --assume-old=.venv/.test --dry-run",
    # An hour of learning.
    r"--steps 200000\b": "--steps 128 --checkpoint-every 128 --envs 2 --one-process "
    "--set n_steps=64 --set batch_size=64",
    # Many frames, and large ones.
    r"--steps 100 --video\b": "--steps 10 --size 64 --video",
    r"--size 200\b": "--size 40",
    r"\bsteps=100, eyes=True": "steps=10, eyes=True, height_px=64",
    # A window needs a screen.
    r"\bpython -m mujoco.viewer --mjcf=(\S+)": r"""python -c 'import mujoco; mujoco.MjModel.from_xml_path("\1")'""",
    # A container, which is the same commands.
    r"\bapptainer run (--nv )?\S+": "mimoc",
    r"\bapptainer exec \S+": "",
}
"""What stands in a block, as a pattern, and what is run instead: as little as can be."""

PROGRAMS = {"sh", "python"}
MISTAKEN = "mimoc: 1\nname: mine\nage_months: 99\nsenses: {}\nscene:\n  posse: sitting\n"
"""The spec `my_infant.yaml`, whose mistakes README shows."""


@dataclass(frozen=True)
class Block:
    """One block of README."""

    line: int
    language: str
    text: str


class Reader:
    """Does what README says, in a folder where README's first commands have not been run yet."""

    def __init__(self, folder: Path, invoke: Callable[..., Outcome]):
        self.folder, self._invoke = folder, invoke
        self.said = ""
        """All that was printed so far."""
        self._session: dict[str, Any] = {}
        self._spec: dict[str, Any] = {}

    def follow(self, block: Block) -> None:
        """Do what a block says."""
        text = block.text
        for pattern, instead in INSTEAD.items() if block.language in PROGRAMS else ():
            text = re.sub(pattern, instead, text)
        getattr(self, f"_{block.language}")(text)

    def _sh(self, text: str) -> None:
        """Run each line: mimoc's own commands in this process, which takes half the time, and all else in bash."""
        for line in text.splitlines():
            program, *arguments = shlex.split(line, comments=True)
            if program == "mimoc":
                done = self._invoke(*arguments)
                assert done.code == 0, done.err
                self.said += done.out
            else:
                self._bash(line)

    def _bash(self, text: str) -> None:
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        clean = {name: value for name, value in os.environ.items() if name not in {"MAKEFLAGS", "MAKELEVEL"}}
        done = subprocess.run(
            ["bash", "-exo", "pipefail", "-c", text],
            cwd=self.folder,
            env=clean | {"PATH": path},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout
        self.said += done.stdout

    def _python(self, text: str) -> None:
        """Run a program that goes on from those before, as in one session."""
        with redirect_stdout(StringIO()) as printed:
            exec(compile(text, "README.md", "exec"), self._session)
        self.said += printed.getvalue()

    def _yaml(self, text: str) -> None:
        """Build the spec, or the first one with these keys, and open what was built."""
        keys = yaml.safe_load(text)
        if "cohort" in keys:
            (self.folder / "cohort.yaml").write_text(text)
            assert len(mimoc.read_cohort("cohort.yaml").jobs()) == 100 * 7 * 2 * 5
            return
        self._spec = self._spec or keys
        (self.folder / "fragment.yaml").write_text(yaml.safe_dump(self._spec | keys))
        env = mimoc.make("fragment.yaml")
        env.reset(seed=0)
        env.close()

    def _text(self, text: str) -> None:
        """Look for each line among what was printed."""
        for line in text.splitlines():
            assert line in self.said


def blocks() -> Iterator[Block]:
    """Yield all of them, from the top."""
    text = README.read_text(encoding="utf-8")
    for found in re.finditer(r"^```(\w*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        yield Block(text.count("\n", 0, found.start()) + 2, *found.groups())


@pytest.fixture
def reader(tmp_path, monkeypatch, invoke) -> Reader:
    """Return someone in a fresh copy of the checkout, with what README takes for theirs."""
    built = [line.strip("/") for line in (CHECKOUT / ".gitignore").read_text().split()]
    folder = tmp_path / "mimoc"
    copytree(CHECKOUT, folder, ignore=ignore_patterns(*built, ".git"))
    (folder / ".venv").symlink_to(sys.prefix)
    (folder / "my_infant.yaml").write_text(MISTAKEN)
    (folder / "infant.yaml").write_text((folder / "configs" / "newborn.yaml").read_text())
    (folder / "my_program.py").write_text("import mimoc")
    (folder / "my_floors").mkdir()
    Image.fromarray(np.full((8, 8, 3), 200, np.uint8)).save(folder / "my_floors" / "wood.png")
    monkeypatch.chdir(folder)
    monkeypatch.setenv("COLUMNS", "200")
    found = Reader(folder, invoke)
    found.said = invoke("build", "my_infant.yaml", "-o", "out/mine").err
    return found


@pytest.mark.slow
def test_every_block_works_as_it_is_printed_one_after_the_other(reader):
    followed = []
    for block in blocks():
        try:
            reader.follow(block)
        except Exception as error:
            pytest.fail(f"README.md:{block.line}: {block.language}: {type(error).__name__}: {error}\n{block.text}")
        followed.append(block.language)
    assert {"sh", "python", "yaml", "text"} <= set(followed)


@pytest.mark.parametrize("pattern", INSTEAD)
def test_what_is_run_instead_of_something_is_run_instead_of_something(pattern):
    assert any(re.search(pattern, block.text) for block in blocks() if block.language in PROGRAMS)
