"""Curves that are drawn into a mesh: its edges run along them, and it stays closed."""

from collections import Counter

import numpy as np
import pytest
from cutting import Curve, embedded, mirrored, right_half
from fields import ball
from meshing import edges_of
from scipy.spatial import ConvexHull

RADIUS_MM, SIZE_MM = 40.0, 8.0
LEVELS_MM = (-12.0, 15.0)
BALL = ball((0, 0, 0), RADIUS_MM)


@pytest.fixture(scope="module")
def drawn():
    count = 400
    z = 1 - 2 * (np.arange(count) + 0.5) / count
    turn = np.arange(count) * np.pi * (3 - np.sqrt(5))
    verts = RADIUS_MM * np.column_stack((np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z))
    faces = ConvexHull(verts).simplices
    a, b, c = verts[faces].transpose(1, 0, 2)
    inwards = (np.cross(b - a, c - a) * a).sum(axis=1) < 0
    faces[inwards] = faces[inwards][:, ::-1]
    curves = [Curve(lambda p, z=level: p[:, 2] - z, lambda p: np.ones(len(p), bool)) for level in LEVELS_MM]
    half = right_half(BALL, verts, faces)
    return mirrored(embedded(BALL, half, curves, lambda p: np.full(len(p), SIZE_MM)))


def test_vertices_are_on_the_surface_and_on_their_curves(drawn):
    assert np.abs(BALL(drawn.verts)).max() < 0.02
    for number, level_mm in enumerate(LEVELS_MM):
        height_mm = drawn.verts[drawn.lies_on[:, 1 + number], 2]
        assert len(height_mm) > 20
        assert np.abs(height_mm - level_mm).max() < 0.02


def test_a_curve_is_a_ring_of_edges_that_no_edge_crosses(drawn):
    edges = edges_of(drawn.faces)
    for number, level_mm in enumerate(LEVELS_MM):
        is_on = drawn.lies_on[:, 1 + number]
        ring = edges[is_on[edges].all(axis=1)]
        assert set(np.bincount(ring.ravel(), minlength=len(is_on))[is_on]) == {2}
        side = np.sign(np.where(is_on, 0, drawn.verts[:, 2] - level_mm))
        assert (side[edges].prod(axis=1) >= 0).all()


def test_the_mesh_is_closed_even_and_symmetric(drawn):
    directed = Counter((int(a), int(b)) for face in drawn.faces for a, b in zip(face, np.roll(face, -1), strict=True))
    assert set(directed.values()) == {1}
    assert all((b, a) in directed for a, b in directed)
    lengths_mm = np.linalg.norm(np.diff(drawn.verts[edges_of(drawn.faces)], axis=1)[:, 0], axis=1)
    assert lengths_mm.min() > 0.3 * SIZE_MM
    assert np.allclose(drawn.verts[drawn.twins], drawn.verts * (1, -1, 1))
