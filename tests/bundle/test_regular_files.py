"""Files in folders that may come from anyone."""

import os

import pytest

from mimoc.base.errors import OutputError
from mimoc.bundle.files import make_folder, open_new_file, write_file
from mimoc.bundle.regular_files import (
    UnusableFileError,
    open_regular_file,
    read_json_file,
    read_regular_file,
    regular_files,
)
from mimoc.schema.base import Model


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
