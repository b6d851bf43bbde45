"""Folders full of links to files outside, of which none is opened, changed, made or removed; or full of pipes."""

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from shutil import rmtree
from types import ModuleType
from typing import Any

import pytest
from fuzz import cohorts, trainings
from fuzz.canaries import Canaries

from mimoc.cohorts.store import MARK
from mimoc.errors import MimocError
from mimoc.training.run_folder import RUN

FILE = b"of somebody else"


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


def replace_all(place: Path, depth: int, spared: str, put: Callable[[Path, bool], object]) -> int:
    """Replace each file and each folder that is so deep in a folder by something else; return how many there are."""
    number = 0
    for path in [path for path in place.rglob("*") if len(path.relative_to(place).parts) == depth]:
        if path.name != spared:
            is_folder = path.is_dir()
            rmtree(path) if is_folder else path.unlink()
            put(path, is_folder)
            number += 1
    return number


def use(kind: ModuleType, begun: Any, tmp_path: Path, depth: int, put: Callable[[Path, bool], object]) -> Iterator[str]:
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


@pytest.mark.parametrize("depth", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", [cohorts, trainings], ids=["a cohort", "a training"])
def test_nothing_is_read_or_written_through_a_link(kind, depth, prepared, outside, tmp_path):
    """Whatever is done with the folder, in turn, as each may put a file in the place of a link."""

    def link(path: Path, is_folder: bool) -> None:
        path.symlink_to(outside.folder if is_folder else outside.folder / "file")

    for _ in use(kind, prepared(kind), tmp_path, depth, link):
        assert untouched(outside)


@pytest.mark.parametrize("depth", [1, 2, 3])
@pytest.mark.parametrize("kind", [cohorts, trainings], ids=["a cohort", "a training"])
def test_no_pipe_is_waited_for(kind, depth, prepared, tmp_path):
    """Which nobody ever writes to: what waits for one is interrupted after a minute."""
    begun = prepared(kind)
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.alarm(60)
    try:
        errors = [*use(kind, begun, tmp_path, depth, lambda path, _: os.mkfifo(path))]
    except KeyboardInterrupt:
        pytest.fail("a pipe is waited for")
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
    assert all(error.isprintable() for error in errors)


def test_the_canaries_see_what_is_made_and_listed(outside):
    assert untouched(outside)
    os.listdir(outside.folder)
    assert not untouched(outside)
    (outside.folder / "file").write_bytes(b"")
    assert not untouched(outside)
