"""Reaches: what a submovement is, what it is planned from, and how reaches change with age."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import mimoc
from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.policies.behaviours.reaching import (
    CLOSE_M,
    PEAK,
    SHORTEST_S,
    SKILLS,
    Skill,
    Submovement,
    SubmovementLaw,
    skill_at,
)
from mimoc.policies.rollout import Run
from mimoc.studies.experiments.sensed_reaching import place_in_front

STEADY = Skill(farthest_m=0.1, direction_deg=0.0, gain=0.0, top_speed_m_s=0.5, elbow=1.0)
WAYS = st.tuples(*[st.floats(-0.5, 0.5)] * 3).map(np.array).filter(lambda way: np.linalg.norm(way) > CLOSE_M)


@settings(max_examples=20)
@given(WAYS, st.floats(0.18, 1.0))
def test_a_submovement_is_a_bell_that_begins_and_ends_at_rest(way_m, duration_s):
    """It ends where it was planned to, and its peak in the middle is 1.875 times its mean speed."""
    start_m = np.array([0.1, 0.2, 0.3])
    movement = Submovement(1.0, duration_s, start_m, way_m)
    assert movement.place_m(0.5) == pytest.approx(start_m)
    assert movement.place_m(movement.end_s) == pytest.approx(start_m + way_m)
    assert movement.velocity_m_s(1.0) == pytest.approx(np.zeros(3))
    assert movement.velocity_m_s(movement.end_s) == pytest.approx(np.zeros(3), abs=1e-9)
    assert movement.velocity_m_s(1.0 + duration_s / 2) == pytest.approx(PEAK * way_m / duration_s)
    times_s = np.linspace(1.0, movement.end_s, 201)
    places_m, speeds_m_s = (
        np.array([of_time(time_s) for time_s in times_s]) for of_time in (movement.place_m, movement.velocity_m_s)
    )
    assert np.gradient(places_m, times_s, axis=0)[1:-1] == pytest.approx(speeds_m_s[1:-1], abs=0.01)
    accelerations = np.array([movement.acceleration_m_s2(time_s) for time_s in times_s])
    assert np.gradient(speeds_m_s, times_s, axis=0)[1:-1] == pytest.approx(accelerations[1:-1], abs=0.4)


@settings(max_examples=20)
@given(WAYS)
def test_without_errors_a_submovement_leads_to_the_target_or_as_far_as_it_can(way_m):
    """It takes .2 s, or longer if the hand would be faster than it can be."""
    planned = STEADY.plan(np.zeros(3), way_m, 0.0, np.random.default_rng(0))
    distance_m = np.linalg.norm(way_m)
    length_m = min(distance_m, STEADY.farthest_m)
    assert planned.way_m == pytest.approx(length_m * way_m / distance_m)
    assert planned.duration_s == pytest.approx(max(SHORTEST_S, PEAK * length_m / STEADY.top_speed_m_s))


def test_errors_of_direction_and_length_have_the_deviations_of_the_age():
    generator = np.random.default_rng(0)
    skill = skill_at(6.0)
    target_m = np.array([0.0, 0.0, 0.1])
    ways_m = np.array([skill.plan(np.zeros(3), target_m, 0.0, generator).way_m for _ in range(4000)])
    lengths_m = np.linalg.norm(ways_m, axis=1)
    assert np.log(lengths_m / 0.1).std() == pytest.approx(skill.gain, rel=0.05)
    angles_rad = np.arccos(ways_m[:, 2] / lengths_m)
    assert np.degrees(np.sqrt(np.mean(angles_rad**2) / 2)) == pytest.approx(skill.direction_deg, rel=0.05)


def test_errors_fall_and_submovements_lead_farther_with_age():
    for name in ("direction_deg", "gain", "top_speed_m_s"):
        assert list(SKILLS[name]) == sorted(SKILLS[name], reverse=True)
    for name in ("farthest_m", "elbow"):
        assert list(SKILLS[name]) == sorted(SKILLS[name])


def test_a_submovement_is_not_changed_until_it_ends():
    """Where the target went meanwhile only counts for the next one."""
    law: Any = SubmovementLaw(STEADY, 0.01)
    generator, hand_m = np.random.default_rng(0), np.zeros(3)
    law.velocity_m_s(hand_m, np.array([0.1, 0.0, 0.0]), 0.0, generator)
    first = law.current
    law.velocity_m_s(hand_m, np.array([0.0, 0.1, 0.0]), first.end_s - 0.02, generator)
    assert law.current is first
    law.velocity_m_s(hand_m, np.array([0.0, 0.1, 0.0]), first.end_s, generator)
    assert law.current.way_m == pytest.approx([0.0, 0.1, 0.0])


def test_a_hand_that_is_at_the_target_rests():
    law = SubmovementLaw(STEADY, 0.01)
    generator, target_m = np.random.default_rng(0), np.array([0.05, 0.0, 0.0])
    law.velocity_m_s(np.zeros(3), target_m, 0.0, generator)
    assert law.velocity_m_s(target_m, target_m, 0.3, generator) == pytest.approx(np.zeros(3), abs=1e-9)


def infant(age_months: float = 9.0, **keys: Any) -> Any:
    spec: Any = {"mimoc": 1, "name": "kim", "age_months": age_months, "senses": {"proprioception": {}}, **keys}
    env = mimoc.make(mimoc.InfantSpec(**{**spec, "scene": {"pose": "sitting", "held": ["chest"]}})).unwrapped
    env.reset(seed=0)
    return env


def reach_of(run: Any) -> Any:
    return run.policies[""]._ensemble.behaviours[1]


def test_a_reach_is_planned_to_where_the_target_was_seen():
    """The delay of vision ago, and as long besides as a decision takes."""
    senses = {"proprioception": {}, "vision": {"width_px": 8, "height_px": 8}}
    delays = {"vision_ms": 100, "processing": "age"}
    env = infant(senses=senses, delays=delays, noise={})
    reach = reach_of(Run(env, "hold+reach_for(left_hand, right)", seed=0))
    late_s = 0.1 + env.manifest.delays.processing.reach_ms / 1000
    hand = env.model.body("left_hand").id
    reach._subject.chance.generator = np.random.default_rng(0)
    for step in range(300):
        env.data.xipos[hand] = (0.001 * step, 0.0, 0.0)  # A target that moves slowly enough not to be a new one.
        reach.watch(env.data, 0.01 * step)
    assert reach._noticed.place_m(env.data, 2.99)[0] == pytest.approx(0.299 - late_s / 10, abs=0.0011)


def test_who_is_told_the_truth_reaches_straight():
    env = infant(4)
    shoulder_m = env.data.body("right_upper_arm").xpos
    place = "({:.3f}, {:.3f}, {:.3f})".format(*(shoulder_m + np.array([0.12, 0.04, -0.02])))
    ratios, units = [], []
    for word in (", truth", ""):
        run = Run(env, f"hold+reach_for({place}, right{word})", seed=1)
        for _ in range(300):
            run.step()
        metrics = run.summary().metrics
        ratios.append(metrics["hand_path_ratio"])
        units.append(metrics["hand_units"])
    assert ratios[0] < 1.1 < ratios[1]
    assert units[0] < units[1]


@pytest.mark.parametrize(
    ("policy", "error", "says"),
    [
        ("reach_for(head, right, left, truth, up)", PolicyError, "'reach_for' does not take '"),
        ("reach_for(head, truht)", UnknownNameError, "'truht' is not a hand that can reach"),
        ("reach_for(head, speed_m_s=2)", PolicyError, "give a number from 0.05 to 1.5"),
        ("reach_for(speed_m_s=0.5)", PolicyError, "'reach_for' needs a target"),
    ],
)
def test_what_cannot_be_reached_for_is_said(policy, error, says):
    with pytest.raises(error) as caught:
        Run(infant(), policy, seed=0)
    assert says in str(caught.value)


NERVOUS: Any = {
    "senses": {"proprioception": {"include": ["velocity"]}, "vestibular": {}, "touch": {}},
    "delays": {"preset": "physiological"},
    "noise": {"motor": "maturing", "proprioception_deg": "age", "vestibular_thresholds": "age"},
}


def reaches(age_months: float, count: int, seconds: float = 3.0) -> list[Any]:
    """Return the metrics of reaches for drawn places, with the senses, delays and noise of an age."""
    env = infant(age_months, **NERVOUS)
    found = []
    for seed in range(count):
        env.reset(seed=seed)
        place_m = place_in_front(env, np.random.default_rng(seed))
        run = Run(env, "hold+reach_for(({:.3f}, {:.3f}, {:.3f}), right)".format(*place_m), seed=seed)
        for _ in range(round(1000 * seconds / env.manifest.step_ms)):
            run.step()
        found.append(run.summary().metrics)
    return found


@pytest.mark.full
@pytest.mark.slow
def test_the_older_an_infant_the_more_often_it_arrives_and_the_straighter():
    """Under the delays and the noise of its age."""
    young, old = (reaches(age_months, 12) for age_months in (4, 12))
    shares = [np.mean(["reached_s" in each for each in same]) for same in (young, old)]
    assert shares[0] <= shares[1]
    assert shares[1] > 0.8
    for name in ("hand_units", "hand_path_ratio"):
        early, late = (np.median([each[name] for each in same if name in each]) for same in (young, old))
        assert early > 1.3 * late


def test_the_same_seed_reaches_the_same_way():
    env = infant(6)
    paths = []
    for seed in (1, 1, 2):
        run = Run(env, "hold+reach_for(head, right)", seed=seed)
        for _ in range(30):
            run.step()
        paths.append(env.data.body("right_hand").xpos.copy())
    assert paths[0].tobytes() == paths[1].tobytes() != paths[2].tobytes()
