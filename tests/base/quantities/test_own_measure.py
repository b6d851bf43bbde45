"""A measure from outside is one record: then runs, recordings, cohorts and reports have it."""

import sys

import numpy as np
import pytest

import mimoc
from mimoc.base.kinds import function_of
from mimoc.base.quantities import QUANTITIES
from mimoc.policies.rollout import Run
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import worlds_of_many, worlds_of_one
from mimoc.studies.cohorts import Cohort
from mimoc.studies.cohorts.run_jobs import run_jobs
from mimoc.studies.cohorts.store import Store

STUDY = {
    "mimoc": 1,
    "cohort": "hands",
    "base": {"mimoc": 1, "name": "infant", "age_months": 9},
    "vary": {"age_months": [3, 9]},
    "do": [{"run": {"policy": "random", "steps": 5}}],
}


@pytest.fixture
def hands_apart(registered, monkeypatch, request):
    """Return the measure of the example plug-in, registered for the time of a test."""
    monkeypatch.syspath_prepend(str(request.config.rootpath / "examples" / "plugin"))
    from mimoc_nursery.hands_apart import HANDS_APART

    with registered(HANDS_APART):
        yield HANDS_APART
    for module in [name for name in sys.modules if name.startswith("mimoc_nursery")]:
        del sys.modules[module]


def test_a_run_measures_it_and_prints_it_with_its_label_and_unit(hands_apart, open_env, invoke, tmp_path):
    run = Run(env := open_env(), "random", seed=0)
    apart_lengths = []
    for _ in range(5):
        run.step()
        left_m, right_m = (env.data.body(f"{side}_hand").xpos for side in ("left", "right"))
        apart_lengths.append(100 * np.linalg.norm(left_m - right_m) / env.manifest.child.length_cm)
    assert run.summary().measures[hands_apart.name] == pytest.approx(np.mean(apart_lengths))
    mimoc.write_bundle(env.bundle, tmp_path / "infant")
    assert "Distance between the hands [lengths]" in invoke("run", str(tmp_path / "infant"), "--steps", "5").out


def test_a_recording_has_a_column_of_it_whose_schema_says_what_it_is(hands_apart, env, tmp_path):
    with mimoc.Recorder(env, tmp_path / "recording") as recorder:
        recorder.reset(seed=0)
        for _ in range(3):
            recorder.step(recorder.action_space.sample())
    (episode,) = mimoc.read_recording(tmp_path / "recording")
    column = f"measure.{hands_apart.name}"
    assert episode.measures[hands_apart.name].shape == (3,)
    assert (episode.measures[hands_apart.name] > 0).all()
    assert column in episode.columns()
    said = episode.table.schema.field(column).metadata
    assert (said[b"label"], said[b"unit"]) == (b"Distance between the hands", b"lengths")


def test_the_table_and_the_report_of_a_cohort_have_it(hands_apart, tmp_path):
    cohort, store = Cohort(STUDY), Store(tmp_path / "out")
    store.create("hands")
    run_jobs(cohort.jobs(), store)
    rows = cohort.rows(tmp_path / "out")
    assert all(row[hands_apart.name] > 0 for row in rows)
    page = mimoc.report(tmp_path / "out", tmp_path / "page.html").read_text()
    assert "Distance between the hands [lengths], run" in page


@pytest.fixture
def usual_keys() -> set[str]:
    """Return the keys of the jobs without that measure."""
    return {job.key for job in Cohort(STUDY).jobs()}


def test_a_cohort_file_can_name_it_and_its_jobs_are_others_than_without(usual_keys, hands_apart):
    named = Cohort({**STUDY, "measure": [hands_apart.name]}).jobs()
    assert usual_keys.isdisjoint(job.key for job in named)


@pytest.mark.parametrize("quantity", [item for item in QUANTITIES.values() if item.term], ids=lambda item: item.name)
def test_one_infant_measures_the_bits_of_its_row_of_many(quantity, hands_apart, open_env):
    for measured in (quantity, hands_apart):
        bind = function_of(measured.term, measured.name)
        envs = [open_env(age_months=age) for age in (3, 9, 18)]
        for seed, env in enumerate(envs):
            env.reset(seed=seed)
            env.step(env.action_space.sample())
        terms = [bind(env.model, env.manifest) for env in envs]
        datas = [env.data for env in envs]
        many = worlds_of_many(datas, lambda field, datas=datas: np.stack([getattr(data, field) for data in datas]))
        rows = stack_terms(terms)(many)
        for row, term, env in zip(rows, terms, envs, strict=True):
            np.testing.assert_array_equal(stack_terms([term])(worlds_of_one(env.data))[0], row)
