"""Folders full of links to files outside, of which none is opened, changed, made or removed; or full of pipes."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from shutil import rmtree
from types import ModuleType
from typing import Any

import pytest
from fuzz import cohorts, trainings
from fuzz.canaries import Canaries
from support.full import full_but

from mimoc.base.errors import MimocError
from mimoc.studies.cohorts.store import MARK
from mimoc.training.run_folder import RUN

FILE = b"of somebody else"
Put = Callable[[Path, bool], object]
"""Puts something in place of a file, or of a folder."""


@pytest.fixture
def outside(tmp_path):
    """A folder of files that nobody may touch, one of which has the name of a log."""
    canaries = Canaries(tmp_path / "outside", {"file": FILE, ".mimoc-left.tmp": FILE})
    yield canaries
    canaries.close()


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    """Return what the tries of a fuzzer begin with."""
    made = {kind: kind.prepare(tmp_path_factory.mktemp(kind.__name__)) for kind in (cohorts, trainings)}
    return made.__getitem__


def replace_all(place: Path, depth: int, spared: str, put: Put) -> int:
    """Replace each file and each folder that is so deep in a folder by something else; return how many there are."""
    paths = [path for path in place.rglob("*") if len(path.relative_to(place).parts) == depth and path.name != spared]
    for path in paths:
        replace(path, put)
    return len(paths)


def replace(path: Path, put: Put) -> None:
    is_folder = path.is_dir()
    rmtree(path) if is_folder else path.unlink()
    put(path, is_folder)


def use(kind: ModuleType, begun: Any, tmp_path: Path, depth: int, put: Put) -> Iterator[str]:
    """Do all that can be done with a folder in which much is something else, in turn; yield what is refused."""
    folder = kind.copied(begun, tmp_path)
    if kind is cohorts:
        ways, number = cohorts.ways(folder), replace_all(folder / "out", depth, MARK, put)
    else:
        ways, number = trainings.ways(begun, folder), replace_all(folder, depth, RUN, put)
    assert number or depth > 2
    for way in ways:
        error = ""
        try:
            kind.use([way])
        except MimocError as raised:
            error = str(raised)
        yield error


def untouched(outside: Canaries) -> bool:
    """Return whether nothing outside was opened, and all is as it was."""
    opened = outside.opened()
    contents = {path.name: path.read_bytes() for path in outside.folder.iterdir()}
    outside.opened()  # That was this look.
    return not opened and contents == {"file": FILE, ".mimoc-left.tmp": FILE}


@pytest.mark.parametrize("depth", full_but([1, 4], [2, 3]))
@pytest.mark.parametrize("kind", [cohorts, trainings], ids=["a cohort", "a training"])
def test_nothing_is_read_or_written_through_a_link(kind, depth, prepared, outside, tmp_path):
    """Whatever is done with the folder, in turn, as each may put a file in the place of a link."""

    def link(path: Path, is_folder: bool) -> None:
        path.symlink_to(outside.folder if is_folder else outside.folder / "file")

    for _ in use(kind, prepared(kind), tmp_path, depth, link):
        assert untouched(outside)


@pytest.fixture
def patience():
    """Interrupt what waits for a pipe, to which nobody ever writes, after a minute."""
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.alarm(60)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def pipe(path: Path, _: bool) -> None:
    os.mkfifo(path)


@pytest.mark.parametrize("depth", full_but([1], [2, 3]))
@pytest.mark.parametrize("kind", [cohorts, trainings], ids=["a cohort", "a training"])
def test_no_pipe_of_many_is_waited_for(kind, depth, prepared, tmp_path, patience):
    assert all(error.isprintable() for error in use(kind, prepared(kind), tmp_path, depth, pipe))


@pytest.mark.parametrize("name", full_but(["bundle", "policy.zip"], ["checkpoints", "state.zip", "curve.csv"]))
def test_no_pipe_in_a_training_is_waited_for(name, prepared, tmp_path, patience):
    """The rest is as it was, so that training goes as far as it can."""
    run = trainings.copied(prepared(trainings), tmp_path)
    replace(run / name, pipe)
    for way in trainings.ways(prepared(trainings), run):
        with suppress(MimocError):
            trainings.use([way])


def test_the_canaries_see_what_is_made_and_listed(outside):
    assert untouched(outside)
    os.listdir(outside.folder)
    assert not untouched(outside)
    (outside.folder / "file").write_bytes(b"")
    assert not untouched(outside)
