from hypothesis import given
from hypothesis import strategies as st

from mimoc.delays.line import DelayLine


@given(st.integers(0, 20), st.lists(st.integers(), max_size=50))
def test_what_goes_in_comes_out_that_much_later(length, items):
    line = DelayLine(length, "rest")
    assert [line.shift(item) for item in items] == (["rest"] * length + items)[: len(items)]


@given(st.integers(0, 5), st.lists(st.integers(), max_size=10), st.lists(st.integers(), max_size=10))
def test_a_line_goes_on_from_what_another_held(length, before, after):
    one, other = DelayLine(length, 0), DelayLine(length, -1)
    for item in before:
        one.shift(item)
    other.held = one.held
    assert [one.shift(item) for item in after] == [other.shift(item) for item in after]


def test_what_a_line_holds_is_a_list_of_its_own():
    line = DelayLine(2, "rest")
    line.held.clear()
    assert line.held == ["rest", "rest"]
