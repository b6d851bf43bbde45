import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.base.geometry.meshes import normals_of
from mimoc.base.geometry.solvers import narrowed, root

places = st.floats(-1, 1, allow_subnormal=False)


@given(places)
def test_a_root_is_found_to_its_precision(place):
    assert root(lambda x: x**3 + x - place**3 - place, -2, 2, 1e-10) == pytest.approx(place, abs=1e-9)


@given(places)
def test_a_jump_is_found_by_bisection(place):
    assert root(lambda x: 1 if x > place else -1, -2, 2, 1e-9, method="bisect") == pytest.approx(place, abs=2e-9)


@given(st.lists(st.tuples(places, st.floats(0.1, 10)), min_size=1, max_size=3))
def test_minima_are_found_as_well_as_floats_allow(functions):
    where, widths = np.array(functions).T
    ends = np.full(len(where), 2.0)
    lows, highs = narrowed(lambda x: np.cosh((x - where[:, None]) / widths[:, None]), -ends, ends, 1e-9)
    assert (highs - lows).max() <= 1e-9
    assert (lows + highs) / 2 == pytest.approx(where, abs=1e-6 * max(1.0, widths.max()))


@given(st.lists(places, min_size=2, max_size=4))
def test_a_bracket_is_narrowed_as_if_it_were_alone(where):
    def alone(place):
        return narrowed(lambda x: np.abs(x - place), np.array([-2.0]), np.array([2.0 + place]), 1e-9)

    centres = np.array(where)
    together = narrowed(lambda x: np.abs(x - centres[:, None]), np.full(len(where), -2.0), 2.0 + centres, 1e-9)
    assert np.array_equal(together, np.concatenate([alone(place) for place in where], axis=1))


def test_normals_lead_away_from_a_mesh_that_is_counterclockwise_from_outside():
    """A corner of a tetrahedron of three right angles leads to where all three of its sides are seen."""
    verts = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    assert normals_of(verts, faces)[0] == pytest.approx(-np.ones(3) / np.sqrt(3))


def test_a_vertex_of_no_triangle_has_no_normal():
    assert normals_of(np.eye(4, 3), np.array([(0, 1, 2)]))[3].tolist() == [0, 0, 0]
