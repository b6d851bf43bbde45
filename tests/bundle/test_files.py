import os
import stat
import threading
from contextlib import suppress

import pytest

from mimoc.base.errors import OutputError
from mimoc.bundle.files import staged_folder, write_file


def test_a_file_is_written_and_its_path_returned(tmp_path):
    assert write_file(tmp_path / "a.png", b"new") == tmp_path / "a.png"
    assert (tmp_path / "a.png").read_bytes() == b"new"


def test_an_old_file_is_replaced(tmp_path):
    (tmp_path / "a").write_bytes(b"an old and longer text")
    write_file(tmp_path / "a", b"new")
    assert (tmp_path / "a").read_bytes() == b"new"


def test_nothing_else_is_left_behind(tmp_path):
    write_file(tmp_path / "a", b"new")
    assert os.listdir(tmp_path) == ["a"]


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
    """A reader in another thread never sees a part of a file."""
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
