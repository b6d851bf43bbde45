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
from mimoc.bundle.files import make_folder, open_new_file, staged_folder, swap_folders, write_file
from mimoc.bundle.io import read_bundle, write_bundle
from mimoc.bundle.regular_files import (
    UnusableFileError,
    open_regular_file,
    read_json_file,
    read_regular_file,
    regular_files,
)
from mimoc.schema.base import Model


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


class Sample(Model):
    """A file."""

    rows: int
    name: str = ""
    share: float = 0.0


@pytest.fixture
def folder(tmp_path):
    """A folder with a file in it, a linked file and a linked folder, beside a folder outside of it."""
    for name in ("folder/inner", "outside"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "folder" / "inner" / "file").write_bytes(b"inside")
    (tmp_path / "outside" / "file").write_bytes(b"outside")
    (tmp_path / "folder" / "linked").symlink_to("../outside/file")
    (tmp_path / "folder" / "elsewhere").symlink_to("../outside")
    return tmp_path / "folder"


def test_a_file_is_read_and_its_folder_listed(folder):
    assert read_regular_file(folder / "inner" / "file", below=folder) == b"inside"
    opened = open_regular_file(folder / "inner" / "file", 6, below=folder)
    assert opened is not None
    with opened:
        assert opened.read() == b"inside"
    with regular_files(folder) as files:
        assert files.names() == ["elsewhere", "inner", "linked"]
        assert files.names("inner") == ["file"]
        assert files.names("nowhere") == []


@pytest.mark.parametrize("name", ["linked", "elsewhere/file"])
def test_nothing_is_read_through_a_link(folder, name):
    for read in (read_regular_file, open_regular_file):
        with pytest.raises(UnusableFileError, match="is a link"):
            read(folder / name, 100, below=folder)
    with regular_files(folder) as files, pytest.raises(UnusableFileError, match="is a link"):
        files.names("elsewhere")


def test_what_is_missing_too_large_or_no_file_is_not_read(folder):
    os.mkfifo(folder / "pipe")
    assert read_regular_file(folder / "no such folder" / "file", below=folder) is None
    assert read_regular_file(folder / "inner", below=folder) is None
    for name, reason in (("pipe", "is not a regular file"), ("inner/file", "is larger than")):
        with pytest.raises(UnusableFileError, match=reason):
            read_regular_file(folder / name, 5, below=folder)


def test_nothing_is_written_through_a_link(folder, tmp_path):
    for name in ("linked", "inner/file"):
        os.close(open_new_file(folder / name, below=folder))
        assert (folder / name).read_bytes() == b""
        assert not (folder / name).is_symlink()
    (folder / "linked").unlink()
    (folder / "linked").symlink_to("../outside/file")
    write_file(folder / "linked", b"new", below=folder)
    assert (folder / "linked").read_bytes() == b"new"
    writers = (
        lambda: write_file(folder / "elsewhere" / "file", b"", below=folder),
        lambda: open_new_file(folder / "elsewhere" / "file", below=folder),
        lambda: make_folder(folder / "elsewhere", below=folder),
        lambda: make_folder(folder / "elsewhere" / "deeper", below=folder),
    )
    for write in writers:
        with pytest.raises(OutputError, match="elsewhere: this is a link"):
            write()
    assert [path.name for path in (tmp_path / "outside").iterdir()] == ["file"]
    assert (tmp_path / "outside" / "file").read_bytes() == b"outside"


def test_a_hard_link_is_replaced(folder, tmp_path):
    os.link(tmp_path / "outside" / "file", folder / "hard")
    os.close(open_new_file(folder / "hard", below=folder))
    assert (tmp_path / "outside" / "file").read_bytes() == b"outside"


def test_a_folder_in_place_of_a_file_is_one_clear_error(folder):
    with pytest.raises(OutputError, match="inner: cannot be written"):
        open_new_file(folder / "inner", below=folder)


@pytest.mark.parametrize(
    ("content", "error"),
    [
        ('{"rows": "3"}', "rows: Input should be a valid integer"),
        ('{"rows": true}', "rows: Input should be a valid integer"),
        ('{"name": "x"}', "rows: Field required"),
        ('{"rows": 3, "other": 1}', "other: Extra inputs are not permitted"),
        ("[]", "Input should be an object"),
        ('{"rows"', "Invalid JSON"),
        ('{"rows": ' + "9" * 10_000 + "}", "Invalid JSON|rows: "),
        ("[" * 100_000, "Invalid JSON"),
        ('{"rows": 1, "a\\nb\\u001b": 2}', r"a\?b\?: Extra inputs"),
    ],
)
def test_json_of_another_kind_is_one_clear_line(tmp_path, content, error):
    (tmp_path / "file.json").write_text(content)
    with pytest.raises(UnusableFileError, match=error) as raised:
        read_json_file(tmp_path / "file.json", Sample)
    assert str(raised.value).isprintable()


def test_json_of_the_right_kind_is_read(tmp_path):
    (tmp_path / "file.json").write_text('{"rows": 3, "share": 1}')
    assert read_json_file(tmp_path / "file.json", Sample) == Sample(rows=3, share=1.0)
    assert read_json_file(tmp_path / "other.json", Sample) is None
