"""What moves each joint, and with what its strength grows."""

import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.fits import measure

COUNTS = {("mitten", False): 44, ("mitten", True): 46, ("five_finger", False): 88, ("five_finger", True): 90}


@pytest.fixture(scope="module", params=COUNTS, ids=str)
def anatomy(request):
    return assemble(*request.param)


def test_motors_move_hinges_and_grow_with_geoms_that_exist(anatomy):
    hinges = {joint.name for _, part in anatomy.parts for joint in part.joints}
    for _, figures in anatomy.motors:
        assert figures.joint in hinges, figures.name
        assert figures.driven_geom in anatomy.geoms, figures.name


def test_no_joint_has_two_motors(hands_and_chest):
    motors = grow_tree(measure(18), assemble(*hands_and_chest)).motors
    assert len({motor.joint for motor in motors}) == len(motors) == COUNTS[hands_and_chest]


def test_a_gear_grows_with_its_mover_and_with_nothing_else(anatomy):
    """One part after another made thicker: between the square and the cube of it, less for parts that lie across."""
    before = grow_tree(measure(18), anatomy)
    for body in before.bodies:
        after = grow_tree(measure(18), anatomy, {body.name: (1.0, 1.1)})
        for motor, thicker in zip(before.motors, after.motors, strict=True):
            growth = thicker.gear_nm / motor.gear_nm
            if motor.driven_geom in {geom.name for geom in body.geoms}:
                assert 1.1**1.5 < growth < 1.1**3, (body.name, motor.name)
            else:
                assert growth == 1, (body.name, motor.name)


def test_force_ranges_do_not_grow(anatomy):
    young, old = grow_tree(measure(0), anatomy), grow_tree(measure(24), anatomy)
    assert [motor.force_range for motor in young.motors] == [motor.force_range for motor in old.motors]
