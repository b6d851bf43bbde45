"""A body that matures: what it is at 18 months, and how it gets there."""

from itertools import pairwise

import pytest
from support.papers_law import by_volume

from mimoc.body.anatomy import assemble
from mimoc.body.grow import grow_average, grow_tree
from mimoc.body.joints import NEWBORN_FIST_DEG
from mimoc.fits import measure

AGES_MONTHS = (0, 0.5, 1, 1.5, 2, 3, 4, 5, 6, 7.5, 9, 10.5, 12, 14, 16, 18)
CHEST = {"mitten": False, "five_finger": True}
BODIES = tuple(CHEST.items())
PASSIVE = ("stiffness_nm_per_rad", "damping_nms_per_rad", "frictionloss_nm", "armature_kgm2")
LENGTHS = {0: 0.626, 1: 0.666, 2: 0.702, 3: 0.733, 6: 0.811, 9: 0.871, 12: 0.921, 15: 0.963, 18: 1, 24: 1.061}


@pytest.fixture(scope="module", params=BODIES)
def anatomy(request):
    return assemble(*request.param)


@pytest.fixture(scope="module")
def bodies(anatomy):
    """Return the average child by age."""
    return {age: grow_average(age, anatomy) for age in (*AGES_MONTHS, 24)}


def of_neck(name: str) -> bool:
    return "head" in name


def test_at_18_months_motors_and_joints_are_mimos_except_that_the_neck_bears_a_heavier_head(bodies, anatomy):
    maturing = bodies[18]
    assert maturing.growth is not None
    gain = maturing.growth.head_gain
    for ours, (_, mimos) in zip(maturing.motors, anatomy.motors, strict=True):
        assert ours.gear_nm == (mimos.gear_nm * gain if of_neck(ours.name) else mimos.gear_nm), ours.name
        assert ours.force_range == mimos.force_range
    published = grow_average(18, assemble(anatomy.hands, CHEST[anatomy.hands], "published"))
    for name, mimos in published.joints.items():
        ours = maturing.joints[name]
        assert (ours.range_deg, ours.springref_deg) == (mimos.range_deg, mimos.springref_deg), name
        for attribute in PASSIVE:
            factor = gain if of_neck(name) else 1
            assert getattr(ours, attribute) == pytest.approx(getattr(mimos, attribute) * factor, rel=1e-15), name
            assert factor != 1 or getattr(ours, attribute) == getattr(mimos, attribute), name


@pytest.mark.parametrize("age_months", LENGTHS)
def test_strength_follows_length_besides_volume(bodies, anatomy, age_months):
    """Of the eyes, whose strength does not mature otherwise."""
    maturing = bodies.get(age_months) or grow_average(age_months, anatomy)
    usual_nm = by_volume(measure(age_months), anatomy).gears_nm
    eyes = [motor.gear_nm / usual_nm[motor.name] for motor in maturing.motors if "eye" in motor.name]
    assert eyes == pytest.approx([LENGTHS[age_months]] * 6, abs=0.0006)


def test_every_torque_grows_with_age(bodies):
    for younger, older in pairwise(sorted(bodies)):
        for before, after in zip(bodies[younger].motors, bodies[older].motors, strict=True):
            assert all(
                abs(weak) * before.gear_nm < abs(strong) * after.gear_nm
                for weak, strong in zip(before.force_range, after.force_range, strict=True)
            ), (before.name, older)


def test_strength_relative_to_load_grows_with_age(bodies):
    """The load of a joint grows by volume x length, that of the neck with the mass of the head besides."""
    for younger, older in pairwise(AGES_MONTHS):
        young, old = bodies[younger], bodies[older]
        assert young.growth is not None
        assert old.growth is not None
        for before, after in zip(young.motors, old.motors, strict=True):
            weak, strong = (
                motor.gear_nm
                / (growth.relative_volumes[motor.joint] * growth.relative_length)
                / (growth.head_gain if of_neck(motor.name) else 1)
                for motor, growth in ((before, young.growth), (after, old.growth))
            )
            assert weak < strong if "eye" not in before.name else weak == pytest.approx(strong), (before.name, older)


def test_the_front_of_the_neck_matures_apart_from_its_back(bodies):
    at_six = next(motor for motor in bodies[6].motors if motor.name == "act:head_tilt")
    low, high = at_six.force_range
    assert low == -1
    assert high == pytest.approx(0.55 * 0.69 / 0.62, rel=0.02)


@pytest.mark.parametrize(
    ("joint", "upper_deg"),
    {
        "hip1": (-32, -22, -17, -6, 3, 10, 20),
        "knee": (-21, -13, -10, -4, 0, 2, 4),
        "elbow": (-19, -7, -4, 2, 4, 5, 5),
    }.items(),
)
def test_newborns_do_not_straighten_their_joints(bodies, joint, upper_deg):
    found = [bodies[age].joints[f"robot:left_{joint}"].range_deg[1] for age in (0, 2, 3, 6, 9, 12, 18)]
    assert found == pytest.approx(upper_deg, abs=0.6)


def test_newborns_bend_their_ankles_up_rather_than_down(bodies):
    ranges = [bodies[age].joints["robot:right_foot1"].range_deg for age in (0, 6, 18)]
    assert ranges[0] == (-26, 59)
    assert ranges[2] == (-63, 32)
    assert ranges[0][0] > ranges[1][0] > ranges[2][0]
    assert ranges[0][1] > ranges[1][1] > ranges[2][1]


def test_joints_rest_where_tone_bends_them_and_within_their_range(bodies):
    for maturing in bodies.values():
        assert all(
            joint.range_deg[0] <= joint.springref_deg <= joint.range_deg[1] for joint in maturing.joints.values()
        )
    newborn, month = bodies[0].joints, bodies[1].joints
    for name, rest_deg in NEWBORN_FIST_DEG.items():
        joint = name.format(side="left")
        if joint in newborn:
            assert newborn[joint].springref_deg == rest_deg
            assert abs(month[joint].springref_deg) < abs(rest_deg)


def test_passive_joints_grow_with_age_except_those_that_lose_their_tone(bodies):
    for younger, older in pairwise(AGES_MONTHS):
        before, after = bodies[younger].joints, bodies[older].joints
        for name in before:
            for attribute in PASSIVE[1:]:
                small, large = getattr(before[name], attribute), getattr(after[name], attribute)
                assert small < large or small == large == 0, (name, attribute, older)
            if "elbow" not in name:
                assert before[name].stiffness_nm_per_rad < after[name].stiffness_nm_per_rad, (name, older)


def test_heads_are_heavier_by_a_nearly_constant_factor(bodies):
    gains = [maturing.growth.head_gain for maturing in bodies.values()]
    assert gains == pytest.approx([1.45] * len(gains), rel=0.02)


def test_a_taller_child_is_stronger_by_its_length_besides_its_volume(anatomy):
    average = measure(9)
    tall = average.scaled(dict.fromkeys(average, 1.1), "", ())
    for before, after in zip(grow_tree(average, anatomy).motors, grow_tree(tall, anatomy).motors, strict=True):
        assert after.gear_nm == pytest.approx(before.gear_nm * 1.1**4, rel=0.1), before.name
