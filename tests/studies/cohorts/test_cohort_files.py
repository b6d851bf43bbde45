"""What a user reads who wrote something wrong in a cohort file: golden texts, in `__snapshots__`."""

import pytest

from mimoc.base.errors import SpecError
from mimoc.base.quantities import measures
from mimoc.schema import source
from mimoc.schema.cohort_file import COHORT, CohortSpec
from mimoc.schema.outline import language_of
from mimoc.schema.reading import read_keys
from mimoc.studies.cohorts.cohort import Cohort, plan

HEAD = "mimoc: 1\ncohort: spring\nbase: {mimoc: 1, name: x, age_months: 9}\n"
DO = "do: [build]\n"

ISSUE = """mimoc: 1
cohort: spring
base: nine_months.yaml
children: {draw: 100, sex: both, seed: 7}
vary:
  age_months: [0, 3, 6, 9, 12, 18, 24]
  delays.preset: [none, physiological]
design: grid
do:
  - {run: {policy: random, steps: 1000, seeds: 0:3}}
  - {train: {algo: ppo, steps: 200_000, seeds: 0:3}}
measure: [length_cm, mass_kg, return, success, time_to_success_s, contacts_self]
"""

FILES = {
    "an empty file": "",
    "nothing that is needed": "vary: {}\n",
    "a newer language": HEAD.replace("mimoc: 1\n", "mimoc: 2\n", 1) + DO,
    "a name that is no name, and no step": HEAD.replace("spring", "Spring 7") + "do: []\n",
    "a base that does not exist": HEAD.replace("{mimoc: 1, name: x, age_months: 9}", "nowhere.yaml") + DO,
    "a base that is no spec": HEAD.replace("{mimoc: 1, name: x, age_months: 9}", "3") + DO,
    "a base with mistakes, and others": "mimoc: 1\ncohort: s\nbase:\n  mimoc: 1\n  name: X\n  age_month: 9\n"
    + "chidren: 3\n"
    + DO,
    "unknown keys": HEAD
    + "childen: {draw: 3}\nchildren: {drawn: 3, seeds: 3}\nvarying: {}\ndesigns: grid\nmeasures: []\n"
    + "do: [{run: {step: 3}}, {walk: {}}]\n",
    "children that are none": HEAD + "children: 100\n" + DO,
    "an empty list of children": HEAD + "children: []\n" + DO,
    "too few children": HEAD + "children: {draw: 0, sex: girls, seed: -1}\n" + DO,
    "individuals with mistakes": HEAD
    + "children: [{sex: male, length_percentile: 200}, {sexx: male}, {sex: male}]\n"
    + DO,
    "keys that a spec does not have": HEAD
    + "vary: {age: [3], delays.presett: [none], body.hand: [mitten], age_months.x: [1], name: [a], mimoc: [1]}\n"
    + DO,
    "values that are none": HEAD + "vary: {age_months: 3, scene.seed: [], body.hands: mitten, scene.kind: {}}\n" + DO,
    "ranges": HEAD + "vary: {age_months: {from: 9, to: 3, step: 1}, scene.seed: {from: 0, to: 9, step: 0}}\n" + DO,
    "draws": HEAD
    + "vary: {age_months: {uniform: [9, 3], n: 3}, noise.motor: {normal: [1, 0], n: 3},\n"
    + "  scene.seed: {log_uniform: [0, 9], n: 3}, control.step_ms: {uniform: [1, 2], normal: [1, 2], n: 1}}\n"
    + DO,
    "draws without a number in a grid": HEAD + "vary: {age_months: {uniform: [3, 9]}}\n" + DO,
    "draws with a number in a sample": HEAD
    + "vary: {age_months: {uniform: [3, 9], n: 3}}\ndesign: {sample: {n: 9}}\n"
    + DO,
    "values and children that are there twice": HEAD
    + "vary: {age_months: [3, 9, 3], body.hands: [mitten]}\n"
    + "children: [{sex: male, length_percentile: 9}, {sex: male, length_percentile: 9}]\n"
    + DO,
    "designs": HEAD + "design: gird\n" + DO,
    "a design of a list": HEAD + "design: [grid]\n" + DO,
    "a sample without a size": HEAD + "design: {sample: {seed: 1}}\n" + DO,
    "the child twice": HEAD + "children: {draw: 3}\nvary: {body.individual.sex: [male]}\n" + DO,
    "a section and a key in it": HEAD + "vary: {delays: [{preset: none}], delays.motor_ms: [5]}\n" + DO,
    "steps": HEAD
    + "do: [biuld, python, 3, {}, {run: {}, train: {}}, {python: own.probe}, {experiment: 3},\n"
    + "  {train: {algo: ppp, steps: 0, envs: 5000}}, {run: {steps: many, seeds: 3:0}}, {run: {seeds: [1, 1]}},\n"
    + "  {run: {seeds: x}}]\n",
    "hyperparameters and options": HEAD
    + "do: [{train: {hyper: {gamma: x, n_steps: [1], width: true}}},\n"
    + "  {python: {function: own:probe, options: {a: [1], b: {c: 1}, d: 1.5}}}]\n",
    "measures": HEAD + DO + "measure: [length, weight_kg, own:probe, own]\n",
}


@pytest.mark.parametrize("what", FILES)
def test_a_bad_cohort_file_is_told_all_at_once(what, snapshot):
    with pytest.raises(SpecError) as caught:
        Cohort(source.parse(FILES[what], "cohort.yaml", COHORT))
    assert str(caught.value) == snapshot


@pytest.mark.extras
def test_steps_that_name_what_is_not_there_are_told_before_anything_is_done(tmp_path, snapshot):
    steps = (
        "do: [{run: {policy: rnadom}}, {experiment: grwoth}, {train: {hyper: {n_step: 3}}},\n"
        "  {train: {hyper: {gamma: 3}}}, {train: {grow: 12:6}}, {train: {grow_steps: 9}}]\n"
    )
    study = Cohort(source.parse(HEAD + steps, "cohort.yaml", COHORT))
    for do in (study.run, study.retry, lambda out: plan(study, out)):
        (tmp_path / "cohort.json").write_text('{"cohort": "spring", "version": 1}')
        with pytest.raises(SpecError) as caught:
            do(tmp_path)
    assert str(caught.value) == snapshot
    assert [path.name for path in tmp_path.iterdir()] == ["cohort.json"]


def test_a_cohort_of_too_many_infants_is_refused_before_they_are_made():
    keys = "vary: {age_months: {from: 0, to: 24, step: 0.001}, scene.seed: {from: 0, to: 99999, step: 1}}\n"
    study = Cohort(source.parse(HEAD + keys + DO, "cohort.yaml", COHORT))
    with pytest.raises(SpecError, match=r"cohort\.yaml:1:1: 2,400,100,000 infants are more than 1,000,000; give fewer"):
        study.jobs()


def test_the_file_of_the_issue_is_a_cohort():
    spec = read_keys(CohortSpec, source.parse(ISSUE, "cohort.yaml"))
    assert (spec.cohort, spec.children.draw, len(spec.do)) == ("spring", 100, 2)
    assert spec.do[1].train.steps == 200_000
    assert spec.do[0].run.seeds == (0, 1, 2)


def test_a_cohort_can_be_made_in_python():
    study = Cohort({"mimoc": 1, "cohort": "s", "base": {"mimoc": 1, "name": "x", "age_months": 9}, "do": ["build"]})
    assert [job.step for job in study.jobs()] == ["build"]
    with pytest.raises(SpecError, match="<cohort>: do: is missing"):
        Cohort({"mimoc": 1, "cohort": "s", "base": {"mimoc": 1, "name": "x", "age_months": 9}})


def test_every_key_and_measure_is_described():
    language = language_of(CohortSpec)
    assert all(language.outline((key,)).schema.get("description") or key == "base" for key in language.outline(()).keys)
    assert all(quantity.about for quantity in measures().values())
