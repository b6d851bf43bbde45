"""A little of `tests/fuzz/lives.py`."""

import pytest
from fuzz.lives import live_apart


@pytest.mark.slow
def test_no_order_of_calls_ends_python():
    """Four orders; `.ci/task fuzz` tries two hundred, and more with `LIVES=1000`."""
    counts, fault = live_apart("all_senses", number=3, sequences=4)
    assert fault == ""
    assert counts["refused"]
