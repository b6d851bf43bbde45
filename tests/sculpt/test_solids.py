"""Convex shapes that toys touch with."""

import math

import mujoco
import numpy as np
import pytest
from toys.shaping import ball
from toys.solids import block, capsule, cylinder, ellipsoid, hoop, sphere, turned, wall

from mimoc.compiler.toys.shape import Mesh, Solid, bounds, solid_volume

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
