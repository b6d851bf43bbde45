import pytest

from mimoc.body import anatomy
from mimoc.body.strength import MOTOR_GROUPS, motors

GEOMS = {geom.name for parts, _ in anatomy.GROUPS for part in parts for geom in part.geoms}
HINGES = {joint.name for parts, _ in anatomy.GROUPS for part in parts for joint in part.joints}
AT_18_MONTHS = motors(dict.fromkeys(GEOMS, 1.0))


def test_motors_move_hinges_and_grow_with_geoms_that_exist():
    for figures in (figures for group, _ in MOTOR_GROUPS for figures in group):
        assert figures.joint in HINGES, figures.name
        assert figures.mover in GEOMS, figures.name


def test_no_joint_has_two_motors():
    assert len({motor.joint for motor in AT_18_MONTHS}) == len(AT_18_MONTHS) == 44


@pytest.mark.parametrize("geom", sorted(GEOMS))
def test_a_gear_grows_with_its_mover_and_with_nothing_else(geom):
    grown = motors({**dict.fromkeys(GEOMS, 1.0), geom: 2.0})
    for before, after in zip(AT_18_MONTHS, grown, strict=True):
        moved = before.mover.replace("left", "{side}").replace("right", "{side}") == geom
        assert after.gear_nm == before.gear_nm * (2 if moved else 1), before.name


def test_force_ranges_do_not_grow():
    grown = motors(dict.fromkeys(GEOMS, 0.3))
    assert [motor.force_range for motor in grown] == [motor.force_range for motor in AT_18_MONTHS]
