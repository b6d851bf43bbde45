"""Files are written whole or not at all, and two folders change places at once or by taking turns."""

import errno
import os
import stat
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from support.bundles import ONE, TWO

from mimoc.base.errors import OutputError
from mimoc.bundle import files
from mimoc.bundle.files import staged_folder, swap_folders, write_file
from mimoc.bundle.io import read_bundle, write_bundle


def test_a_file_is_written_or_replaced_and_its_path_returned(tmp_path):
    for content in (b"an old and longer text", b"new"):
        assert write_file(tmp_path / "a.png", content) == tmp_path / "a.png"
        assert (tmp_path / "a.png").read_bytes() == content
    assert os.listdir(tmp_path) == ["a.png"]


def test_a_new_file_has_the_permissions_that_new_files_get(tmp_path):
    (tmp_path / "usual").touch()
    write_file(tmp_path / "a", b"")
    modes = [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("usual", "a")]
    assert modes[0] == modes[1]


def test_a_tilde_is_the_home(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    assert write_file("~/a", b"new") == tmp_path / "a"


@pytest.mark.parametrize("place", ["missing/a", "folder", "file/a", "n" * 300])
def test_a_failed_write_raises_an_error_and_leaves_nothing(place, tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot be written") as refusal:
        write_file(tmp_path / place, b"new")
    assert str(tmp_path / place) in str(refusal.value)
    assert sorted(os.listdir(tmp_path)) == ["file", "folder"]


def test_readers_see_the_old_content_or_the_new(tmp_path):
    contents = [b"a" * 1_000_000, b"b" * 1_000_000]
    path, seen, done = tmp_path / "a", set(), threading.Event()
    write_file(path, contents[0])

    def read() -> None:
        while not done.is_set():
            seen.add(path.read_bytes())

    reader = threading.Thread(target=read)
    reader.start()
    for turn in range(50):
        write_file(path, contents[turn % 2])
    done.set()
    reader.join()
    assert seen <= set(contents)


@pytest.mark.parametrize("force", [False, True])
def test_a_staged_folder_takes_the_place_of_a_full_one_only_if_that_is_asked_for(force, tmp_path):
    target = tmp_path / "out"
    with suppress(OutputError), staged_folder(target, force=force) as staging:
        (staging / "new").touch()
        target.mkdir()  # Meanwhile.
        (target / "old").touch()
    assert [path.name for path in target.iterdir()] == ["new" if force else "old"]
    assert list(tmp_path.iterdir()) == [target]


@pytest.fixture
def folders(tmp_path) -> tuple[Path, Path]:
    first, second = tmp_path / "first", tmp_path / "second"
    for folder in (first, second):
        folder.mkdir()
        (folder / "name").write_text(folder.name)
    return first, second


def names(*folders: Path) -> list[str]:
    return [(folder / "name").read_text() for folder in folders]


def refuse(number: int) -> Callable[..., None]:
    def function(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    return function


@pytest.mark.parametrize("number", [None, errno.ENOSYS, errno.EINVAL, errno.ENOTSUP])
def test_two_folders_are_swapped_also_if_the_system_has_no_atomic_swap(folders, monkeypatch, number):
    if number is not None:
        monkeypatch.setattr(files, "_swap_at_once", refuse(number))
    swap_folders(*folders)
    assert names(*folders) == ["second", "first"]
    assert len(os.listdir(folders[0].parent)) == 2


def test_two_folders_are_swapped_on_an_unknown_system(folders, monkeypatch):
    monkeypatch.setattr(sys, "platform", "plan9")
    swap_folders(*folders)
    assert names(*folders) == ["second", "first"]


def test_a_failed_swap_without_atomic_swap_restores_both_folders(folders, monkeypatch):
    monkeypatch.setattr(files, "_swap_at_once", refuse(errno.EINVAL))
    rename = os.rename
    monkeypatch.setattr(os, "rename", lambda a, b: refuse(errno.EIO)() if a == folders[0] else rename(a, b))
    with pytest.raises(OSError, match=os.strerror(errno.EIO)):
        swap_folders(*folders)
    assert names(*folders) == ["first", "second"]


def test_other_failures_of_a_swap_are_raised(folders, monkeypatch):
    with pytest.raises(FileNotFoundError):
        swap_folders(folders[0], folders[1] / "nothing")
    monkeypatch.setattr(files, "_swap_at_once", refuse(errno.EACCES))
    with pytest.raises(PermissionError):
        swap_folders(*folders)
    assert names(*folders) == ["first", "second"]


def test_a_bundle_is_replaced_without_atomic_swap_too(out, monkeypatch):
    write_bundle(ONE, out)
    monkeypatch.setattr(files, "_swap_at_once", refuse(errno.EINVAL))
    write_bundle(TWO, out, force=True)
    assert read_bundle(out).files == TWO.files
    assert os.listdir(out.parent) == [out.name]
