import math

import pytest
from hypothesis import given, strategies as st

from mimoc.base.rounding import SIGNIFICANT_DIGITS, readable, rounded
from mimoc.compiler.mjcf.printing import num

finite = st.floats(allow_nan=False, allow_infinity=False)
plain_data = st.recursive(
    st.none() | st.booleans() | st.integers() | finite | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=20,
)

NUMBERS = {
    "a third": (1 / 3, "0.333333333"),
    "a whole float": (5.0, "5"),
    "an integer": (44, "44"),
    "a negative zero": (-0.0, "0"),
    "a small number": (1e-13, "1e-13"),
    "a number that MuJoCo does not read": (1e-309, "0"),
    "a sum that is not quite round": (0.1 + 0.2, "0.3"),
    "true": (True, "true"),
    "false": (False, "false"),
    "a vector": ((0.0, -0.0, 1 / 3), "0 0 0.333333333"),
    "nothing": ((), ""),
}


@pytest.mark.parametrize("case", NUMBERS)
def test_numbers_are_written_as_mjcf_wants_them(case):
    value, text = NUMBERS[case]
    assert num(value) == text


@given(value=finite)
def test_a_number_survives_to_nine_digits(value):
    assert float(num(value)) == pytest.approx(value, rel=0.5000001 * 10 ** (1 - SIGNIFICANT_DIGITS), abs=1e-300)


@given(value=finite)
def test_writing_what_was_written_changes_nothing(value):
    assert num(float(num(value))) == num(value)


@given(value=finite)
def test_no_number_is_a_negative_zero(value):
    assert num(value) != "-0"
    assert math.copysign(1, float(num(0.0 * value))) == 1


@given(data=plain_data)
def test_rounding_twice_is_rounding_once(data):
    assert rounded(rounded(data)) == rounded(data)


def test_integers_and_booleans_are_not_rounded():
    assert rounded({"seed": 2**53, "on": True}) == {"seed": 2**53, "on": True}


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (1.62706e-05, 6, "0.000016"),
        (-1.62706e-05, 3, "-0.000016"),
        (1e-9, 3, "0"),
        (-1e-9, 3, "0"),
        (0.0, 3, "0"),
        (0.25, 3, "0.25"),
        (0.123456, 3, "0.123"),
        (99.96, 3, "100"),
        (1234567.8, 3, "1234568"),
        (1e20, 3, "100000000000000000000"),
        (5, 3, "5"),
        (float("nan"), 3, "-"),
        (float("-inf"), 3, "-"),
    ],
)
def test_people_read_numbers_without_exponents(value, digits, text):
    assert readable(value, digits) == text
