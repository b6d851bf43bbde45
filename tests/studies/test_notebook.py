import csv
import math

import pytest

from mimoc.base.errors import OutputError
from mimoc.studies.notebook import markdown_table, open_notebook


@pytest.fixture
def notebook(tmp_path):
    return open_notebook("growth", tmp_path / "deep" / "down", quick=True, development="maturing")


def test_its_folder_is_made(notebook, tmp_path):
    assert notebook.folder == tmp_path / "deep" / "down"
    assert notebook.folder.is_dir()


def test_a_table_reads_back_as_it_was_written(notebook):
    notebook.write_table("some.csv", "name,size_m", [("a, b", 0.125), ("c", 1)])
    with (notebook.folder / "some.csv").open(newline="") as file:
        assert list(csv.DictReader(file)) == [{"name": "a, b", "size_m": "0.125"}, {"name": "c", "size_m": "1"}]


def test_nothing_to_say_is_an_empty_cell(notebook):
    notebook.write_table("some.csv", "a,b,c", [(None, math.nan, 0.0)])
    assert (notebook.folder / "some.csv").read_bytes() == b"a,b,c\n,,0\n"


def test_text_is_wrapped_and_tables_are_not(notebook):
    table = markdown_table(("a", "b"), [("long " * 40, "1")])
    page = notebook.write_page(f"# Growth\n\n{'many words ' * 40}\n\n{table}").read_text()
    assert page.startswith("# Growth\n\nmany words many words")
    assert table in page
    assert max(len(line) for line in page.splitlines() if not line.startswith("|")) <= 120


def test_what_is_there_already_stays(notebook):
    (notebook.folder / "mine.txt").write_text("mine")
    open_notebook("growth", notebook.folder, quick=False).write_table("some.csv", "a", [])
    assert sorted(path.name for path in notebook.folder.iterdir()) == ["mine.txt", "some.csv"]


@pytest.mark.parametrize(
    ("place", "reason"),
    [
        ("file.txt", "is a file, not a folder; choose another folder"),
        ("file.txt/results", "cannot be created"),
        ("l" * 300, "cannot be created"),
        ("nul\0", "a folder cannot have this name"),
    ],
)
def test_a_folder_that_cannot_be_is_an_error(place, reason, tmp_path):
    (tmp_path / "file.txt").write_text("mine")
    with pytest.raises(OutputError, match=reason):
        open_notebook("growth", tmp_path / place, quick=False)
    assert [path.name for path in tmp_path.iterdir()] == ["file.txt"]


def test_a_markdown_table_has_a_line_for_each_row():
    assert markdown_table(("a", "b"), [("1", "2")]) == "| a | b |\n| --- | --- |\n| 1 | 2 |"
