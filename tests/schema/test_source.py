"""The YAML reader: what it takes a text for, where it says things stand, and what it refuses."""

import os
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from mimoc.base.errors import SpecError
from mimoc.schema import source
from mimoc.schema.base import dotted
from mimoc.schema.source import dump, parse, read

WORDS = st.text(st.characters(codec="utf-8", exclude_categories=("C", "Z")) | st.just(" "), max_size=20)
SCALARS = st.booleans() | st.integers(-(10**18), 10**18) | st.floats(allow_nan=False, allow_infinity=False) | WORDS
DATA = st.dictionaries(
    WORDS, st.recursive(SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(WORDS, inner, max_size=3))
)


def complaints(text: str | bytes) -> str:
    try:
        return "\n".join(map(str, parse(text, "f").problems))
    except SpecError as error:
        return str(error)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        *[("1e-3", 0.001), ("1E3", 1000.0), (".5", 0.5), ("5.", 5.0), ("-0.5", -0.5), ("+3", 3)],
        *[("012", 12), ("0o14", 12), ("0xC", 12), ("1_000", "1_000"), ("1:30", "1:30"), ("2001-01-01", "2001-01-01")],
        *[("no", "no"), ("yes", "yes"), ("on", "on"), ("off", "off"), ("y", "y"), ("true", True), ("False", False)],
        *[("null", None), ("~", None), ("", None), ("nan", "nan"), ("inf", "inf"), ("'1e-3'", "1e-3"), ('"no"', "no")],
        *[("=", "="), ("1e", "1e"), ("1e400x", "1e400x"), ("--1", "--1"), ("0x", "0x"), ("1e-400", 0.0)],
    ],
)
def test_scalars_mean_what_yaml_1_2_says(written, meant):
    value = parse(f"key: {written}", "f").data["key"]
    assert (type(value), value) == (type(meant), meant)


@pytest.mark.parametrize("written", [".nan", ".NaN", ".inf", "-.INF", "1e400", "-1e400", "9" * 400, "9" * 5000])
def test_numbers_that_nothing_can_be_calculated_from_are_read_past_and_reported(written):
    read_past = parse(f"key: {written}", "f")
    assert read_past.invalid == {("key",)}
    assert "number" in read_past.problems[0].message


@given(DATA)
def test_what_is_dumped_is_read_back(data):
    assert parse(dump(data), "f").data == data


@pytest.mark.full
@given(DATA)
def test_equal_data_is_dumped_alike(data):
    assert dump(dict(reversed(data.items()))) == dump(data)


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("bom", ["", "\ufeff"])
def test_places_are_the_same_however_lines_end(newline, bom):
    lines = ["# first", "body:", "  parts:", "    hand: {girth: 0.9, length: 1}", "list: [a, [b, c]]", "empty:"]
    text = bom + newline.join(lines)
    read_text = parse(text, "f")
    assert read_text.text == text
    assert read_text.locate(("body",), at="key") == (2, 1)
    assert read_text.locate(("body",)) == (3, 3)
    assert read_text.locate(("body", "parts", "hand", "girth")) == (4, 19)
    assert read_text.locate(("body", "parts", "hand", "length"), at="key") == (4, 24)
    assert read_text.locate(("list", 1, 0)) == (5, 12)
    assert read_text.locate(("empty",)) == (6, 7)


def test_what_was_not_written_stands_at_the_closest_key_above_it():
    read_text = parse("body:\n  hands: mitten\n", "f")
    assert read_text.locate(("body", "remove", 0)) == (1, 1)
    assert read_text.locate(("scene", "room", "size_m")) == (1, 1)


@given(st.lists(st.sampled_from(["", "# comment", "  "]), min_size=8, max_size=8))
def test_places_count_every_line_before(fillers):
    text = "".join(f"{filler}\nkey_{number}: {number}\n" for number, filler in enumerate(fillers))
    read_text = parse(text, "f")
    lines = text.split("\n")
    for number in range(8):
        line, column = read_text.locate((f"key_{number}",))
        assert lines[line - 1][column - 1 :] == str(number)


def test_paths_are_written_as_users_write_them():
    assert dotted(("scene", "room", "size_m", 0, 1)) == "scene.room.size_m[0][1]"
    assert dotted(()) == ""
    assert dotted(("two\nlines",)) == "two\\nlines"


def test_several_problems_are_gathered_in_one_reading():
    found = complaints("a: .nan\na: 1\nb: !!int 1\n<<: {c: 1}\n? [x]\n: 1\n2: 3\nd: *nowhere\n")
    assert [line.split(":")[1] for line in found.splitlines()] == ["1", "2", "3", "4", "5", "7", "8"]


def test_the_first_of_two_equal_keys_counts():
    assert parse("a: {x: 1}\na: {y: [1, {z: 2}]}\nb: 3\n", "f").data == {"a": {"x": 1}, "b": 3}


def test_a_few_aliases_are_fine_but_many_are_not():
    assert parse("a: &x [1, 2]\nb: *x\n", "f").data == {"a": [1, 2], "b": [1, 2]}
    bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
    bomb += "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 30))
    assert "values, counting aliases" in complaints(bomb)
    assert "inside its own anchor" in complaints("a: &a [*a]")


@pytest.mark.parametrize("opener", ["[", "{a: ", "- ", "? ", "[{a: "])
def test_depth_without_end_is_refused(opener):
    assert "f:1:" in complaints(opener * 10_000)


@given(st.binary(max_size=200))
def test_bytes_are_read_or_refused(content):
    complaints(content)


@given(st.text(st.sampled_from("ab1:,-[]{}&*!|>'\"%@`#?\\ \t\r\n\ufeff"), max_size=60))
def test_texts_of_yaml_signs_are_read_or_refused(text):
    for line in complaints(text).splitlines():
        assert line.isprintable()
        assert "; " in line


def test_the_size_of_a_file_is_bounded_without_reading_it(tmp_path):
    huge = tmp_path / "huge.yaml"
    huge.touch()
    os.truncate(huge, 100 * 2**20)
    with pytest.raises(SpecError, match=r"100\.0 MiB"):
        read(huge)


def test_files_just_within_the_bound_are_read(tmp_path):
    large = tmp_path / "large.yaml"
    large.write_bytes(b"a: 1\n#".ljust(source.MAX_BYTES, b"x"))
    assert read(large).data == {"a": 1}


def test_pipes_and_devices_are_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", "/dev/zero"):
        with pytest.raises(SpecError, match="pipe or a device"):
            read(path)


def test_unreadable_files_say_so(tmp_path, monkeypatch):
    """Root may read everything, so the refusal is played."""
    secret = tmp_path / "secret.yaml"
    secret.write_text("mimoc: 1")

    def refuse(*_):
        raise PermissionError

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(SpecError, match="permissions"):
        read(secret)


@pytest.mark.parametrize("path", ["no\0name", "x" * 5000])
def test_impossible_paths_are_refused(path):
    with pytest.raises(SpecError, match="check the path"):
        read(path)


def test_every_unprintable_character_of_a_file_is_named():
    assert complaints("a: \x07\nb: \u2028\n").splitlines() == [
        "f:1:4: the character '\\x07' is not text; remove it",
        "f:2:4: the character '\\u2028' is not text; remove it",
    ]
