"""Results of skills that come with mimoc, and the movements that do."""

import json

import pytest

import mimoc
from mimoc.base.errors import PolicyError
from mimoc.policies import skill
from mimoc.policies.postures import read_postures
from mimoc.schema.kinds import SKILLS
from mimoc.studies.skills.learning import RESULTS, AgeResult, Attempt, SkillReport, shipped_skills

SENSES = {"proprioception": {"include": ["velocity"]}, "vestibular": {}}


def report(kind: str, success: dict[float, float]) -> SkillReport:
    results = [AgeResult.of([Attempt(age_months=a, seed=0, success=s, starts=20)]) for a, s in success.items()]
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
