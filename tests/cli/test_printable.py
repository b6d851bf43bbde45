"""Names of files that a terminal must not get as they are."""

import pytest

from mimoc.cli.terminal import printable


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("out/Zoë 3", "out/Zoë 3"),
        ("a\x1b[31mb", "a\\x1b[31mb"),
        ("a\rb\x07", "a\\rb\\x07"),
        ("a\u202eb", "a\\u202eb"),
        ("two\nlines", "two\nlines"),
    ],
)
def test_what_a_terminal_would_obey_is_escaped(text, printed):
    assert printable(text) == printed


def test_a_command_escapes_the_names_of_its_files(invoke, here):
    """In errors as well as in what it says that it has written."""
    wrong = invoke("build", "a\x1b[31m.yaml", "-o", "out")
    assert (wrong.code, wrong.err) == (2, "a\\x1b[31m.yaml:1:1: the file does not exist; check the path\n")
    written = invoke("schema", "-o", "b\x1b[31m.json")
    assert (written.code, written.out) == (0, "b\\x1b[31m.json\n")
