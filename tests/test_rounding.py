import json
import math

import pytest
from hypothesis import given, strategies as st

from mimoc.base.rounding import SIGNIFICANT_DIGITS, readable, render_json, rounded
from mimoc.base.units import cm_to_m, m_to_cm, months_to_days, ms_to_s, to_steps
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


def test_what_a_spec_says_in_si():
    assert cm_to_m(46.8) == pytest.approx(0.468)
    assert ms_to_s(5) == 0.005


@given(length_cm=st.floats(0, 1e6))
def test_centimetres_come_back(length_cm):
    assert m_to_cm(cm_to_m(length_cm)) == pytest.approx(length_cm)


def test_months_are_whos():
    """WHO's tables run to day 1856 and count 30.4375 days a month."""
    assert months_to_days(24) == 730.5
    assert months_to_days(1) == 30.4375


@given(steps=st.integers(0, 10_000), timestep_ms=st.floats(0.1, 20))
def test_whole_steps_are_counted(steps, timestep_ms):
    """Also of times as they stand in a bundle: a third of a millisecond is no whole part of a second there."""
    assert to_steps(steps * timestep_ms, timestep_ms) == steps
    assert to_steps(rounded(steps * timestep_ms), rounded(timestep_ms)) == steps


@pytest.mark.parametrize(
    ("time_ms", "timestep_ms", "message"),
    [
        (12, 5, "12 ms is 2.40 steps of 5 ms; the nearest that works is 10 ms"),
        (13, 5, "13 ms is 2.60 steps of 5 ms; the nearest that works is 15 ms"),
        (3, 2.5, "3 ms is 1.20 steps of 2.5 ms; the nearest that works is 2.5 ms"),
    ],
)
def test_a_time_between_steps_is_refused_with_the_nearest(time_ms, timestep_ms, message):
    with pytest.raises(ValueError, match=message):
        to_steps(time_ms, timestep_ms)


@given(data=plain_data, levels=st.sampled_from([0, 1, 2, 99]))
def test_json_has_sorted_keys_rounded_numbers_and_a_last_newline(data, levels):
    text = render_json(data, levels).decode()
    assert text.endswith("\n")
    assert json.loads(text) == json.loads(json.dumps(rounded(data), sort_keys=True))
    spread = json.dumps(json.loads(text), indent=1, sort_keys=True, ensure_ascii=False) + "\n"
    assert "".join(text.split()) == "".join(spread.split())


def test_json_has_lists_of_numbers_on_one_line_and_all_else_spread_out():
    data = {"names": ["[\n1]", "b"], "points": [[1, -2.5e-7], [0.5, 3]], "none": []}
    lines = ["{", ' "names": [', '  "[\\n1]",', '  "b"', " ],", ' "none": [],', ' "points": [']
    assert render_json(data).decode().splitlines() == [*lines, "  [1, -2.5e-07],", "  [0.5, 3]", " ]", "}"]


def test_json_has_on_one_line_what_lies_deeper_than_asked():
    data = {"numbers": {"a": {"b": [1, {"c": {}}]}}, "none": {}}
    lines = ["{", ' "none": {},', ' "numbers": {', '  "a": {"b": [1, {"c": {}}]}', " }", "}"]
    assert render_json(data, 2).decode().splitlines() == lines


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_json_without_nan(value):
    with pytest.raises(ValueError, match="JSON compliant"):
        render_json({"value": value})
