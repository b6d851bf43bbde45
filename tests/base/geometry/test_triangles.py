"""Normals of meshes."""

import numpy as np
import pytest

from mimoc.base.geometry.triangles import normals_of


def test_normals_lead_away_from_a_mesh_that_is_counterclockwise_from_outside():
    """A corner of a tetrahedron of three right angles leads to where all three of its sides are seen."""
    verts = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    assert normals_of(verts, faces)[0] == pytest.approx(-np.ones(3) / np.sqrt(3))


def test_a_vertex_of_no_triangle_has_no_normal():
    assert normals_of(np.eye(4, 3), np.array([(0, 1, 2)]))[3].tolist() == [0, 0, 0]
