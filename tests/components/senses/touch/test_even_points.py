"""Skin points on an ellipsoid."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import KDTree

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_average
from mimoc.components.senses.touch.build_skin_points import depth, even_points, place

HEAD = grow_average(18, assemble("mitten", False)).geoms["head"]
SPACING_M = 0.013


def test_neighbours_on_an_ellipsoid_are_a_spacing_apart():
    points_m = place(HEAD, even_points(HEAD, SPACING_M))
    distances_m, _ = KDTree(points_m).query(points_m, k=5)
    assert depth(HEAD, points_m) == pytest.approx(0, abs=1e-12)
    assert distances_m[:, 1].min() > 0.75 * SPACING_M
    assert distances_m[:, 1:].mean(axis=1).max() < 1.15 * SPACING_M


def test_points_on_an_ellipsoid_are_the_same_on_both_sides():
    points_m = place(HEAD, even_points(HEAD, SPACING_M))
    gaps_m, _ = KDTree(points_m).query(points_m * (1, -1, 1))
    assert gaps_m.max() < 1e-6


def test_points_on_an_ellipsoid_with_equal_half_axes_are_those_on_a_sphere():
    ball = replace(HEAD, type="sphere", size_m=(0.075,))
    round_one = replace(HEAD, size_m=(0.075, 0.075, 0.075))
    points_m, same_m = (place(geom, even_points(geom, SPACING_M)) for geom in (ball, round_one))
    assert points_m.shape == same_m.shape
    assert np.abs(points_m - same_m).max() < 1e-6
