"""Reaching by chance, as `mimoc run --policy reach` shows it and experiments measure it."""

import numpy as np
import pytest
from support.full import full_rows

import mimoc
from mimoc.base.errors import ControlError, PolicyError
from mimoc.policies.reach import GAIN_SETS, ReachableTargets, ReachPolicy, reach_errors
from mimoc.policies.rollout import Run

SITTING = {"kind": "flat", "pose": "sitting"}


def places_of(env):
    return ReachableTargets(env.model, env.manifest)


def test_drawn_places_are_within_reach_of_their_hands(held_infant):
    env = held_infant()
    env.reset(seed=0)
    places, generator = places_of(env), np.random.default_rng(0)
    assert places.hands == ("right_hand", "left_hand")
    for _ in range(20):
        for side, place_m in zip(("right", "left"), places.draw(env.data, generator), strict=True):
            shoulder, elbow, hand = (env.data.body(f"{side}_{part}") for part in ("upper_arm", "lower_arm", "hand"))
            arm_m = np.linalg.norm(elbow.xpos - shoulder.xpos) + np.linalg.norm(hand.xipos - elbow.xpos)
            assert np.linalg.norm(place_m - shoulder.xpos) < 1.2 * arm_m


def test_places_follow_from_the_generator(held_infant):
    env = held_infant()
    places = places_of(env)
    first, same, other = (places.draw(env.data, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert np.array_equal(first, same)
    assert not np.array_equal(first, other)


def test_an_infant_with_one_arm_reaches_with_that(open_env):
    env = open_env(body={"remove": ["left_upper_arm"]}, scene=SITTING)
    policy = ReachPolicy(env)
    assert env.action_space.contains(policy(np.random.default_rng(0), env.reset(seed=0)[0]))
    assert len(policy.errors()[0]) == 1


def test_an_infant_without_hands_cannot_reach(open_env):
    env = open_env(body={"remove": ["left_hand", "right_hand"]})
    with pytest.raises(ControlError, match="no hand with a commanded arm"):
        ReachPolicy(env)


@pytest.mark.full
@pytest.mark.parametrize(
    ("development", "age_months", "hands", "model"),
    full_rows(
        [("maturing", 9, "mitten", "torque")],
        [
            ("maturing", 9, "five_finger", "muscle"),
            ("maturing", 24, "mitten", "torque"),
            ("published", 6, "five_finger", "torque"),
        ],
    ),
)
def test_a_sitting_infant_that_nobody_holds_stays_up_and_reaches(open_env, development, age_months, hands, model):
    """In two of three trials of 4 s its chest and head stay up, and its hands come within 2.5 cm.

    A difference of rounding is a centimetre after a tenth of a second, so that a single trial is another one on another
    machine; of 64 trials, three ended in a fall.
    """
    keys = {"development": development, "actuation": {"model": model}, "body": {"hands": hands}}
    env = open_env(age_months=age_months, scene=SITTING, **keys)
    assert sum(_stays_up_and_reaches(env, seed) for seed in range(3)) >= 2


def _stays_up_and_reaches(env, seed):
    """Return whether the chest stays upright, the head bows by less than a third, and the hands come close."""
    run = Run(env, "reach", seed=seed)
    head_m = float(env.data.geom("head").xpos[2])
    for _ in range(400):
        run.step()
    told = run.summary()
    assert not told.unstable
    upright = "fell_after_s" not in told.metrics and told.head_height_m[0] > 0.7 * head_m
    return upright and told.metrics["hand_error_m"] < 0.025


@pytest.mark.parametrize(
    "keys", [{"age_months": 1}, {"actuation": {"strength": {"trunk": 0.02, "neck": 0.02}}}], ids=["young", "weak"]
)
def test_a_fall_is_told(open_env, keys):
    """An infant of one month, or one of nine with hardly any strength, cannot keep its seat."""
    run = Run(open_env(scene=SITTING, **keys), "reach", seed=0)
    for _ in range(200):
        run.step()
    assert 0.0 < run.summary().metrics["fell_after_s"] < 2.0


def test_with_the_senses_for_it_late_commands_and_senses_hardly_matter(open_env):
    """An infant that acts from the simulation's present is 3 cm away from its targets, as commands act too late."""
    senses = {"proprioception": {"include": ["velocity"]}, "vestibular": {}, "touch": {}}
    held = {**SITTING, "held": ["hip", "chest"]}
    env = open_env(senses=senses, scene=held, delays={"preset": "physiological"}, actuation={"voice": True})
    errors_m, told = list[float](), list[int]()
    for policy in ("reach", "reach:truth"):
        run = Run(env, policy, seed=0)
        for _ in range(160):
            run.step()
        errors_m.append(run.summary().metrics["hand_error_m"])
        told.append(len(run.summary().notes))
    assert errors_m[0] < 0.01 < errors_m[1]
    assert told == [0, 1]


def test_reaching_takes_no_other_word(open_env):
    with pytest.raises(PolicyError, match="write reach or reach:truth"):
        Run(open_env(scene=SITTING), "reach:ball", seed=0)


def test_what_comes_of_reaching_is_summed_up_only_where_something_reaches(open_env):
    env = open_env(scene=SITTING)
    for policy, reaches in (("reach", True), ("zero", False)):
        run = Run(env, policy, seed=0)
        for _ in range(200):
            run.step()
        assert ("hand_error_m" in run.summary().metrics) == reaches


def test_a_hand_without_strength_reaches_none_of_its_targets(open_env):
    weak = {"impairments": {"weakness": {"right_arm": 0.02}}, "scene": {**SITTING, "held": ["hip", "chest"]}}
    run = Run(open_env(**weak), "reach", seed=0)
    for _ in range(310):
        run.step()
    told = run.summary().metrics
    assert (told["hand_targets"], told["left_hand_reached_share"], told["right_hand_reached_share"]) == (2, 1.0, 0.0)
    assert told["left_hand_error_m"] < 0.01 < 0.05 < told["right_hand_error_m"]


def test_errors_begin_where_the_infant_starts_and_shrink(held_infant):
    env = held_infant()
    told = []
    errors = reach_errors(env, GAIN_SETS["medium"], np.random.default_rng(0), 2, 0.5, lambda *done: told.append(done))
    assert told == [(1, 2), (2, 2)]
    assert errors.time_s == pytest.approx(np.linspace(0, 0.5, 51))
    assert errors.hands_m.shape == (2, 51, 2)
    assert errors.eyes_rad.shape == (2, 51, 2)
    assert (errors.hands_m[:, -1] < 0.2 * errors.hands_m[:, 0]).all()


def test_stronger_gains_reach_faster(held_infant):
    env = held_infant()
    distances_m = [
        reach_errors(env, gains, np.random.default_rng(0), 3, 0.5).hands_m[:, -1].mean() for gains in GAIN_SETS.values()
    ]
    assert distances_m == sorted(distances_m, reverse=True)


def test_the_ball_of_the_task_is_what_is_reached_for(open_env):
    run = Run(open_env(age_months=18, task={"kind": "reach"}), "reach", seed=0)
    for _ in range(200):
        run.step()
    told = run.summary()
    assert told.successes == told.finished > 5
    assert "hand_error_m" not in told.metrics


@pytest.mark.parametrize("keys", [{"body": {"remove": ["right_eye"]}}, {"actuation": {"regions": ["arms"]}}], ids=str)
def test_eyes_that_are_not_there_or_not_moved_are_left_out(open_env, keys):
    env = open_env(scene={**SITTING, "held": ["hip", "chest"]}, **keys)
    policy = ReachPolicy(env)
    assert env.action_space.contains(policy(np.random.default_rng(0), env.reset(seed=0)[0]))
    hands_m, eyes_rad = policy.errors()
    assert (len(hands_m), len(eyes_rad)) == (2, 1 if "body" in keys else 0)


def test_only_hands_that_take_commands_reach(open_env):
    env = open_env(actuation={"regions": ["left_arm"]}, scene=SITTING)
    assert places_of(env).hands == ("left_hand",)


@pytest.mark.parametrize("kind", ["reach", "standup", "selfbody", "catch", "rollover"])
@pytest.mark.parametrize("model", ["torque", "muscle"])
def test_it_runs_whatever_holds_the_infant(open_env, kind, model):
    run = Run(open_env(age_months=18, actuation={"model": model}, task={"kind": kind}), "reach", seed=0)
    for _ in range(30):
        run.step()
    assert not run.summary().unstable


@pytest.mark.full
@pytest.mark.parametrize(("model", "age_months"), full_rows([("muscle", 18)], [("torque", 3)]))
def test_eyes_align_while_both_hands_reach(open_env, model, age_months):
    """Within 2 degrees after two seconds, and hands within 5 mm after one, at the median; sitting, the trunk held."""
    scene = {**SITTING, "held": ["hip"]}
    env = open_env(age_months=age_months, actuation={"model": model, "locked": ["trunk"]}, scene=scene)
    errors = reach_errors(env, GAIN_SETS["high"], np.random.default_rng(1), trials=5, seconds=2.0)
    assert np.median(errors.hands_m[:, 100]) < 0.005
    assert np.degrees(np.median(errors.eyes_rad[:, -1].max(axis=1))) < 1.0
    assert np.mean(np.degrees(errors.eyes_rad[:, -1].max(axis=1)) < 2.0) > 0.8


def test_the_policy_follows_the_infant_into_another_scene():
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "scene": {"kind": "room", "pose": "sitting"}}
    env = mimoc.make(mimoc.InfantSpec.model_validate(spec)).unwrapped
    observation, _ = env.reset(seed=0)
    policy, generator = ReachPolicy(env), np.random.default_rng(0)
    for seed in (1, 5):
        for _ in range(3):
            observation, *_ = env.step(policy(generator, observation))
        observation, _ = env.reset(options={"scene_seed": seed})
    assert env.action_space.contains(policy(generator, observation))
