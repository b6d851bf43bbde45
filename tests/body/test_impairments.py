"""What impairments make of a body: weaker, narrower, floppier or spastic, and of no other part."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import mimoc
from mimoc.base.errors import SpecError
from mimoc.body.grow import grow_body
from mimoc.body.impairments import REFLEX, THRESHOLD_RAD_S
from mimoc.compiler.child import child_of
from mimoc.compiler.explain import entries_of
from mimoc.compiler.measuring import compile_infant
from mimoc.fits import load_tables
from mimoc.fits.standards import mean_fat_percent
from mimoc.schema.names import REGIONS, place_of
from mimoc.studies.milestones.trial import Conditions, compile_at, slackened
from mimoc.studies.movement.posture import THIGHS_LEVEL_DEG, swing


def infant(age_months=9.0, actuation=None, **impairments) -> mimoc.InfantSpec:
    data = {"mimoc": 1, "name": "kim", "age_months": age_months, "actuation": actuation or {}}
    return mimoc.InfantSpec.model_validate({**data, **({"impairments": impairments} if impairments else {})})


def tree(**keys):
    return child_of(infant(**keys)).tree


@settings(max_examples=15)
@given(st.sampled_from(sorted(REGIONS)), st.floats(0.01, 1), st.floats(0, 24))
def test_weakness_is_of_its_region_and_of_no_other(region, share, age):
    weak, usual = tree(age_months=age, weakness={region: share}), tree(age_months=age)
    for motor, before in zip(weak.motors, usual.motors, strict=True):
        factor = share if place_of(motor.joint) in REGIONS[region] else 1.0
        assert motor.gear_nm == pytest.approx(factor * before.gear_nm)
    assert weak.bodies == usual.bodies


def test_of_two_regions_the_smaller_counts():
    weak, usual = tree(weakness={"right_side": 0.5, "right_hand": 0.1}), tree()
    gears = {
        motor.name: motor.gear_nm / before.gear_nm for motor, before in zip(weak.motors, usual.motors, strict=True)
    }
    assert gears["act:right_elbow"] == pytest.approx(0.5)
    assert gears["act:right_fingers"] == pytest.approx(0.1)
    assert gears["act:left_elbow"] == 1


def test_muscles_and_servos_are_weaker_too():
    for model in ("muscle", "position"):
        weak = compile_infant(infant(actuation={"model": model}, weakness={"right_arm": 0.05}))
        usual = compile_infant(infant(actuation={"model": model}))
        elbow = [index for index in range(usual.nu) if "right_elbow" in usual.actuator(index).name]
        strength = weak.actuator_biasprm[elbow, 2] if model == "muscle" else weak.actuator_forcerange[elbow, 1]
        before = usual.actuator_biasprm[elbow, 2] if model == "muscle" else usual.actuator_forcerange[elbow, 1]
        assert strength == pytest.approx(0.05 * before, rel=1e-5)


@given(st.floats(-140, -30), st.floats(5, 60))
def test_a_contracture_leaves_what_is_within_the_range_of_the_age(low, width):
    asked = low, low + width
    joint = tree(range={"left_elbow": asked}).joints["robot:left_elbow"]
    healthy = tree().joints["robot:left_elbow"]
    assert joint.range_deg == (max(asked[0], healthy.range_deg[0]), min(asked[1], healthy.range_deg[1]))
    assert joint.range_deg[0] <= joint.springref_deg <= joint.range_deg[1]
    assert tree(range={"left_elbow": asked}).joints["robot:right_elbow"] == tree().joints["robot:right_elbow"]


def test_a_contracture_that_leaves_nothing_is_refused_at_its_key():
    with pytest.raises(SpecError, match=r"impairments\.range\.left_knee: a healthy child of this age.*leaves nothing"):
        mimoc.build(infant(range={"left_knee": [20, 40]}))


@pytest.mark.parametrize("pose", ["supine", "sitting", "standing"])
def test_the_start_respects_a_contracture(pose):
    spec = infant(range={"left_elbow": [-90, -40], "right_hip_flexion": [-110, -30]}).with_(scene={"pose": pose})
    env = mimoc.make(spec)
    env.reset(seed=0)
    model, data = env.unwrapped.model, env.unwrapped.data
    for joint in ("robot:left_elbow", "robot:right_hip1"):
        low, high = model.joint(joint).range
        assert low - 1e-6 <= data.joint(joint).qpos[0] <= high + 1e-6


def test_hypotonic_newborns_lie_less_flexed():
    floppy, usual = tree(age_months=0, tone={"body": {"kind": "hypotonic", "gain": 0.2}}), tree(age_months=0)
    for motor, before in zip(floppy.motors, usual.motors, strict=True):
        if before.tone and place_of(motor.joint) != "eyes":
            assert motor.tone.stiffness_nm_per_rad == pytest.approx(0.2 * before.tone.stiffness_nm_per_rad)
    knee = floppy.joints["robot:left_knee"].stiffness_nm_per_rad
    assert knee == pytest.approx(0.2 * usual.joints["robot:left_knee"].stiffness_nm_per_rad)


@given(st.floats(22, 41))
def test_the_earlier_a_child_is_born_the_less_newborn_tone_it_has_at_term(weeks):
    early = max(0.0, 40 - weeks) * 7 / 30.4375 if weeks < 37 else 0.0
    born = tree(age_months=early + 1e-9, gestation_weeks=weeks)
    tone, usual = (
        next(motor.tone.stiffness_nm_per_rad for motor in body.motors if motor.name == "act:left_knee")
        / body.joints["robot:left_knee"].stiffness_nm_per_rad  # Which is less in smaller children.
        for body in (born, tree(age_months=1e-9))
    )
    expected = 1 - 0.5 * min(max(37 - weeks, 0) / 12, 1)
    assert tone / usual == pytest.approx(expected, abs=1e-3)


def test_a_preterm_child_has_the_body_and_the_senses_of_its_corrected_age():
    keys = {"senses": {"vision": {}, "proprioception": {}}, "delays": {"preset": "physiological"}}
    early = mimoc.build(infant(gestation_weeks=32).with_(**keys)).manifest
    spec = infant(age_months=infant(gestation_weeks=32).corrected_age_months).with_(**keys)
    term = mimoc.build(spec).manifest
    assert early.child.age_months == 9
    assert early.child.months_early == pytest.approx(8 * 7 / 30.4375)
    assert early.senses.vision.acuity_cpd == pytest.approx(term.senses.vision.acuity_cpd)
    assert early.delays == term.delays


SIZES = ("length_cm", "weight_kg", "head_circumference_cm")


def z_scores(spec) -> dict[str, float]:
    child = mimoc.build(spec).manifest.child
    who = load_tables().who
    return {key: who[key].z_score(getattr(child, key), child.corrected_age_months, "mean") for key in SIZES}


def smaller_by(weeks: float, since_term: float, **keys) -> list[float]:
    """Return by how many standard deviations a child born early is smaller than one born at term."""
    early = infant(gestation_weeks=weeks)
    born, term = (
        z_scores(spec.with_(age_months=age, **keys))
        for spec, age in ((early, early.months_early + since_term), (infant(), since_term))
    )
    return [born[key] - term[key] for key in SIZES]


def test_a_child_born_early_is_smaller_at_term_and_catches_up_to_24_months():
    """Born at 30 weeks: 3.8 cm, 570 g and a head of 1 cm less (Johnson et al. 2011): 2, 1.3 and .8 SD."""
    assert smaller_by(30, 1e-6) == pytest.approx([-2.0, -1.3, -0.8], abs=0.02)
    assert smaller_by(30, 10.85) == pytest.approx([-0.5, -0.325, -0.2], abs=0.02)
    assert smaller_by(30, 24 - 10 / (30.4375 / 7)) == pytest.approx([0, 0, 0], abs=0.01)


def test_the_earlier_a_child_is_born_the_smaller_it_is_at_term():
    lengths = [smaller_by(weeks, 0.01)[0] for weeks in (22, 26, 30, 34, 36.9)]
    assert lengths == sorted(lengths)
    assert lengths[0] > -3
    assert lengths[-1] == pytest.approx(0, abs=0.05)


@pytest.mark.parametrize("weeks", [37, 40, 42])
def test_a_child_born_at_term_has_the_same_bytes(weeks):
    files, usual = (
        mimoc.build(spec).files for spec in (infant(age_months=1, gestation_weeks=weeks), infant(age_months=1))
    )
    assert files["infant.xml"] == usual["infant.xml"]


def test_sizes_that_a_spec_gives_count_for_a_child_born_early():
    born = infant(age_months=6, gestation_weeks=30).with_(
        body={"individual": {"sex": "female", "length_percentile": 50, "weight_percentile": 50}}
    )
    child = mimoc.build(born).manifest.child
    length = load_tables().who["length_cm"].z_score(child.length_cm, child.corrected_age_months, "female")
    assert length == pytest.approx(0, abs=0.01)


def test_what_a_spec_does_not_give_of_a_child_born_early_has_the_proportions_of_children_born_as_early():
    """Its head is large for its length, so that one with an average head is shorter than the average child."""
    early = infant(age_months=2.4, gestation_weeks=30)
    usual, with_head = (
        mimoc.build(spec).manifest.child
        for spec in (early, early.with_(body={"individual": {"sex": "female", "head_percentile": 50}}))
    )
    ratio = with_head.head_circumference_cm / usual.head_circumference_cm
    assert with_head.length_cm / usual.length_cm == pytest.approx(ratio, abs=2e-3)
    assert with_head.length_cm < 48


def test_a_child_born_early_is_fatter_at_term():
    """By 3 % of its weight (Johnson et al. 2012); strength goes with what is lean."""
    early = infant(gestation_weeks=30)
    grown = grow_body(early.with_(age_months=early.months_early + 1e-9)).tree.growth
    usual = mean_fat_percent(0)
    assert grown.lean_gain == pytest.approx((100 - usual - 3) / (100 - usual), abs=1e-4)
    assert grown.lean_keys == ("spec.impairments.gestation_weeks",)
    assert grow_body(early.with_(age_months=early.months_early + 3.01)).tree.growth.lean_gain == 1
    leaner = early.with_(age_months=3, body={"individual": {"fat_percent": 12}})
    assert grow_body(leaner).tree.growth.lean_keys == ("spec.body.individual.fat_percent",)


def test_growing_counts_from_birth():
    env = mimoc.make(infant(age_months=4, gestation_weeks=30))
    env.reset(seed=0)
    before_cm = env.unwrapped.manifest.child.length_cm
    env.unwrapped.grow(to=6)
    child = env.unwrapped.manifest.child
    assert (child.age_months, child.corrected_age_months) == (6, pytest.approx(6 - 10 * 7 / 30.4375))
    assert child.length_cm > before_cm


SPASTIC = {"tone": {"knees": {"kind": "spastic", "gain": 1}}}


def test_a_stretch_reflex_answers_the_speed_of_the_joint_beyond_its_threshold():
    model = compile_infant(infant(**SPASTIC))
    data = mujoco.MjData(model)
    dof = int(model.joint("robot:left_knee").dofadr[0])
    torque = {}
    for speed in (-8.0, -2.0, -0.5, 0.0, 0.5, 2.0, 8.0):
        data.qvel[dof] = speed
        mujoco.mj_forward(model, data)
        ids = [model.actuator(f"reflex:left_knee_{way}").id for way in ("negative", "positive")]
        torque[speed] = float(data.actuator_force[ids].sum())
    slope = REFLEX * model.dof_damping[dof]
    assert torque[0.0] == torque[0.5] == torque[-0.5] == 0
    assert torque[2.0] == pytest.approx(-slope * (2 - THRESHOLD_RAD_S), rel=1e-4)
    assert torque[-2.0] == pytest.approx(slope * (2 - THRESHOLD_RAD_S), rel=1e-4)
    strength = model.actuator("act:left_knee").gear[0] * model.actuator("act:left_knee").forcerange
    assert strength[0] <= torque[8.0] < torque[2.0] < 0 < torque[-2.0] < torque[-8.0] <= strength[1] + 1e-9


@pytest.mark.parametrize("age", [3, 18])
def test_spastic_knees_catch_in_the_pendulum_test(age):
    """Healthy ones swing through (index 1.6); spastic ones hardly beyond where they come to rest, and fewer times."""
    healthy, spastic = (
        swing(compile_at(slackened(infant(age, **keys)), age, Conditions()), "left_knee", 0.0, THIGHS_LEVEL_DEG)
        for keys in ({}, SPASTIC)
    )
    assert healthy.index > 1.5
    assert spastic.index < 1.3
    assert spastic.swings < healthy.swings
    assert spastic.rest_deg == pytest.approx(healthy.rest_deg, abs=1.0)


def test_reflexes_take_no_commands_and_change_no_spaces():
    spastic, usual = mimoc.make(infant(**SPASTIC)), mimoc.make(infant())
    assert spastic.action_space == usual.action_space
    assert spastic.unwrapped.model.nu == usual.unwrapped.model.nu + 4
    observation, _ = spastic.reset(seed=0)
    for _ in range(20):
        observation, *_ = spastic.step(spastic.action_space.sample())
    assert all(np.isfinite(values).all() for values in observation.values())


def test_mimos_code_gets_no_reflexes():
    with pytest.raises(SpecError, match="stretch reflexes"):
        mimoc.build(infant(**SPASTIC), target="mimo3")


def test_every_changed_number_names_the_key_that_changed_it():
    entries = entries_of(
        mimoc.build(
            infant(
                age_months=4.0,
                weakness={"right_arm": 0.05},
                tone={"knees": {"kind": "spastic"}, "trunk": {"kind": "hypotonic"}},
                range={"left_elbow": [-90, -20]},
            )
        )
    )
    expected = {
        "actuator.act:right_elbow.gear": "spec.impairments.weakness.right_arm",
        "joint.robot:left_elbow.range": "spec.impairments.range.left_elbow",
        "actuator.reflex:left_knee_positive.biasprm": "spec.impairments.tone.knees.kind",
        "joint.robot:hip_bend1.stiffness": "spec.impairments.tone.trunk.kind",
    }
    for key, source in expected.items():
        assert source in entries[key]["from"], key
    assert math.isclose(entries["spec.impairments.weakness.right_arm"]["value"], 0.05)


def test_a_bundle_notes_what_differs_from_a_healthy_child():
    (note,) = mimoc.build(infant(preset="brachial_plexus_palsy", side="left", acuity={})).manifest.notes
    assert note.startswith("differs from a healthy child (brachial_plexus_palsy, left): weakness left_shoulder 0.28")
    assert mimoc.build(infant()).manifest.notes == ()


def test_what_eyes_lose_has_no_effect_without_vision():
    notes = mimoc.build(infant(acuity={"eyes": 0.5})).manifest.notes
    assert "'impairments.acuity' has no effect: senses.vision is off" in notes


def test_how_early_a_child_was_born_is_explained():
    for impairments, key in (({"gestation_weeks": 32}, "gestation_weeks"), ({"preset": "preterm"}, "preset")):
        entries = entries_of(mimoc.build(infant(**impairments)))
        assert entries["child.months_early"]["from"] == [f"spec.impairments.{key}"]
        size = entries["measurements.crown_sole_length_cm"]
        assert f"spec.impairments.{key}" in size["from"]
        assert "Johnson et al. 2011" in size["rule"]
