"""Meshes for the looks of toys."""

import math

import mujoco
import numpy as np
import pytest
from toys.shaping import (
    ball,
    board,
    box,
    egg,
    flatten_below,
    frustum,
    lathe,
    mirror,
    move,
    plate,
    ring,
    rod,
    stretch,
    tube,
    turn,
)
from toys.solids import block, capsule, cylinder, ellipsoid, hoop, sphere, turned, wall

from mimoc.compiler.toys import Mesh, Solid, bounds, join, solid_volume

SQUARE = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (box((1, 2, 3)), 6.0),
        (frustum((2, 2), (1, 1), 3, (0, 0, 0)), 7.0),
        (plate(SQUARE, 0.0, 0.5), 2.0),
        (board(SQUARE, 0.5), 2.0),
        (lathe([(1, 0), (1, 2)], segments=200), math.tau),
        (ball(1, segments=200, rows=100), math.tau * 2 / 3),
        (egg((1, 2, 3), segments=200, rows=100), math.tau * 4),
        (ring(2, 0.5, segments=200, corners=100), math.tau * 2 * math.pi * 0.25),
        (rod((0, 0, 0), (0, 3, 4), 0.1, segments=100), math.pi * 0.01 * 5),
    ],
)
def test_a_shape_holds_as_much_as_geometry_says(mesh, volume):
    assert mesh.volume == pytest.approx(volume, rel=0.03)


def test_a_cup_holds_nothing_but_its_walls():
    cup = lathe([(1, 0), (1, 2), (0.9, 2), (0.9, 0.1), (0, 0.1)], segments=200)
    assert cup.volume == pytest.approx(math.pi * (2 - 0.81 * 1.9), rel=0.01)


def test_a_bevel_takes_away_little_and_keeps_the_size():
    mesh = box((1, 1, 1), bevel=0.1)
    assert 0.9 < mesh.volume < 1
    np.testing.assert_allclose([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)], [[-0.5] * 3, [0.5] * 3])


def test_a_tube_keeps_its_thickness_around_a_bend():
    angles = np.linspace(0, math.pi, 30)
    bend = tube(np.column_stack([np.cos(angles), np.sin(angles), 0 * angles]), 0.1, segments=40)
    assert bend.volume == pytest.approx(math.pi * 0.01 * math.pi, rel=0.06)
    assert np.abs(bend.vertices[:, 2]).max() == pytest.approx(0.1, rel=0.01)


def test_moving_turning_and_mirroring_keep_the_volume():
    mesh = frustum((2, 1), (1, 1), 3, (1, 2, 3), lean=0.5)
    for other in (move(mesh, (1, 2, 3)), turn(mesh, "x", 40), turn(mesh, "y", 40), turn(mesh, "z", 40), mirror(mesh)):
        assert other.volume == pytest.approx(mesh.volume)
    assert stretch(mesh, (2, 2, 2)).volume == pytest.approx(8 * mesh.volume)
    assert join([mesh, mesh]).volume == pytest.approx(2 * mesh.volume)


def test_turns_are_counterclockwise():
    point = box((0.1, 0.1, 0.1), (1, 2, 3))
    for axis, expected in (("x", (1, -3, 2)), ("y", (3, 2, -1)), ("z", (-2, 1, 3))):
        np.testing.assert_allclose(turn(point, axis, 90).vertices.mean(axis=0), expected, atol=1e-9)


def test_what_is_pressed_ends_at_the_floor():
    mesh = flatten_below(ball(1), -0.5)
    assert mesh.vertices[:, 2].min() == -0.5
    assert 0 < mesh.volume < ball(1).volume


SOLIDS = [
    sphere(0.3, (1, 2, 3)),
    ellipsoid((0.1, 0.2, 0.3), (1, 0, 0)),
    capsule((0, 0, 0), (1, 2, 3), 0.2),
    capsule((0, 0, 1), (0, 0, -1), 0.2),
    cylinder((0, 1, 0), (0.5, 0, 0), 0.3),
    block((0.1, 0.2, 0.3), (0, 0, 1), turned((0.6, 0.0, 0.8), 50)),
]


@pytest.mark.parametrize("solid", SOLIDS)
def test_volume_and_place_are_those_of_mujoco(solid):
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><body><freejoint/><geom type="{solid.type}" density="1" size="{row(solid.size)}" '
        f'pos="{row(solid.pos)}" quat="{row(solid.quat)}"/></body></worldbody></mujoco>'
    )
    assert model.body_mass[1] == pytest.approx(solid_volume(solid))
    np.testing.assert_allclose(np.mean(bounds(solid), axis=0), solid.pos)


def test_a_mesh_has_the_volume_within_it():
    """So the mass of a toy goes to its convex parts by their size."""
    mesh = Mesh(ball(0.5).vertices * (1, 2, 3), ball(0.5).faces)
    assert solid_volume(Solid("mesh", (), mesh=mesh)) == mesh.volume > 1


def test_a_capsule_reaches_beyond_its_ends_and_a_cylinder_does_not():
    start, end = (0.0, 0.0, 0.0), (0.0, 3.0, 4.0)
    np.testing.assert_allclose(bounds(capsule(start, end, 0.5)), [[-0.5, -0.5, -0.5], [0.5, 3.5, 4.5]], atol=1e-12)
    np.testing.assert_allclose(bounds(cylinder(start, end, 0.5)), [[-0.5, -0.4, -0.3], [0.5, 3.4, 4.3]], atol=1e-12)


def test_a_turned_block_reaches_as_far_as_its_corners():
    low, high = bounds(block((2.0, 2.0, 2.0), quat=turned((0.0, 0.0, 1.0), 45)))
    np.testing.assert_allclose(high, [math.sqrt(2), math.sqrt(2), 1])
    np.testing.assert_allclose(low, -high)


def test_a_wall_spans_its_heights_and_leans_outwards():
    boxes = wall(1.0, 0.1, 0.5, 2.0, flare=0.4)
    assert len(boxes) == 8
    for each in boxes:
        low, high = bounds(each)
        assert (low[2], high[2]) == pytest.approx((0.5, 2.0))
    assert max(bounds(each)[1][0] for each in boxes) == pytest.approx(1.2, abs=0.02)


def test_a_hoop_stands_on_those_that_lie_lower():
    ring = hoop(1.0, 0.2, (0.0, 0.0, 0.5), low=(0, 4))
    lowest = [bounds(each)[0][2] for each in ring]
    assert [number for number, height in enumerate(lowest) if height == min(lowest)] == [0, 4]


def row(numbers) -> str:
    return " ".join(map(str, numbers))
