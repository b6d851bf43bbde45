"""Every block of README and of the guides works as it is printed, one page at a time, in a copy of the checkout."""

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
from shutil import copytree, ignore_patterns, rmtree
from typing import Any

import numpy as np
import pytest
import yaml
from PIL import Image
from support.commands import Outcome
from support.full import FULL

import mimoc
from mimoc.schema.base import recompose
from mimoc.schema.plugins import GROUPS

CHECKOUT = Path(__file__).resolve().parents[1]
GUIDES = (
    "tutorial for_researchers for_rl movement_data individuals muscles senses maturing_senses touch "
    "vision hearing delays lab_room own_toys objects caregiver tasks behaviours two_infants pictures "
    "inverse_dynamics training benchmark container own_reward own_measure reflexes plain_mujoco growth "
    "from_mimo filming movement_measures replay"
)
PAGES = ("README.md", *(f"docs/{name}.md" for name in GUIDES.split()))  # test_docs.py runs the other pages.
MARKS = {  # What takes long, and what only `make test-all` runs.
    **dict.fromkeys(("README.md", "docs/tutorial.md", "docs/two_infants.md", "docs/objects.md"), pytest.mark.slow),
    **dict.fromkeys(("docs/pictures.md", "docs/growth.md"), FULL),
}
PYTHON = shlex.quote(sys.executable)
DEMO = "make demo --assume-old=.venv/.demo ROOMS=0:2"

INSTEAD = {  # What stands in a block, as a pattern, and what is run instead: as little as can be.
    # What is installed here is taken as it is: of pip it is only asked whether it could install.
    r"\bpip install ": f"{PYTHON} -m pip install --quiet --dry-run --no-deps --no-build-isolation --no-index ",
    r"\bmake demo\b": f"{DEMO} --dry-run",
    r"\bmake test\b": "make test --assume-old=.venv/.test --dry-run",
    # An hour of learning.
    r"--steps 200000\b": "--steps 128 --checkpoint-every 128 --envs 2 --one-process "
    "--set n_steps=64 --set batch_size=64",
    # Many frames, and large ones.
    r"--steps 100 --video\b": "--steps 10 --size 64 --video",
    r"--steps 500 --record\b": "--steps 20 --record",
    r"--video out/pair.gif": "--size 64 --video out/pair.gif",
    r"--size 200\b": "--size 40",
    r"--seeds 0:12\b": "--seeds 0:3",
    r"\bsteps=100, eyes=True": "steps=10, eyes=True, height_px=64",
    # A window needs a screen.
    r"\bpython -m mujoco.viewer --mjcf=(\S+)": r"""python -c 'import mujoco; mujoco.MjModel.from_xml_path("\1")'""",
    # A container, which is the same commands.
    r"\bapptainer run (--nv )?\S+": "mimoc",
    r"\bapptainer exec \S+": "",
}

PROGRAMS = {"sh", "python"}
MISTAKEN = "mimoc: 1\nname: mine\nage_months: 99\nsenses: {}\nscene:\n  posse: sitting\n"
"""The spec `my_infant.yaml`, whose mistakes README shows."""


@dataclass(frozen=True)
class Block:
    line: int
    language: str
    text: str


class Reader:
    """Does what a page says, in a folder where nothing has been built yet."""

    def __init__(self, folder: Path, invoke: Callable[..., Outcome]):
        self.folder, self._invoke = folder, invoke
        self.said = ""
        """All that was printed so far."""
        self._session: dict[str, Any] = {"__name__": "page"}  # Sections of a spec have a module.
        self._spec: dict[str, Any] = {}
        """The page's first spec, of which those after it have some keys."""

    def follow(self, block: Block) -> None:
        text = block.text
        for pattern, instead in INSTEAD.items() if block.language in PROGRAMS else ():
            text = re.sub(pattern, instead, text)
        getattr(self, f"_{block.language}")(text)

    def _sh(self, text: str) -> None:
        """Run each line: mimoc's own commands in this process, which takes half the time, and all else in bash."""
        for line in text.replace("\\\n", " ").splitlines():
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
        with redirect_stdout(StringIO()) as printed:
            exec(compile(text, "page", "exec"), self._session)
        self.said += printed.getvalue()

    def _yaml(self, text: str) -> None:
        """Build the spec, or the first one with these keys, and open what was built; keep it if it says its name."""
        keys = yaml.safe_load(text)
        if "infants" in keys:  # A world, which is one of those in configs.
            assert keys == yaml.safe_load((self.folder / "configs" / "worlds" / f"{keys['name']}.yaml").read_text())
            return
        self._spec = self._spec or keys
        (self.folder / "fragment.yaml").write_text(yaml.safe_dump(self._spec | keys))
        if "name" in keys:
            (self.folder / f"{keys['name']}.yaml").write_text(text)
        env = mimoc.make("fragment.yaml")
        env.reset(seed=0)
        env.close()

    def _text(self, text: str) -> None:
        for line in text.splitlines():
            assert line in self.said


def blocks(page: str) -> Iterator[Block]:
    text = (CHECKOUT / page).read_text(encoding="utf-8")
    for found in re.finditer(r"^```(\w*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        yield Block(text.count("\n", 0, found.start()) + 2, *found.groups())


@pytest.fixture(scope="module")
def checkout(tmp_path_factory) -> Path:
    """Return a fresh copy of the checkout, with what its pages take for their reader's."""
    built = [line.strip("/") for line in (CHECKOUT / ".gitignore").read_text().split()]
    folder = tmp_path_factory.mktemp("pages") / "mimoc"
    copytree(CHECKOUT, folder, ignore=ignore_patterns(*(Path(each).name for each in built), ".git"))
    (folder / ".venv").symlink_to(sys.prefix)
    (folder / "my_infant.yaml").write_text(MISTAKEN)
    (folder / "infant.yaml").write_text((folder / "configs" / "newborn.yaml").read_text())
    (folder / "my_program.py").write_text("import mimoc")
    (folder / "my_floors").mkdir()
    Image.fromarray(np.full((8, 8, 3), 200, np.uint8)).save(folder / "my_floors" / "wood.png")
    return folder


@pytest.fixture
def reader(checkout, monkeypatch, invoke) -> Iterator[Reader]:
    """Return someone in that copy, in which nothing has been built; what a page builds is not there for the next."""
    monkeypatch.chdir(checkout)
    monkeypatch.setenv("COLUMNS", "200")
    found = Reader(checkout, invoke)
    found.said = invoke("build", "my_infant.yaml", "-o", "out/mine").err
    yield found
    for table in GROUPS.values():
        for name in [name for name in table if not table.distribution(name)]:
            table.remove(name)
    recompose()
    rmtree(checkout / "out", ignore_errors=True)


@pytest.mark.full
@pytest.mark.parametrize("page", [pytest.param(page, marks=MARKS.get(page, ())) for page in PAGES])
def test_every_block_works_as_it_is_printed_one_after_the_other(reader, page):
    followed = []
    for block in blocks(page):
        try:
            reader.follow(block)
        except Exception as error:
            pytest.fail(f"{page}:{block.line}: {block.language}: {type(error).__name__}: {error}\n{block.text}")
        followed.append(block.language)
    assert followed


@FULL
@pytest.mark.slow
def test_make_demo_works(reader):
    reader._bash(DEMO)
    assert (reader.folder / "out/demo/nine_months/scene.xml").is_file()


@pytest.mark.parametrize("pattern", INSTEAD)
def test_what_is_run_instead_of_something_is_run_instead_of_something(pattern):
    here = (block for page in PAGES for block in blocks(page))
    assert any(re.search(pattern, block.text) for block in here if block.language in PROGRAMS)
