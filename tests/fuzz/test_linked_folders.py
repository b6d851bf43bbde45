"""Folders full of links, of which each leads to files outside: nothing there is opened, changed, made or removed."""

import os
from contextlib import suppress
from pathlib import Path
from shutil import rmtree

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


def link_all(place: Path, depth: int, outside: Path, spared: str) -> int:
    """Replace all that is so deep in a folder by links, each file and each folder; return how many there are."""
    number = 0
    for path in [path for path in place.rglob("*") if len(path.relative_to(place).parts) == depth]:
        if path.name != spared:
            is_folder = path.is_dir()
            rmtree(path) if is_folder else path.unlink()
            path.symlink_to(outside if is_folder else outside / "file")
            number += 1
    return number


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
    begun = prepared(kind)
    folder = kind.copied(begun, tmp_path)
    if kind is cohorts:
        ways, linked = cohorts.ways(folder), link_all(folder / "out", depth, outside.folder, spared=MARK)
    else:
        ways, linked = trainings.ways(begun, folder), link_all(folder, depth, outside.folder, spared=RUN)
    assert linked or depth > 2
    for way in ways:
        with suppress(MimocError):
            kind.use([way])
        assert untouched(outside)


def test_the_canaries_see_what_is_made_and_listed(outside):
    assert untouched(outside)
    os.listdir(outside.folder)
    assert not untouched(outside)
    (outside.folder / "file").write_bytes(b"")
    assert not untouched(outside)
