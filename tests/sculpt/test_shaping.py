"""Meshes for the looks of toys."""

import math

import numpy as np
import pytest
from toys.shaping import ball, board, box, egg, frustum, lathe, plate, ring, rod, tube
from toys.transforms import flatten_below, mirror, move, stretch, turn

from mimoc.compiler.toys.shape import join

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
