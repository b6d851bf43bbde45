"""A few spoilt specs; `make fuzz` tries thousands."""

import random
from collections import Counter

from fuzz.specs import attempt

SEED, TRIES = 2026, 60


def test_spoilt_specs_are_built_or_refused_in_clear_lines():
    found = Counter(attempt(random.Random(f"{SEED}/{number}")) for number in range(TRIES))
    assert found.keys() == {"built", "read", "refused"}
