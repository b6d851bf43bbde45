"""Volumes, areas, reaches, depths, sections and nearest points of primitives."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.special import ellipe, elliprg

from mimoc.base.geometry.primitives import (
    Solids,
    area,
    depths,
    ellipse_perimeter,
    ellipsoid_area,
    extents,
    girth,
    nearest_points,
    outward,
    volume,
)
from mimoc.base.geometry.rotations import matrix_from_euler

SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}  # How many numbers each kind has.
lengths = st.floats(0.02, 0.2)
primitives = st.sampled_from(sorted(SIZES)).flatmap(
    lambda kind: st.tuples(st.just(kind), st.tuples(*[lengths] * SIZES[kind]))
)
units = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.01)
units = units.map(lambda v: np.array(v) / np.linalg.norm(v))

DIAGONAL = 1 / np.sqrt(3)
REACHES = {
    "a ball, its radius": ("sphere", (0.1,), (1, 0, 0), 0.1),
    "a capsule, its axis and cap": ("capsule", (0.1, 0.3), (0, 0, 1), 0.4),
    "a capsule across, its radius": ("capsule", (0.1, 0.3), (1, 0, 0), 0.1),
    "a cylinder, its axis": ("cylinder", (0.1, 0.3), (0, 0, -1), 0.3),
    "a cylinder across, its radius": ("cylinder", (0.1, 0.3), (0, 1, 0), 0.1),
    "a cylinder at a slant, its rim": ("cylinder", (0.1, 0.3), (0.6, 0, 0.8), 0.3),
    "an ellipsoid, its half axis": ("ellipsoid", (0.1, 0.2, 0.3), (0, -1, 0), 0.2),
    "a box, its corner": ("box", (0.1, 0.2, 0.3), (DIAGONAL, -DIAGONAL, DIAGONAL), 0.6 * DIAGONAL),
}


@pytest.mark.matrix
@pytest.mark.parametrize("kind", SIZES)
@given(data=st.data())
def test_volumes_are_mujocos(kind, data):
    size_m = data.draw(st.tuples(*[lengths] * SIZES[kind]))
    written = " ".join(map(repr, size_m))
    xml = f'<mujoco><worldbody><body><geom type="{kind}" size="{written}" density="1"/></body></worldbody></mujoco>'
    assert volume(kind, size_m) == pytest.approx(mujoco.MjModel.from_xml_string(xml).body_mass[1])


@pytest.mark.parametrize("kind", ["sphere", "capsule"])
@given(data=st.data())
def test_what_is_round_has_the_area_that_its_volume_grows_by(kind, data):
    """By its radius: the thin shell around it has its area times the thickness."""
    size = data.draw(st.tuples(*[lengths] * SIZES[kind]))
    thin = 1e-6 * size[0]
    shell = volume(kind, (size[0] + thin, *size[1:])) - volume(kind, size)
    assert area(kind, size) == pytest.approx(shell / thin, rel=1e-4)


@pytest.mark.parametrize(
    ("kind", "size", "wanted"),
    [
        ("box", (0.5, 0.5, 1.0), 10),
        ("sphere", (1.0,), 4 * np.pi),
        ("cylinder", (1.0, 0.5), 4 * np.pi),
        ("capsule", (1.0, 0.5), 6 * np.pi),
    ],
)
def test_the_area_is_that_of_sides_and_ends(kind, size, wanted):
    assert area(kind, size) == pytest.approx(wanted)


@pytest.mark.parametrize("case", REACHES)
def test_a_primitive_reaches(case):
    kind, size, direction, wanted = REACHES[case]
    assert extents([(kind, size)]).along(np.array(direction, float)) == pytest.approx([wanted])


@given(primitive=primitives, direction=units)
def test_mujoco_finds_a_primitive_to_reach_as_far(primitive, direction):
    """A plate across the direction, a millimetre beyond the reach, is a millimetre away."""
    kind, size = primitive
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><geom type="{kind}" size="{" ".join(map(repr, size))}"/><body><freejoint/>'
        '<geom name="plate" type="box" size="1 1 .001" mass="1"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    (reach,) = extents([primitive]).along(direction)
    data.qpos[:3] = (reach + 0.002) * direction
    mujoco.mju_quatZ2Vec(data.qpos[3:7], direction)
    mujoco.mj_kinematics(model, data)
    gap = mujoco.mj_geomDistance(model, data, 0, 1, 1.0, None)
    assert gap == pytest.approx(0.001, abs=2e-5)


@given(one=primitives, other=primitives, direction=units)
def test_several_reach_as_far_as_each_does_alone(one, other, direction):
    alone = [extents([each]).along(direction)[0] for each in (one, other)]
    assert extents([one, other]).along(np.stack([direction, direction])) == pytest.approx(alone)


@given(primitive=primitives, direction=units, share=st.floats(0.05, 0.95))
def test_a_point_inside_is_as_deep_as_the_way_out_is_long(primitive, direction, share):
    """Its way out ends on the surface, at right angles to it: beyond, the depth falls as the distance grows."""
    kind, size = primitive
    far = direction * extents([primitive]).along(direction)
    inside = far * share
    (depth,) = depths(kind, size, inside[None])
    if depth <= 1e-6:
        return
    (out,) = outward(kind, size, inside[None])
    assert np.linalg.norm(out) == pytest.approx(1)
    assert depths(kind, size, (inside + depth * out)[None]) == pytest.approx(0, abs=1e-12)
    assert depths(kind, size, (inside + (depth + 0.01) * out)[None]) == pytest.approx(-0.01, abs=1e-12)


@pytest.mark.parametrize("kind", sorted(SIZES))
def test_the_middle_has_a_way_out_too(kind):
    size = (0.1, 0.2, 0.3)[: SIZES[kind]]
    (out,) = outward(kind, size, np.zeros((1, 3)))
    assert np.linalg.norm(out) == pytest.approx(1)
    assert depths(kind, size, 0.1 * out[None]) == pytest.approx(0, abs=1e-12)


@given(primitives, units)
def test_the_farthest_point_is_as_far_as_a_primitive_reaches(primitive, direction):
    found = extents([primitive])
    point = found.farthest(direction[None])[0]
    assert point @ direction == pytest.approx(found.along(direction[None])[0])


UP, LEFT = np.eye(3)[2], np.eye(3)[1]
sizes = st.floats(0.02, 0.2)


def solids(*primitives) -> Solids:
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


long = st.floats(0.5, 1.0)
half_axes = st.tuples(long, long, long)
coordinates = st.one_of(st.just(0.0), st.floats(-2, 2))
points = st.tuples(coordinates, coordinates, coordinates).map(np.array)


@given(short=long)
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
