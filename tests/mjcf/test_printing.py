import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jinja2 import UndefinedError

from mimoc.mjcf.printing import SIGNIFICANT_DIGITS, environment, num, render_json, render_text, rounded

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


@given(data=plain_data)
def test_json_has_sorted_keys_rounded_numbers_and_a_last_newline(data):
    text = render_json(data).decode()
    assert text.endswith("\n")
    assert json.loads(text) == json.loads(json.dumps(rounded(data), sort_keys=True))
    spread = json.dumps(json.loads(text), indent=1, sort_keys=True, ensure_ascii=False) + "\n"
    assert "".join(text.split()) == "".join(spread.split())


def test_json_has_lists_of_numbers_on_one_line_and_all_else_spread_out():
    data = {"names": ["[\n1]", "b"], "points": [[1, -2.5e-7], [0.5, 3]], "none": []}
    lines = ["{", ' "names": [', '  "[\\n1]",', '  "b"', " ],", ' "none": [],', ' "points": [']
    assert render_json(data).decode().splitlines() == [*lines, "  [1, -2.5e-07],", "  [0.5, 3]", " ]", "}"]


def test_integers_and_booleans_are_not_rounded():
    assert rounded({"seed": 2**53, "on": True}) == {"seed": 2**53, "on": True}


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_json_without_nan(value):
    with pytest.raises(ValueError, match="JSON compliant"):
        render_json({"value": value})


def test_a_template_that_is_given_too_little_fails():
    with pytest.raises(UndefinedError):
        environment().from_string("{{ nothing }}").render()
    with pytest.raises(UndefinedError, match="manifest"):
        render_text("README.md.j2", version="1")


def test_names_are_escaped_in_xml():
    template = environment().get_template("scene.xml.j2")
    assert template.environment.autoescape("scene.xml.j2")
    assert not template.environment.autoescape("README.md.j2")
