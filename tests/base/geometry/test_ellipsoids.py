"""Perimeters, areas and nearest points of ellipses and ellipsoids."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.special import ellipe, elliprg

from mimoc.base.geometry.ellipsoids import ellipse_perimeter, ellipsoid_area, nearest_points
from mimoc.base.geometry.primitives import girth

lengths = st.floats(0.5, 1.0)
half_axes = st.tuples(lengths, lengths, lengths)
coordinates = st.one_of(st.just(0.0), st.floats(-2, 2))
points = st.tuples(coordinates, coordinates, coordinates).map(np.array)


@given(short=lengths)
def test_a_perimeter_is_the_elliptic_integral(short):
    assert ellipse_perimeter(1.0, short) == pytest.approx(4 * ellipe(1 - short**2), rel=1e-9)
    assert ellipse_perimeter(short, 1.0) == ellipse_perimeter(1.0, short)


@given(half_axes=half_axes)
def test_an_area_is_the_elliptic_integral(half_axes):
    a, b, c = half_axes
    wanted = 4 * np.pi * elliprg((a * b) ** 2, (a * c) ** 2, (b * c) ** 2)
    assert ellipsoid_area(half_axes) == pytest.approx(wanted, rel=1e-10)


@given(half_axes=half_axes, point=points)
def test_the_nearest_point_is_on_the_surface_and_none_found_by_trying_is_nearer(half_axes, point):
    """Inside, outside and in the planes of symmetry."""
    (nearest,) = nearest_points(half_axes, point[None])
    assert np.linalg.norm(nearest / half_axes) == pytest.approx(1, abs=1e-9)
    polar, around = np.meshgrid(np.linspace(0, np.pi, 41), np.linspace(0, 2 * np.pi, 80))
    ball = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    distances = np.linalg.norm(point - ball * half_axes, axis=-1)
    assert np.linalg.norm(point - nearest) <= distances.min() + 1e-12


@pytest.mark.parametrize(
    ("kind", "size", "wanted"),
    [
        ("sphere", (1.0,), 2 * np.pi),
        ("capsule", (1.0, 3.0), 2 * np.pi),
        ("ellipsoid", (1.0, 1.0, 2.0), 2 * np.pi),
        ("box", (1.0, 2.0, 3.0), 12.0),
    ],
)
def test_a_girth_is_measured_across_the_middle(kind, size, wanted):
    assert girth(kind, size) == pytest.approx(wanted)
