"""A body that matures: what it is at 18 months, and how it gets there."""

import re
from itertools import pairwise

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from support.segment_masses import by_volume

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_average, grow_tree
from mimoc.body.joints import MIN_ARMATURE_KGM2, NEWBORN_FIST_DEG, RELAXED
from mimoc.body.maturation import FINGERS, Decay
from mimoc.compiler.measuring import compile_infant
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
    return {age: grow_average(age, anatomy) for age in (*AGES_MONTHS, 24)}


def of_neck(name: str) -> bool:
    return "head" in name


def closes_hand(joint: str) -> bool:
    return re.sub("left|right", "{side}", joint) in FINGERS


def test_at_18_months_motors_are_mimos_but_for_heavier_heads_horizontal_flexion_and_middle_joints(bodies, anatomy):
    maturing = bodies[18]
    assert maturing.growth is not None
    for ours, (_, mimos) in zip(maturing.motors, anatomy.motors, strict=True):
        factor = maturing.growth.head_gain if of_neck(ours.name) else 3.0 if "horizontal" in ours.name else 1.0
        factor = 1.8 if ours.name.endswith("f_middle") else factor
        assert ours.gear_nm == mimos.gear_nm * (1.0 if "eye" in ours.name else factor), ours.name
        assert ours.force_range == mimos.force_range
        assert ours.tone is None


def test_at_18_months_joints_that_do_not_swing_are_mimos_but_for_eyes_fingers_toes_and_friction(bodies, anatomy):
    published = grow_average(18, assemble(anatomy.hands, CHEST[anatomy.hands], "published"))
    for name, mimos in published.joints.items():
        ours = bodies[18].joints[name]
        assert ours.frictionloss_nm == 0
        if re.sub("left|right", "{side}", name) in RELAXED or closes_hand(name) or "eye" in name:
            continue
        assert (ours.range_deg, ours.springref_deg) == (mimos.range_deg, mimos.springref_deg), name
        for attribute in ("stiffness_nm_per_rad", "damping_nms_per_rad"):
            assert getattr(ours, attribute) == getattr(mimos, attribute), name
        assert ours.armature_kgm2 == max(mimos.armature_kgm2, MIN_ARMATURE_KGM2), name


@pytest.mark.parametrize("age_months", [0, 3, 6, 18])
def test_relaxed_limbs_swing_freely_at_every_age(age_months):
    """Damping ratios of .1 to .15 at hips, knees, shoulders and elbows that hang; the neck's are .25 to .4."""
    infant = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": age_months})
    model = compile_infant(infant)
    data, inertia = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    data.qpos[3] = 1.0
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, inertia)
    for pattern, relaxed in RELAXED.items():
        joint = model.joint(pattern.format(side="left"))
        dof, body = joint.dofadr[0], int(model.jnt_bodyid[joint.id])
        arm_m, axis = data.subtree_com[body] - data.xanchor[joint.id], data.xaxis[joint.id]
        weight_nm = model.body_subtreemass[body] * 9.81 * np.linalg.norm(arm_m - axis * (arm_m @ axis))
        ratio = model.dof_damping[dof] / 2 / np.sqrt((joint.stiffness[0] + weight_nm) * inertia[dof, dof])
        if pattern.endswith(("hip1", "hip2", "knee", "ad_ab", "elbow")):
            assert 0.08 < ratio < 0.2, pattern
        if age_months == 18:
            assert weight_nm < 1.02 * relaxed.weight_nm * (1.46 if "head" in pattern else 1.0), pattern


@pytest.mark.parametrize("age_months", LENGTHS)
def test_strength_of_eyes_follows_their_inertia(bodies, anatomy, age_months):
    """By volume and the square of the length."""
    maturing = bodies.get(age_months) or grow_average(age_months, anatomy)
    usual_nm = by_volume(measure(age_months), anatomy).gears_nm
    eyes = [motor.gear_nm / usual_nm[motor.name] for motor in maturing.motors if "eye" in motor.name]
    assert eyes == pytest.approx([LENGTHS[age_months] ** 2] * 6, abs=0.0012)


def test_every_torque_grows_with_age_but_that_of_newborns_grasp(bodies):
    for younger, older in pairwise(sorted(bodies)):
        for before, after in zip(bodies[younger].motors, bodies[older].motors, strict=True):
            assert closes_hand(before.joint) or all(
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
            assert weak < strong or closes_hand(before.joint), (before.name, older)


def test_newborns_grasp_six_times_as_hard_as_the_law_of_hands_has_it(bodies):
    newborn, grown = (
        {motor.joint: motor.gear_nm for motor in bodies[age].motors if closes_hand(motor.joint)} for age in (0, 18)
    )
    growth = bodies[0].growth
    for joint, gear_nm in newborn.items():
        usual_nm = grown[joint] * growth.relative_volumes[joint] * growth.relative_length * 0.4
        assert gear_nm == pytest.approx(6 * usual_nm), joint


def test_tone_is_newborns_and_is_lost(bodies):
    """Of hips, knees, elbows, ankles and hands; half a year later there is none to speak of."""
    tones = {age: {m.joint: m.tone.stiffness_nm_per_rad for m in bodies[age].motors if m.tone} for age in (0, 3, 6)}
    assert {"robot:left_hip1", "robot:right_knee", "robot:left_elbow"} <= tones[0].keys() == tones[6].keys()
    for joint, stiffness in tones[0].items():
        assert stiffness > tones[3][joint] > 5 * tones[6][joint]


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


def test_hands_rest_in_fists_and_joints_within_their_range(bodies):
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


def test_passive_joints_grow_with_the_fifth_power_of_height(bodies):
    """By volume and the square of the length, all alike, so that limbs of every age swing alike."""
    for younger, older in pairwise(AGES_MONTHS):
        before, after = bodies[younger].joints, bodies[older].joints
        for name in before:
            growth = [
                getattr(after[name], attribute) / getattr(before[name], attribute)
                for attribute in PASSIVE
                if getattr(after[name], attribute)
            ]
            assert min(growth) > 1, (name, older)
            assert growth == pytest.approx([growth[0]] * len(growth)), (name, older)


def test_heads_are_heavier_by_a_nearly_constant_factor(bodies):
    gains = [maturing.growth.head_gain for maturing in bodies.values()]
    assert gains == pytest.approx([1.45] * len(gains), rel=0.02)


def test_a_taller_child_is_stronger_by_its_length_besides_its_volume(anatomy):
    average = measure(9)
    tall = average.scaled(dict.fromkeys(average, 1.1), "", ())
    for before, after in zip(grow_tree(average, anatomy).motors, grow_tree(tall, anatomy).motors, strict=True):
        assert after.gear_nm == pytest.approx(before.gear_nm * 1.1**4, rel=0.1), before.name


decays = st.builds(Decay, st.floats(1, 20), st.floats(0.5, 3))
ages = st.floats(0, 24)


@given(decays)
def test_a_newborn_has_all_of_it_and_an_infant_of_18_months_nothing(decay):
    assert decay(0) == 1
    assert decay(18) == decay(18.5) == decay(24) == 0


@given(decays, ages, ages)
def test_it_only_fades(decay, one, other):
    younger, older = sorted((one, other))
    assert 0 <= decay(older) <= decay(younger) <= 1


def test_it_is_a_stretched_exponential_that_ends_at_18_months():
    assert Decay(12, 1)(6) == pytest.approx((0.60653 - 0.22313) / (1 - 0.22313), abs=1e-5)
