import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimoc.geometry.solvers import minimum, root

places = st.floats(-1, 1, allow_subnormal=False)


@given(places)
def test_a_root_is_found_to_its_precision(place):
    assert root(lambda x: x**3 + x - place**3 - place, -2, 2, 1e-10) == pytest.approx(place, abs=1e-9)


@given(places)
def test_a_jump_is_found_by_bisection(place):
    assert root(lambda x: 1 if x > place else -1, -2, 2, 1e-9, method="bisect") == pytest.approx(place, abs=2e-9)


@given(places, st.floats(0.1, 10))
def test_a_minimum_is_found_as_well_as_floats_allow(place, width):
    """Near its minimum a smooth function changes by the square of the distance."""
    found = minimum(lambda x: np.cosh((x - place) / width), -2, 2, 1e-9)
    assert found == pytest.approx(place, abs=1e-6 * max(1.0, width))
