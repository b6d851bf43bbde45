"""Girths and reaches of plane sections of solids."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.base.geometry.primitives import extents
from mimoc.base.geometry.rotations import matrix_from_euler
from mimoc.base.geometry.sections import Solids

UP, LEFT = np.eye(3)[2], np.eye(3)[1]
sizes = st.floats(0.02, 0.2)


def solids(*primitives) -> Solids:
    """Return solids from kind, size, centre and Euler angles in degrees."""
    kinds, sizes_m, centres, angles = zip(*primitives, strict=True)
    turns = np.array([matrix_from_euler(angle) for angle in angles])
    return Solids(extents(zip(kinds, sizes_m, strict=True)), np.array(centres, float), turns)


@given(radius=sizes, height=st.floats(-0.95, 0.95))
def test_a_sphere_is_cut_in_circles(radius, height):
    ball = solids(("sphere", (radius,), (0, 0, 1), (0, 0, 0)))
    across = math.sqrt(1 - height**2) * radius
    assert ball.girth(UP, 1 + height * radius) == pytest.approx(2 * math.pi * across, rel=1e-6)


@given(radius=sizes, half=sizes, height=st.floats(-0.9, 0.9))
def test_a_lying_capsule_is_cut_in_stadiums(radius, half, height):
    """Perimeter 2 pi r + 4 h, breadth 2 (r + h), with the radius at that height."""
    trunk = solids(("capsule", (radius, half), (0, 0, 0), (90, 0, 0)))
    here = math.sqrt(1 - height**2) * radius
    assert trunk.girth(UP, height * radius) == pytest.approx(2 * math.pi * here + 4 * half, rel=1e-4)
    reach = trunk.section_reach(UP, height * radius, np.array([LEFT, -LEFT]))
    assert reach.sum() == pytest.approx(2 * (here + half), rel=1e-6)


def test_a_tape_spans_the_hollow_between_two_balls():
    pair = solids(("sphere", (0.1,), (0, -0.3, 0), (0, 0, 0)), ("sphere", (0.1,), (0, 0.3, 0), (0, 0, 0)))
    assert pair.girth(UP, 0.0) == pytest.approx(2 * math.pi * 0.1 + 4 * 0.3, rel=1e-4)


def test_solids_that_the_plane_misses_do_not_count():
    low, high = ("sphere", (0.1,), (0, 0, 0), (0, 0, 0)), ("sphere", (0.5,), (0, 0, 2), (0, 0, 0))
    assert solids(low, high).girth(UP, 0.0) == pytest.approx(solids(low).girth(UP, 0.0))


def test_an_ellipsoid_is_cut_in_ellipses():
    """Ramanujan's approximation of its perimeter is good to 1e-5 here."""
    a, b = 0.08, 0.06
    head = solids(("ellipsoid", (a, b, 0.1), (0, 0, 0), (0, 0, 0)))
    h = ((a - b) / (a + b)) ** 2
    perimeter = math.pi * (a + b) * (1 + 3 * h / (10 + math.sqrt(4 - 3 * h)))
    assert head.girth(UP, 0.0) == pytest.approx(perimeter, rel=1e-5)
