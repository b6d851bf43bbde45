import json
import math

import pytest
from hypothesis import given, strategies as st

from mimoc.base.rounding import render_json, rounded

finite = st.floats(allow_nan=False, allow_infinity=False)
plain_data = st.recursive(
    st.none() | st.booleans() | st.integers() | finite | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=20,
)


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
