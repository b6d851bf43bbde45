"""What can stand in the parentheses of a behaviour."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.compiler.explain import entries_of
from mimoc.compiler.presets import MIN_MS, SACCADE_MS
from mimoc.policies.behaviours.behaviour import Option, Reaction, place_of, reaction_of, read_arguments
from mimoc.policies.rollout import Run
from mimoc.policies.spec import parse_policy
from mimoc.schema.kinds import POLICIES

OPTIONS = {"speed_m_s": Option(0.4, 0.05, 1.5)}


def test_words_numbers_and_defaults():
    given = read_arguments("reach_for", "toy, right, speed_m_s=0.3", OPTIONS, most_words=2)
    assert (given.words, given.numbers) == (("toy", "right"), {"speed_m_s": 0.3})
    assert read_arguments("reach_for", "", OPTIONS).numbers == {"speed_m_s": 0.4}


@pytest.mark.parametrize("text", ["(0.3, -1, .2), left", "0.3,-1,.2, left", " ( 0.3 ,-1, .2 ),left"])
def test_three_numbers_are_a_place_with_and_without_parentheses(text):
    place, side = read_arguments("reach_for", text, OPTIONS, most_words=2).words
    assert (place_of(place), side) == ((0.3, -1.0, 0.2), "left")
    assert place_of("toy") is None


@pytest.mark.parametrize(
    ("text", "error", "says"),
    [
        ("toy, right, now", PolicyError, "'reach_for' does not take 'now'; it takes speed_m_s=0.4"),
        ("toy, speed=1", UnknownNameError, "'speed' is not a setting of 'reach_for'; did you mean 'speed_m_s'?"),
        ("toy, speed_m_s=9", PolicyError, "speed_m_s=9 is not possible; give a number from 0.05 to 1.5"),
        ("toy, speed_m_s=nan", PolicyError, "give a number from 0.05 to 1.5"),
        ("toy, speed_m_s=", PolicyError, "give a number from 0.05 to 1.5"),
    ],
)
def test_what_is_wrong_is_said(text, error, says):
    with pytest.raises(error) as caught:
        read_arguments("reach_for", text, OPTIONS, most_words=2)
    assert says in str(caught.value)


@pytest.mark.parametrize("word", ["(1, 2)", "(a, b, c)", "(1, 2, inf)", "(1, 2, 3, 4)"])
def test_a_place_has_three_finite_numbers(word):
    with pytest.raises(PolicyError, match="give x, y and z in metres"):
        place_of(word)


def test_parentheses_mean_the_same_as_a_colon():
    for text in ("look_at(toy)+reflexes(3)+zero", "look_at:toy+reflexes:3+zero"):
        assert [(part.label, part.argument) for part in parse_policy(text)] == [
            *(("look_at", "toy"), ("reflexes", "3"), ("zero", None))
        ]


def test_a_plus_in_parentheses_separates_nothing():
    assert [part.argument for part in parse_policy("look_at(+0.3, +1, 2)+zero")] == ["+0.3, +1, 2", None]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("sit(", "a parenthesis is open"),
        ("zero()", "takes nothing in parentheses; write zero"),
        ("look_at()", "nothing stands in the parentheses; write look_at:TARGET"),
        ("look_at", "write look_at:TARGET"),
    ],
)
def test_a_text_that_is_no_policy_says_what_to_write(text, says):
    with pytest.raises(PolicyError) as caught:
        parse_policy(text)
    assert says in str(caught.value)


def test_nine_behaviours_come_with_mimoc():
    own = {name for name in POLICIES if POLICIES[name].is_behaviour}
    assert own == {"hold", "sit", "prone", "hands_and_knees", "stand", "kick", "look_at", "look_around", "reach_for"}


def spec(age_months, processing: Any = "age", preset="physiological", **keys) -> mimoc.InfantSpec:
    delays = {"preset": preset, "processing": processing}
    senses = {"vestibular": {}}
    data = {"mimoc": 1, "name": "kim", "age_months": age_months, "senses": senses, "delays": delays, **keys}
    return mimoc.InfantSpec.model_validate({"scene": {"pose": "supine"}, **data})


def onset_ms(env, seed: int, policy="look_at(0.3, 0.2, 0.3)") -> float:
    """Return when the left eye first turns at 30 deg/s, as a saccade begins, in [ms]."""
    run, camera = Run(env, policy, seed=seed), env.manifest.anatomy.eyes[0].camera
    before = None
    for step in range(400):
        run.step()
        gaze = -env.data.camera(camera).xmat.reshape(3, 3)[:, 2]
        if step > 3 and np.degrees(np.linalg.norm(gaze - before)) > 0.3:
            return (step + 1) * env.manifest.step_ms
        before = gaze
    raise AssertionError("the gaze did not move")


@pytest.mark.full
@pytest.mark.slow
@pytest.mark.parametrize("preset", ["none", "physiological"])
@pytest.mark.parametrize("age_months", [1, 3, 6, 12])
def test_a_new_target_is_looked_at_after_the_time_of_the_age(age_months, preset):
    """The mean of 25 seeds, within 10 % and twice its standard error, whatever of it is conduction."""
    env = mimoc.make(spec(age_months, preset=preset)).unwrapped
    times_ms = [onset_ms(env, seed) for seed in range(25)]
    assert np.mean(times_ms) == pytest.approx(SACCADE_MS[age_months], rel=0.1 + 2 * 0.3 / 5)
    assert 0.1 < np.std(times_ms) / np.mean(times_ms) < 0.5


def test_without_processing_an_infant_that_is_told_the_truth_looks_at_once():
    assert reaction_of(mimoc.build(spec(3, processing="off")).manifest, "look") is None
    env = mimoc.make(spec(3, processing=None, preset="none")).unwrapped
    assert onset_ms(env, 0, "look_at(0.3, 0.2, 0.3, truth)") < 100
    assert onset_ms(env, 0) > 200


@pytest.mark.parametrize("response", ["look", "reach"])
@pytest.mark.parametrize("age_months", [1, 6, 12])
def test_the_times_of_many_reactions_are_those_of_the_table(age_months, response):
    """Conduction in, decision and conduction out together, and their variation."""
    manifest = mimoc.build(spec(age_months)).manifest
    reaction, generator = reaction_of(manifest, response), np.random.default_rng(0)
    out_s = dict(manifest.delays)["motor"].ms / 1000
    times_s = np.array([reaction.conduction_s + reaction.draw_s(generator) + out_s for _ in range(20000)])
    wanted_s = {"look": SACCADE_MS, "reach": {1: 1500, 6: 600, 12: 450}}[response][age_months] / 1000
    assert times_s.mean() == pytest.approx(wanted_s, rel=0.02)
    assert times_s.std() / times_s.mean() == pytest.approx({1: 0.35, 6: 0.3125, 12: 0.2}[age_months], rel=0.06)


@given(st.lists(st.floats(0, 3), max_size=6), st.integers(0, 9))
def test_stimuli_are_reacted_to_in_their_order_and_never_before_they_could_be(times_s, seed):
    reaction, generator = Reaction[int](0.1, 0.3, 0.5), np.random.default_rng(seed)
    for number, time_s in enumerate(sorted(times_s)):
        reaction.see(number, time_s, generator)
    clock_s = np.arange(0, 20, 0.05)
    reacted = [reaction.at(time_s) for time_s in clock_s]
    known = [number for number in reacted if number is not None]
    assert known == sorted(known)
    for number, at_s in zip(reacted, clock_s, strict=True):
        assert number is None or sorted(times_s)[number] + 0.1 < at_s
    assert not times_s or reacted[-1] == len(times_s) - 1


def test_a_target_that_jumps_is_followed_to_where_it_was_until_the_infant_reacts():
    env = mimoc.make(spec(6, scene={"pose": "supine", "kind": "room", "toys": {"count": [1, 1]}})).unwrapped
    run = Run(env, "look_at(toy)", seed=0)
    for _ in range(150):
        run.step()
    look = run.policies[""]._ensemble.behaviours[0]
    before = look._target.place_m(env.data).copy()
    toy = env.manifest.toys[0].joint
    env.data.joint(toy).qpos[1] += 0.5
    env.data.joint(toy).qpos[2] += 0.3
    for _ in range(2):
        run.step()
    assert look._next.seen.place_m == pytest.approx(before, abs=0.02)
    for _ in range(200):
        run.step()
    now = look._target.place_m(env.data)
    assert look._next.seen.place_m == pytest.approx(now, abs=0.02)


@pytest.mark.parametrize("age_months", [0, 6, 24])
def test_decisions_are_explained_and_never_quicker_than_60_ms(age_months):
    bundle = mimoc.build(spec(age_months, delays={"vision_ms": 0, "motor_ms": 200, "processing": "adult"}))
    entries = entries_of(bundle)
    assert bundle.manifest.delays.processing.look_ms == MIN_MS
    assert entries["delays.processing.look_ms"]["value"] == MIN_MS
    assert entries["delays.processing.reach_ms"]["from"][0] == "spec.delays.processing"
