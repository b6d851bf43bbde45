"""What is particular to newborns is all there at birth, fades, and is gone at 18 months."""

import pytest
from hypothesis import given, strategies as st

from mimoc.body.maturation import Decay

decays = st.builds(Decay, st.floats(1, 20), st.floats(0.5, 3))
ages = st.floats(0, 24)


@given(decays)
def test_a_newborn_has_all_of_it_and_an_infant_of_18_months_nothing(decay):
    assert decay(0) == 1
    assert decay(18) == decay(18.5) == decay(24) == 0


@given(decays, ages, ages)
def test_it_only_fades(decay, one, other):
    younger, older = sorted((one, other))
    assert 0 <= decay(older) <= decay(younger) <= 1


def test_it_is_a_stretched_exponential_that_ends_at_18_months():
    assert Decay(12, 1)(6) == pytest.approx((0.60653 - 0.22313) / (1 - 0.22313), abs=1e-5)
