"""What infants of a few ages can do; the whole table is the command's, and the experiment's."""

from collections import deque
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.policies.control.holding import Controller, servo
from mimoc.policies.control.postures import seat
from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones import WINDOWS, trial as trial_module
from mimoc.studies.milestones.nerves import OWN_NOISE, nerves_of
from mimoc.studies.milestones.search import AGES, EXPECTED_MONTHS, search_downwards, search_near, search_trials, walk
from mimoc.studies.milestones.trial import (
    USUAL,
    Attempt,
    Conditions,
    Outcome,
    Trial,
    compile_at,
    control_of,
    grown_to,
    simulate,
    try_out,
)
from mimoc.studies.milestones.trials import MILESTONES, TRIALS

ALONE = Conditions()
CHILD = InfantSpec(mimoc=1, name="child", age_months=0)


@lru_cache
def infant(age_months, **changes):
    return compile_at(CHILD.with_(**changes), age_months, ALONE)


@pytest.mark.parametrize("name", [trial.name for trial in MILESTONES])
def test_a_newborn_reaches_no_milestone(name):
    assert not try_out(TRIALS[name], infant(0), ALONE).success


@pytest.mark.parametrize(
    ("name", "too_young", "old_enough"),
    [
        *(("prone_head", 1.0, 2.5), ("arm_out", 2.5, 4.5), ("no_head_lag", 2.5, 5.5), ("half_squat", 3.5, 5.5)),
        *(("sit", 4.0, 8.0), ("hands_and_knees", 4.5, 8.5), ("stand", 6.5, 13)),
    ],
)
def test_milestones_come_within_a_month_of_real_infants_later_ones_within_two_and_standing_as_whos(
    name, too_young, old_enough
):
    assert not try_out(TRIALS[name], infant(too_young), ALONE).success
    assert try_out(TRIALS[name], infant(old_enough), ALONE).success


LATE = Conditions(delays=True)


@lru_cache
def nervous(age_months, conditions):
    return compile_at(CHILD, age_months, conditions)


@pytest.mark.parametrize(
    ("name", "age_months"),
    [
        pytest.param("prone_head", 3.0, marks=pytest.mark.full),
        pytest.param("arm_out", 4.5, marks=pytest.mark.full),
        pytest.param("sit", 8.0, marks=pytest.mark.full),
        pytest.param("hands_and_knees", 9.0, marks=pytest.mark.full),
    ],
)
def test_delays_that_are_foreseen_cost_no_milestone(name, age_months):
    """But for hands and knees, on which the body alone keeps from six months on, and not yet at seven with delays."""
    assert try_out(TRIALS[name], nervous(age_months, LATE), LATE).success


@pytest.mark.full
def test_an_infant_with_a_nervous_system_sits_at_seven_months_and_not_at_four():
    assert not try_out(TRIALS["sit"], nervous(4.0, USUAL), USUAL).success
    assert try_out(TRIALS["sit"], nervous(7.0, USUAL), USUAL).success


def test_delays_and_noise_are_the_infants_own_and_those_of_its_age_if_it_asks_for_none():
    """At 12 months, commands take 20 ms to the arms, and the senses 20 ms from the arms and 30 from the legs."""
    usual = manifest_of(CHILD)
    assert (usual.delays.motor.ms, usual.delays.motor.legs_ms) == (20.0, 30.0)
    assert (usual.delays.proprioception.ms, usual.delays.proprioception.legs_ms) == (20.0, 30.0)
    assert usual.noise.proprioception_deg == OWN_NOISE["proprioception_deg"]
    assert usual.noise.motor > 0.1
    assert usual.noise.vestibular_thresholds > 0
    asked = {"delays": {"preset": "paper"}, "noise": {"motor": 0.05}, "senses": {"touch": {}}}
    own = manifest_of(CHILD.with_(**asked))
    assert (own.noise.motor, own.noise.proprioception_deg) == (0.05, 0.0)
    assert own.delays.motor.ms != usual.delays.motor.ms
    assert own.senses.touch is None


def test_without_delays_or_noise_an_infant_has_none_and_servos_have_none_of_commands():
    late = manifest_of(CHILD, noise=False)
    noisy = manifest_of(CHILD, delays=False)
    assert (late.noise.motor, late.noise.proprioception_deg, late.delays.motor.ms) == (0.0, 0.0, 20.0)
    assert (noisy.delays.motor.ms, noisy.noise.proprioception_deg > 0) == (0.0, True)
    assert manifest_of(CHILD.with_(actuation={"model": "position"})).noise.motor == 0.0


def manifest_of(spec, *, delays=True, noise=True):
    return nerves_of(grown_to(spec, 12.0, USUAL), delays=delays, noise=noise).manifest


def test_each_seed_has_its_own_noise_and_the_same_each_time():
    """Attempts that follow one another forget each other."""
    (attempt,) = TRIALS["supine_head"].attempts(nervous(2.0, USUAL))
    attempt = replace(attempt, seconds=0.2)
    control = control_of(attempt, USUAL)
    ends = []
    for seed in (0, 1, 0):
        states = deque(maxlen=1)
        simulate(attempt, USUAL, states.append, seed=seed, control=control)
        ends.append(states[0].qpos.copy())
    assert np.array_equal(ends[0], ends[2])
    assert not np.array_equal(ends[0], ends[1])


@pytest.mark.parametrize(
    ("wins", "seeds", "success", "needed"),
    [({0, 2}, 3, True, 3), ({2}, 3, False, 2), ({1, 3}, 4, True, 4), ({0, 1}, 5, False, 5)],
)
def test_an_attempt_counts_if_at_least_half_of_the_seeds_succeed(monkeypatch, wins, seeds, success, needed):
    tried = []

    def outcome(attempt, conditions, *, seed, control):
        tried.append(seed)
        return Outcome(seed in wins, 1.0 + seed)

    monkeypatch.setattr(trial_module, "simulate", outcome)
    monkeypatch.setattr(trial_module, "control_of", lambda *_: None)
    single = Trial("one", "tries", lambda infant: [Attempt(infant, None, 1.0, lambda _: "")])
    assert try_out(single, infant(12.0), replace(USUAL, seeds=seeds)).success is success
    assert len(tried) == needed


def test_an_infant_that_was_compiled_for_its_body_alone_has_no_nervous_system():
    with pytest.raises(ValueError, match="compile it with these conditions"):
        try_out(TRIALS["supine_head"], infant(12.0), USUAL)


@pytest.mark.parametrize("name", ["arm_out", "hands_and_knees"])
def test_arms_of_half_the_strength_delay_what_arms_carry(name):
    """What an infant can do at 6 months, one with weak arms cannot, but at 12 months it can."""
    weak = {"actuation": {"strength": {"arms": 0.5}}}
    assert try_out(TRIALS[name], infant(6.0), ALONE).success
    assert not try_out(TRIALS[name], compile_at(CHILD.with_(**weak), 6.0, ALONE), ALONE).success
    assert try_out(TRIALS[name], compile_at(CHILD.with_(**weak), 12.0, ALONE), ALONE).success


@pytest.mark.parametrize("name", ["half_squat", "no_head_lag"])
def test_arms_of_half_the_strength_do_not_delay_what_legs_and_neck_do(name):
    weak = CHILD.with_(actuation={"strength": {"arms": 0.5}})
    assert try_out(TRIALS[name], compile_at(weak, 6.0, ALONE), ALONE).success


def test_the_published_law_lets_a_newborn_do_what_it_cannot():
    published = compile_at(CHILD.with_(development="published"), 0.0, ALONE)
    assert all(try_out(TRIALS[name], published, ALONE).success for name in ("arm_out", "no_head_lag", "half_squat"))


def test_a_trial_gives_the_same_outcome_each_time():
    one, other = (try_out(TRIALS["sit"], compile_at(CHILD, 3.0, ALONE), ALONE) for _ in range(2))
    assert one == other


def test_an_infant_without_the_part_does_not_succeed():
    armless = CHILD.with_(body={"remove": ["left_upper_arm", "right_upper_arm"]})
    assert "lacks" in try_out(TRIALS["arm_out"], compile_at(armless, 12.0, ALONE), ALONE).reason


@pytest.mark.parametrize("model", ["torque", "position", "muscle"])
def test_wanted_torques_arrive_at_the_joints_in_every_actuation_model(model):
    """An elbow keeps its angle while the infant falls freely."""
    body = compile_at(CHILD.with_(actuation={"model": model}), 12.0, ALONE)
    data = body.placed(0.0, {"{side}_elbow": -40.0}, above_m=1.0)
    control = Controller(body, servo(body, data), body.model.opt.timestep)
    target = data.qpos[body.angles].copy()
    for _ in range(60):
        data.ctrl[:] = control(data, target)
        mujoco.mj_step(body.model, data)
    elbow = body.joint_names.index("left_elbow")
    assert abs(data.qpos[body.angles[elbow]] - target[elbow]) < np.radians(5)


def test_every_milestone_has_a_window_of_real_infants():
    assert all(trial.name in WINDOWS for trial in MILESTONES)
    assert all(list(window.ages) == sorted(window.ages) for window in WINDOWS.values())


@pytest.mark.parametrize("age_months", [0.0, 3.0, 9.0, 18.0, 24.0])
def test_an_unsupported_head_falls(age_months):
    """The trunk is held at 45 degrees, leaning back; the head has no muscles working."""
    body = infant(age_months)
    held = body.fixed(body.trunk_dofs())
    data = held.placed(-45.0, {}, above_m=0.2)
    for _ in range(400):
        mujoco.mj_step(held.model, data)
    assert np.degrees(data.joint("robot:head_tilt").qpos[0]) < -30


def slumped_forward_deg(body, data):
    for _ in range(round(3.0 / body.model.opt.timestep)):
        mujoco.mj_step(body.model, data)
    forward, _, up = data.xmat[body.pushed].reshape(3, 3)[:, 2]
    return np.degrees(np.arctan2(forward, up))


@pytest.mark.parametrize("age_months", [0.0, 6.0, 18.0, 24.0])
def test_a_slack_sitter_with_its_weight_a_fifth_of_the_way_to_its_heels_slumps_forward(age_months):
    body = infant(age_months)
    assert slumped_forward_deg(body, seat(body, -25.0, 0.2)) > 45


@pytest.mark.parametrize("age_months", [0.0, 1.0])
def test_by_the_published_law_a_young_sitter_falls_back_from_there(age_months):
    body = infant(age_months, development="published")
    assert slumped_forward_deg(body, seat(body, -25.0, 0.2)) < -45


@pytest.mark.parametrize("age_months", [0.0, 6.0, 18.0, 24.0])
def test_from_the_pose_sitting_a_slack_infant_slumps_forward(age_months):
    body = infant(age_months)
    data = mujoco.MjData(body.model)
    mujoco.mj_resetDataKeyframe(body.model, data, body.model.key("sitting").id)
    assert slumped_forward_deg(body, data) > 45


def searched(ages, succeeds):
    found = search_downwards(ages, lambda age: Outcome(succeeds(age), 1.0))
    return found.youngest_months, list(found.outcomes)


@given(st.integers(0, 49))
def test_an_infant_that_learns_once_is_found_to_the_half_month(first):
    youngest, tried = searched(AGES, lambda age: age >= 0.5 * first)
    assert youngest == (AGES[first] if first < len(AGES) else None)
    assert 0.0 in tried


@given(st.sets(st.sampled_from(AGES)))
def test_all_older_ages_that_were_tried_succeeded_and_none_is_left_out_for_more_than_a_month(failing):
    youngest, tried = searched(AGES, lambda age: age not in failing)
    if youngest is not None:
        older = sorted(age for age in tried if age >= youngest)
        assert not failing & set(older)
        assert all(after - before <= 1.0 for before, after in pairwise(older))


def test_the_grid_has_every_half_month_of_two_years():
    assert AGES[:3] == [0.0, 0.5, 1.0]
    assert len(AGES) == 49


@given(st.integers(0, 49), st.sampled_from(AGES))
def test_from_any_age_on_the_walk_finds_what_the_search_does_of_an_infant_that_learns_once(first, near):
    outcome = walk(AGES, near, lambda age: Outcome(age >= 0.5 * first, 1.0))
    youngest, _ = searched(AGES, lambda age: age >= 0.5 * first)
    assert outcome.youngest_months == youngest
    assert len(outcome.outcomes) <= 2 + abs(2 * near - first)


@pytest.mark.full
def test_near_the_expected_age_a_child_is_found_to_rise_when_the_plain_search_finds_it_with_fewer_attempts():
    """A light, lean child that matures slowly."""
    individual = {"sex": "male", "length_percentile": 60, "weight_percentile": 20, "maturation_rate": 0.9}
    spec = InfantSpec(mimoc=1, name="kim", age_months=0, body={"individual": individual})
    near = search_near(spec, Conditions(), "pull_to_stand")
    plain = search_trials(spec, Conditions(), ["pull_to_stand"], [age for age in AGES if age <= 10])["pull_to_stand"]
    assert near.youngest_months == plain.youngest_months
    assert len(near.outcomes) < len(plain.outcomes)


def test_every_trial_has_an_age_to_begin_at():
    assert EXPECTED_MONTHS.keys() == TRIALS.keys()
    assert set(EXPECTED_MONTHS.values()) <= set(AGES)
