"""The index of the receptors near a place, against a plain search."""

from itertools import product

import numpy as np
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import arrays

from mimoc.components.senses.touch.receptors import CELL_STRIDES, _neighbours

places = arrays(float, st.tuples(st.integers(1, 12), st.just(3)), elements=st.floats(-3, 3, width=32))


def distance_of_cell(place: np.ndarray, corner: np.ndarray) -> float:
    """Return the distance of a place from a cube of one unit."""
    return float(np.linalg.norm(np.maximum(np.maximum(corner - place, place - corner - 1), 0)))


@settings(max_examples=8)
@given(places)
def test_a_cell_lists_in_order_all_receptors_within_one_unit_of_it(scaled):
    scaled = np.add(scaled, (1e3, 0, 0))
    cells, table = _neighbours(scaled)
    listed = {
        cell: [each for each in row if each < len(scaled)] for cell, row in zip(cells, table.tolist(), strict=False)
    }
    assert [*cells] == sorted(listed)
    assert (table[-1] == len(scaled)).all()
    for corner in product(*(np.arange(start - 4.0, start + 5.0) for start in (1e3, 0, 0))):
        distances = [distance_of_cell(place, np.array(corner)) for place in scaled]
        near = [index for index, distance in enumerate(distances) if distance < 1 - 1e-9]
        found = listed.get(float(np.array(corner) @ CELL_STRIDES), [])
        assert near == [index for index in found if distances[index] < 1 - 1e-9]
        assert all(distances[index] < 1 + 1e-9 for index in found)
