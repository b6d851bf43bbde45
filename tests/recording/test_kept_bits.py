"""What stands in files comes back to the bit: states, names, rows with few numbers, pictures."""

import json
from fractions import Fraction
from unittest import mock

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as arrays

from mimoc.base.errors import RecordingError
from mimoc.recording import columns as described, frames
from mimoc.recording.blocks import Sparse, reading_of
from mimoc.recording.columns import compact_names, expand_names
from mimoc.recording.state_text import from_plain, is_same, to_plain

numbers = arrays.arrays(
    st.sampled_from([np.dtype(name) for name in ("f4", "f8", "c16", "i4", "u1", "?")]),
    arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4),
)
states = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | numbers,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(inner, max_size=3).map(tuple)
        | st.dictionaries(st.text() | st.integers(), inner, max_size=3)
    ),
    max_leaves=12,
)


@given(state=states)
def test_a_state_comes_back_from_json_to_the_bit(state):
    again = from_plain(json.loads(json.dumps(to_plain(state), allow_nan=False)))
    assert is_same(state, again)
    assert type(again) is type(state)


def test_states_tell_apart_what_equals():
    assert not is_same(np.array([0.0]), np.array([-0.0]))
    assert not is_same([1.0], (1.0,))
    assert is_same(float("nan"), float("nan"))


@pytest.mark.parametrize("unknown", [object(), {1, 2}, np.array([None])])
def test_what_cannot_be_kept_is_refused(unknown):
    with pytest.raises(RecordingError, match="cannot be kept"):
        to_plain({"task": [unknown]})


@pytest.mark.parametrize("damaged", [{"$array": "AAAA", "dtype": "<f8", "shape": [3]}, {"$float": "x"}, {"$items": 1}])
def test_damaged_states_are_one_clear_error(damaged):
    with pytest.raises(RecordingError, match="damaged"):
        from_plain(damaged)


names = st.builds(
    "{}{}{}".format, st.sampled_from(["hip ", "left 2 ", ""]), st.integers(0, 12), st.sampled_from([" x", " y", ""])
)


@given(layout=st.lists(names | st.text(max_size=3), max_size=14))
def test_any_layout_comes_back_whatever_counts_as_long(layout):
    with mock.patch.object(described, "LONG", 0):
        assert expand_names(json.loads(json.dumps(compact_names(layout)))) == tuple(layout)
    assert expand_names(compact_names(layout)) == tuple(layout)


def test_thousands_of_skin_points_take_few_words(open_env):
    layout = open_env(senses={"touch": {}}).layout("touch")
    assert len(json.dumps(compact_names(layout))) < len(layout)
    assert expand_names(compact_names(layout)) == layout


@given(
    rows=arrays.arrays(
        st.sampled_from([np.dtype("f4"), np.dtype("f8"), np.dtype("i4")]),
        st.tuples(st.integers(1, 3), st.integers(1, 70)),
        fill=st.just(0),
    )
)
def test_a_sparse_row_has_every_number_whose_bits_are_not_zero(rows):
    sparse = Sparse(reading_of("touch", rows[0]), len(rows))
    for number, row in enumerate(rows):
        sparse.put(number, row)
    again = np.zeros_like(rows)
    for number, (start, end) in enumerate(zip(sparse.ends, sparse.ends[1:], strict=False)):
        again[number, sparse.index[start:end]] = sparse.value[start:end]
    assert again.tobytes() == rows.tobytes()


@pytest.mark.parametrize("size", [(17, 33), (1, 1), (24, 1), (1, 24), (3, 2)], ids=str)
def test_pictures_come_back_as_they_were(size, tmp_path):
    """Of odd sizes, from parts of any length."""
    pictures = np.random.default_rng(0).integers(0, 256, (9, *size, 3), np.uint8)
    paths = [tmp_path / "episodes" / f"part{number}.mkv" for number in range(3)]
    paths[0].parent.mkdir()
    for path, part in zip(paths, (pictures[:5], pictures[5:6], pictures[6:]), strict=True):
        frames.write_pictures(path, part, Fraction(100))
    assert np.array_equal(frames.read_pictures(paths, 9, (*size, 3)), pictures)


@pytest.mark.parametrize("damage", ["empty", "no video", "no text"])
def test_a_damaged_video_is_one_clear_error(damage, tmp_path):
    """Even if its text, such as the name of the library that wrote it, cannot be decoded."""
    path = tmp_path / "episodes" / "eye.mkv"
    path.parent.mkdir()
    frames.write_pictures(path, np.zeros((2, 16, 16, 3), np.uint8), Fraction(100))
    written = path.read_bytes()
    path.write_bytes({"empty": b"", "no video": b"no video", "no text": written.replace(b"Lavf", b"\x93avf")}[damage])
    with pytest.raises(RecordingError, match=r"eye\.mkv: the file is damaged"):
        frames.read_pictures([path], 2, (16, 16, 3))
