"""Searches for skills: that they find what can be found, and what is told of them."""

import json

import numpy as np
import pytest

import mimoc
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import SKILLS
from mimoc.studies.skills import trainings
from mimoc.studies.skills.learning import CHILD, REAL_AGES, AgeResult, Attempt, SkillReport, learn_skill
from mimoc.studies.skills.search import DRAWS, RECIPES, Form, search

SENSES = {"proprioception": {"include": ["velocity"]}, "vestibular": {}}


def env_of(kind: str, age_months: float = 9, **options):
    keys = {"mimoc": 1, "name": "kim", "age_months": age_months, "senses": SENSES}
    return mimoc.make(mimoc.InfantSpec(**keys, task={"kind": kind, **options})).unwrapped


def test_every_skill_has_a_recipe_and_ages():
    assert set(RECIPES) == set(SKILLS) == set(REAL_AGES)


def test_a_movement_of_zeros_is_the_start_on_both_sides_alike():
    joints = ("robot:hip_lean1", "robot:hip_bend1", "robot:right_knee", "robot:left_knee")
    form = Form(RECIPES["sit"], "sit", 8, joints, np.array([0.1, 0.2, 0.3, 0.3]))
    assert form.sizes == [2, 2, 2, 2, 2]  # Bending and both knees; what is felt: forward, and to the side.
    assert form.movement(np.zeros(10)).postures == ((0.1, 0.2, 0.3, 0.3),)
    moved = form.movement(np.array([0.1, 0.2, *[0.0] * 8])).postures[0]
    assert moved == pytest.approx((0.1, 0.3, 0.5, 0.5))
    swayed = np.array(form.movement(np.array([0, 0, 0, 0, 1, 1, 0, 0, 0, 0.0])).sway)
    assert swayed[1] == pytest.approx(np.array([0.5, 0, 0.5, -0.5]))


@pytest.mark.full
@pytest.mark.slow
def test_a_search_gets_better_and_the_same_seed_gives_the_same():
    outcomes = [search(env_of("sit_up", steps=25), 3, tries=4 * DRAWS, starts=2) for _ in range(2)]
    first, second = outcomes
    assert first == second
    assert len(first.curve) == 3
    assert first.curve[-1] > first.curve[0]


def attempt(age: float, success: float, seed: int = 0) -> Attempt:
    return Attempt(age_months=age, seed=seed, success=success, starts=20)


@pytest.mark.parametrize(
    ("successes", "from_months", "verdict"),
    [
        ({2: 0, 4: 0, 6: 1}, 5.0, "inside"),
        ({2: 1, 4: 1}, 2.0, "too early"),
        ({2: 0, 4: 0}, None, "no verdict"),
        ({2: 0, 7: 0}, None, "not reached"),
        ({4: 0, 12: 1}, 8.0, "too late"),
    ],
)
def test_the_age_of_a_skill_is_where_half_of_the_starts_succeed(successes, from_months, verdict):
    results = [AgeResult.of([attempt(age, success)]) for age, success in successes.items()]
    report = SkillReport.of("roll", results)
    assert report.from_months == (from_months if from_months is None else pytest.approx(from_months))
    assert report.verdict == verdict
    json.dumps(report.to_data())


@pytest.mark.full
def test_it_goes_on_from_what_was_searched_and_says_who_cannot_begin(tmp_path, monkeypatch):
    def learn(tries=DRAWS):
        return learn_skill(
            "pull_to_stand", (0, 9), tmp_path / "out", seeds=1, tries=tries, starts=1, options={"steps": 5}
        )

    report = learn()
    newborn, older = report.ages
    assert "flat feet" in newborn.searches[0].problem
    assert newborn.success == 0
    assert older.searches[0].tried == DRAWS
    assert (tmp_path / "out" / "pull_to_stand_9_months.json").exists()
    assert not (tmp_path / "out" / "pull_to_stand_0_months.json").exists()
    monkeypatch.setattr("mimoc.studies.skills.search.run_jobs", None)
    assert learn() == report


def child(kind: str, **keys: object) -> InfantSpec:
    return InfantSpec.model_validate({**CHILD, "age_months": 12, "task": {"kind": kind, **keys}})


def test_who_can_fall_is_helped_while_it_learns_unless_the_spec_says_otherwise():
    supports = [
        getattr(trainings.while_learning(spec).task, "support", None)
        for spec in (child("stand"), child("stand", support=0.0), child("stand", support=0.2), child("roll"))
    ]
    assert supports == [trainings.SUPPORT, 0.0, 0.2, 0.0]
    for kind in trainings.HELPED:
        child(kind, support=trainings.SUPPORT)


@pytest.mark.slow
@pytest.mark.usefixtures("kernels_compiled_quickly")
def test_two_ages_learn_side_by_side_and_act_on_the_cpu(tmp_path, monkeypatch):
    monkeypatch.setattr(trainings, "HYPER", {"n_steps": 4, "mini_batches": 2})

    def learn():
        options = {"device": "warp:cpu", "steps": 8, "envs": 2, "seeds": 1, "starts": 1, "options": {"steps": 6}}
        return learn_skill("pull_to_stand", (0, 9, 10), tmp_path / "out", **options)

    report = learn()
    newborn, *older = [result.searches[0] for result in report.ages]
    assert "flat feet" in newborn.problem
    for attempt in older:
        assert attempt.tried == 8
        assert 0 <= attempt.success_on_device <= 1
        assert (tmp_path / "out" / attempt.policy).exists()
    assert not (tmp_path / "out" / "pull_to_stand_0_months.zip").exists()
    spec = child("pull_to_stand").with_(age_months=9)
    policy = f"skill:{tmp_path / 'out' / 'pull_to_stand_9_months.zip'}"
    assert len(mimoc.evaluate(mimoc.make(spec).unwrapped, policy, episodes=1)) == 1
    monkeypatch.setattr(trainings, "train_together", None)
    assert learn() == report
