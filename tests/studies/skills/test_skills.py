"""Searches for skills: that they find what can be found, and what is told of them."""

import json
from collections.abc import Callable

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import PolicyError
from mimoc.policies import skill
from mimoc.policies.skill import Postures, read_postures
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import SKILLS
from mimoc.studies.skills import (
    CHILD,
    REAL_AGES,
    RESULTS,
    AgeResult,
    SkillReport,
    SkillSearch,
    learn_skill,
    search as searching,
    shipped_skills,
)
from mimoc.studies.skills.search import (
    DRAWS,
    FIRST_TEST,
    HELPED,
    KEPT,
    RECIPES,
    SUPPORT,
    Candidate,
    Form,
    Searcher,
    SearchOutcome,
    best_of,
    search,
    while_learning,
)

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


def attempt(age: float, success: float, seed: int = 0) -> SkillSearch:
    return SkillSearch(age_months=age, seed=seed, success=success, starts=20)


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
        getattr(while_learning(spec).task, "support", None)
        for spec in (child("stand"), child("stand", support=0.0), child("stand", support=0.2), child("roll"))
    ]
    assert supports == [SUPPORT, 0.0, 0.2, 0.0]
    for kind in HELPED:
        child(kind, support=SUPPORT)


@pytest.mark.extras
@pytest.mark.slow
@pytest.mark.usefixtures("kernels_compiled_quickly")
def test_two_ages_learn_side_by_side_and_act_on_the_cpu(tmp_path, monkeypatch):
    monkeypatch.setattr("mimoc.studies.skills.search.HYPER", {"n_steps": 4, "mini_batches": 2})

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
    monkeypatch.setattr("mimoc.training.trainer.train_together", None)
    assert learn() == report


STARTS = 20
Play = Callable[[float, int], tuple[float, bool]]


class ToySearcher(Searcher):
    """Tries movements of one knee through three postures, of which only their length as a vector matters."""

    def __init__(self, play: Play):
        self.form = Form(RECIPES["roll"], "roll", 6, ("robot:right_knee",), np.zeros(1))
        self.seeds: list[int] = []
        self._play = play

    def play(self, movement: Postures, seed: int) -> tuple[float, bool]:
        self.seeds.append(seed)
        return self._play(float(np.linalg.norm(movement.postures)), seed)


def on_a_sphere(length: float, seed: int) -> tuple[float, bool]:
    """Whatever has a length of .8 has the skill; the mean of such movements is shorter, and has not."""
    return -abs(length - 0.8), abs(length - 0.8) < 0.1


def never(length: float, seed: int) -> tuple[float, bool]:
    return length, False


def by_chance(length: float, seed: int) -> tuple[float, bool]:
    """The longer, the more often."""
    has_skill = np.random.default_rng([seed, int(1e6 * length)]).random() < length / 2
    return length + has_skill, bool(has_skill)


def searched(monkeypatch, play: Play, seed: int = 0, tries: int = 400) -> tuple[SearchOutcome, ToySearcher]:
    toy = ToySearcher(play)
    monkeypatch.setattr(searching, "Searcher", lambda env: toy)
    return search(None, seed, tries, STARTS), toy


@pytest.fixture
def checked(monkeypatch) -> list[Candidate]:
    """What a search has checked in the end: the mean, then what it kept."""
    candidates: list[Candidate] = []

    def spy(searcher, those, first, tries):
        candidates.extend(those)
        return best_of(searcher, those, first, tries)

    monkeypatch.setattr(searching, "best_of", spy)
    return candidates


@pytest.mark.parametrize("seed", range(5))
def test_a_search_ends_with_a_draw_that_has_the_skill_where_the_mean_has_not(seed, checked, monkeypatch):
    outcome, toy = searched(monkeypatch, on_a_sphere, seed)
    assert toy.success(toy.form.movement(checked[0].vector), FIRST_TEST, 1) == 0
    assert outcome.success == 1


def test_what_is_best_in_new_starts_is_taken_and_not_what_was_lucky_before():
    toy = ToySearcher(by_chance)
    lucky = Candidate(np.array([0.2, 0, 0]), (9.0,) * 3, (True,) * 3)
    reliable = Candidate(np.array([1.0, 1.0, 0.5]), (0.0,), (False,))
    best, tried = best_of(toy, [lucky, *[Candidate(np.array([0.1, 0, 0]))] * 7, reliable], 0, 160)
    assert best.vector is reliable.vector
    assert tried == len(toy.seeds) == 9 * 4 + 5 * 8 + 3 * 13 + 2 * 20
    assert len(best.successes) == 4 + 8 + 13 + 20


def test_without_enough_tries_to_check_the_first_candidate_is_taken():
    candidates = [Candidate(np.full(3, share)) for share in (0.1, 0.9)]
    best, tried = best_of(ToySearcher(by_chance), candidates, 0, 1)
    assert (best.vector[0], tried) == (0.1, 0)


def test_what_is_kept_is_tried_again_in_the_start_of_each_round(checked, monkeypatch):
    """So one lucky start weighs less and less."""
    outcome, toy = searched(monkeypatch, never)
    starts = toy.seeds[: len(outcome.curve) * DRAWS]
    assert starts == sorted(starts)
    assert {starts.count(start) for start in starts} == {DRAWS}
    assert len(checked) == 1 + KEPT
    assert max(len(candidate.scores) for candidate in checked) > 2


@pytest.mark.parametrize("play", [on_a_sphere, never, by_chance])
@pytest.mark.parametrize("tries", [40, 60, 100, 400, 1600])
def test_rounds_and_checks_together_stay_within_the_tries_and_are_counted(tries, play, monkeypatch):
    outcome, toy = searched(monkeypatch, play, tries=tries)
    assert outcome.tried == len(toy.seeds) - STARTS <= tries
    assert len(outcome.curve) * DRAWS <= outcome.tried


def test_the_starts_of_rounds_of_checks_and_of_the_measurement_are_all_different(monkeypatch):
    """Also from those of other searches."""
    used: set[int] = set()
    for seed in (0, 1, 19, 20):
        outcome, toy = searched(monkeypatch, never, seed, tries=1600)
        rounds, rest = toy.seeds[: len(outcome.curve) * DRAWS], toy.seeds[len(outcome.curve) * DRAWS :]
        checks, measured = rest[:-STARTS], rest[-STARTS:]
        assert len(set(rounds)) == len(outcome.curve)
        assert len(set(checks)) == 4 + 8 + 13 + 20
        assert len(set(measured)) == STARTS
        seeds = [set(rounds), set(checks), set(measured), used]
        assert sum(map(len, seeds)) == len(set.union(*seeds))
        used |= set(rounds) | set(checks)


def test_rounds_end_once_a_movement_has_the_skill_in_most_of_many_starts(monkeypatch):
    outcome, _ = searched(monkeypatch, on_a_sphere, tries=1600)
    assert searching.CHECKS <= len(outcome.curve) < 36


def report(kind: str, success: dict[float, float]) -> SkillReport:
    results = [AgeResult.of([attempt(age, share)]) for age, share in success.items()]
    return SkillReport.of(kind, results)


def test_what_a_search_writes_is_what_is_shown(tmp_path):
    for kind, success in (("roll", {2.0: 0.0, 6.0: 1.0}), ("walk", {6.0: 1.0})):
        (tmp_path / f"{kind}.json").write_text(json.dumps(report(kind, success).to_data()))
    skills = shipped_skills(tmp_path)
    assert [(item.skill, item.from_months, item.verdict) for item in skills.skills] == [
        ("roll", 4.0, "inside"),
        ("walk", 6.0, "too early"),
    ]
    assert skills.skills[0].to_data() == report("roll", {2.0: 0.0, 6.0: 1.0}).to_data()
    assert not skills.passed
    assert set(skills.waiting) == set(SKILLS) - {"roll", "walk"}
    json.dumps(skills.to_data())
    assert [row.label for row in skills.rows] == ["roll", "walk"]


def test_without_results_it_says_how_they_are_made(tmp_path):
    with pytest.raises(mimoc.MimocError, match=r"\.ci/task skills"):
        shipped_skills(tmp_path)


@pytest.mark.parametrize("path", sorted(RESULTS.glob("*.json")), ids=lambda path: path.stem)
def test_shipped_results_are_of_a_skill(path):
    assert path.stem in {item.skill for item in shipped_skills().skills}


@pytest.mark.slow
@pytest.mark.parametrize("key", sorted(skill.shipped()), ids=str)
def test_what_is_shipped_has_its_skill_more_often_than_not(key):
    """In half of its starts, by a sample of six: at least one."""
    kind, age_months = key
    path = skill.shipped()[key]
    assert path.stat().st_size <= 1_000_000
    if path.suffix == ".json":
        movement = read_postures(path)
        assert (movement.task, movement.age_months) == (kind, age_months)
    keys = {"mimoc": 1, "name": "kim", "age_months": age_months, "senses": SENSES}
    env = mimoc.make(mimoc.InfantSpec(**keys, task={"kind": kind})).unwrapped
    episodes = mimoc.evaluate(env, lambda infant: skill.bind(infant, kind), episodes=6, seed=20_000)
    assert any(episode.success for episode in episodes)


def test_what_is_there_for_the_nearest_age_is_taken(tmp_path, monkeypatch):
    for name in ("roll_4_months.json", "roll_8_months.zip", "sit_up_6_months.zip"):
        (tmp_path / name).touch()
    monkeypatch.setattr(skill, "SHIPPED", tmp_path)
    assert [skill.file_of("roll", age).stem[5] for age in (1, 5.9, 6, 6.1, 24)] == ["4", "4", "4", "8", "8"]
    assert skill.file_of("sit_up", 12).name == "sit_up_6_months.zip"
    assert skill.file_of("mine.zip", 12).name == "mine.zip"
    with pytest.raises(PolicyError, match=r"walk.*\(there are: roll, sit_up\)"):
        skill.file_of("walk", 12)
