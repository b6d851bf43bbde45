"""A policy through postures: what it asks joints for, and what it needs."""

import json
import re
from functools import cache

import numpy as np
import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.base.errors import PolicyError
from mimoc.policies.named import policy_of
from mimoc.policies.skill import PosturePolicy, Postures, mirrored, read_postures, write_postures

SENSES = {"proprioception": {"include": ["velocity"]}, "vestibular": {}}
JOINTS = ("robot:hip_lean1", "robot:right_elbow", "robot:left_elbow")


def movement(**keys) -> Postures:
    form = {"task": "roll", "age_months": 6, "joints": JOINTS, "postures": ((0.5, -1.0, 0.2), (0.0, 1.0, -0.4))}
    return Postures.model_validate(form | keys)


@cache
def kim(model="torque"):
    actuation = {"model": model}
    return mimoc.make(mimoc.InfantSpec(mimoc=1, name="kim", age_months=6, senses=SENSES, actuation=actuation)).unwrapped


def test_both_sides_change_places_and_leaning_its_side():
    other = np.array(movement(mirrored=True).targets())
    assert other[2:] == pytest.approx(np.array([[-0.5, 0.2, -1.0], [0.0, -0.4, 1.0]]))
    assert mirrored(JOINTS, mirrored(JOINTS, other)) == pytest.approx(other)


@given(st.floats(0, 20))
def test_the_target_is_between_postures_and_the_last_is_kept(time_s):
    policy = PosturePolicy(kim(), movement())
    target, first, last = policy._target(time_s), np.array([0.5, -1.0, 0.2]), np.array([0.0, 1.0, -0.4])
    assert (np.minimum(first, last) - 1e-9 <= target).all()
    assert (target <= np.maximum(first, last) + 1e-9).all()
    if time_s >= 1.4:
        assert target == pytest.approx(last)
    if 0.4 <= time_s < 1.0:
        assert target == pytest.approx(first)


def test_a_rhythm_begins_again():
    policy = PosturePolicy(kim(), movement(repeats=True, mirrored=True))
    for time_s in (0.1, 0.7, 1.9, 3.3):
        assert policy._target(4.0 + time_s) == pytest.approx(policy._target(8.0 + time_s))


@pytest.mark.parametrize("model", ["torque", "muscle", "position"])
def test_joints_go_where_they_are_asked_to_in_every_actuation_model(model):
    """Within the strength of the infant: the elbows of one that lies on its back."""
    env = kim(model)
    asked = Postures(task="free", age_months=6, joints=JOINTS[1:], postures=((-0.6, 0.6),))
    observation, _ = env.reset(seed=0)
    policy, generator = PosturePolicy(env, asked), np.random.default_rng(0)
    for _ in range(200):
        observation, *_ = env.step(policy(generator, observation))
    right, left = (float(env.data.joint(name).qpos[0]) for name in JOINTS[1:])
    assert right < left - 0.3


def test_a_file_is_read_as_it_was_written(tmp_path):
    written = movement(sway=((0.1, 0.2, 0.3),) * 4, repeats=True)
    write_postures(written, tmp_path / "roll.json")
    assert read_postures(tmp_path / "roll.json") == written


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("{}", "task"),
        ('{"mimoc_postures": 2}', "mimoc_postures"),
        ("nothing", "JSON"),
        (movement().model_dump_json().replace("0.5", "7.5"), "postures"),
        (movement().model_dump_json().replace("-1.0", "NaN"), ""),
    ],
)
def test_what_is_no_movement_is_refused_in_one_line(tmp_path, content, problem):
    (tmp_path / "roll.json").write_text(content)
    with pytest.raises(PolicyError) as refusal:
        read_postures(tmp_path / "roll.json")
    assert problem in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_what_is_not_there_is_named(tmp_path):
    for text in (str(tmp_path / "none.json"), "knitting"):
        with pytest.raises(PolicyError, match=r"none\.json|knitting"):
            policy_of(kim(), f"skill:{text}")


def test_an_infant_that_does_not_sense_its_joints_is_refused():
    blind = mimoc.make(mimoc.InfantSpec(mimoc=1, name="kim", age_months=6)).unwrapped
    with pytest.raises(PolicyError, match="proprioception"):
        PosturePolicy(blind, movement())


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ({"joints": ()}, "joints: "),
        ({"joints": JOINTS[:2] + JOINTS[:1]}, "joints: one is there twice"),
        ({"postures": ((0.1,), (0.2, 0.3))}, "postures.0: 1 numbers, for 3 joints"),
        ({"sway": ((1.0,),)}, "sway: give 4 rows"),
        ({"sway": ((0.1, 0.1, 0.1),) * 3}, "sway: give 4 rows"),
    ],
)
def test_a_movement_has_a_number_for_every_joint(tmp_path, keys, reason):
    form = movement().model_dump(mode="json") | keys
    (tmp_path / "skill.json").write_text(json.dumps(form))
    with pytest.raises(PolicyError, match=f"^{re.escape(str(tmp_path))}/skill.json: {reason}"):
        read_postures(tmp_path / "skill.json")
