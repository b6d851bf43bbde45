"""A quantity is one record: its label and unit, how it is measured, and what a measure from outside needs."""

import ast
import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import KindError
from mimoc.base.kinds import function_of
from mimoc.base.quantities import HIP_PATH, QUANTITIES, Quantity, measures, quantity_of
from mimoc.policies.rollout import Run
from mimoc.runtime.quantities import REDUCERS, EpisodeResult, StepMeasures, hip_path_m, measure
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import worlds_of_many, worlds_of_one
from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.run_jobs import run_jobs
from mimoc.studies.cohorts.store import Store
from mimoc.training.curve import CurvePoint

ROOT = Path(mimoc.__file__).parent
READERS = sorted(
    path for folder in ("studies/reporting", "studies/cohorts", "cli") for path in (ROOT / folder).rglob("*.py")
)
UNIT = re.compile(r"[A-Za-z] \[(?!build|default)[^\[\]{}`'|]{1,16}\]")
SUFFIXES = {"cm": "cm", "kg": "kg", "s": "s", "m": "m", "rad/s": "rad_s", "J/kg": "j_per_kg", "°": "deg"}


def texts(path: Path) -> list[str]:
    """Return the strings of a module but for docstrings."""
    tree = ast.parse(path.read_text())
    docs = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docs
    ]


def test_no_reader_of_quantities_has_a_unit_in_brackets():
    assert not [(path.name, text) for path in READERS for text in texts(path) if UNIT.search(text)]


def test_the_pattern_finds_units():
    assert all(map(UNIT.search, ("Length [cm]", "speed [rad/s]", "share [%]", "Beyond [°]", "Steps [control steps]")))


def test_the_name_of_a_quantity_ends_with_its_unit():
    for quantity in QUANTITIES.values():
        if quantity.unit in SUFFIXES:
            assert quantity.name.endswith(f"_{SUFFIXES[quantity.unit]}"), quantity.name


def test_every_quantity_says_what_it_is():
    assert all(quantity.about and quantity.label[0].isupper() for quantity in QUANTITIES.values())


def test_every_measure_of_a_run_has_at_most_one_way_to_be_measured():
    for quantity in measures().values():
        assert sum(map(bool, (quantity.term, quantity.read, quantity.field))) <= 1, quantity.name


def test_columns_of_learning_curves_are_those_of_rows():
    fields = set(CurvePoint.__dataclass_fields__)
    assert {quantity.curve for quantity in QUANTITIES.values() if quantity.curve} == fields - {"wall_s"}


def test_what_is_no_quantity_is_called_by_its_name():
    assert quantity_of("joint_speed_rad_s").title == "Joint speed [rad/s]"
    assert quantity_of("what_the_policy_says").title == "What the policy says"


EPISODES = (EpisodeResult(1.5, 10, True, 0.1), EpisodeResult(-0.5, 30, False, 0.3))


def test_what_came_of_episodes_is_reduced_by_quantity():
    assert measure("episode", "run", EPISODES) == {
        "return": 0.5,
        "success": 0.5,
        "time_to_success_s": 0.1,
        "episodes": 2,
    }


def test_means_of_nothing_are_none_and_counts_zero():
    assert set(measure("episode", "train", ()).values()) == {None, 0}


def test_a_path_is_as_long_as_its_pieces():
    assert REDUCERS["path"]([np.zeros(3), np.array([3.0, 4.0, 0.0]), np.array([3.0, 4.0, 1.0])]) == 6.0


def test_a_step_is_read_as_the_infant_is_then_also_after_it_has_grown():
    heights_m = []
    with mimoc.make(mimoc.InfantSpec(mimoc=1, name="infant", age_months=9)) as opened:
        env = opened.unwrapped
        opened.reset(seed=0)
        measures = StepMeasures(env, "run")
        for age_months in (9, 12):
            env.grow(to=age_months)
            *_, info = env.step(env.action_space.sample())
            assert measures.read(info)["head_height_m"] == env.data.body("head").xipos[2]
            measures.add(info)
            heights_m.append(float(env.data.body("head").xipos[2]))
    assert measures.measures()["head_height_m"] == max(heights_m)


def test_a_quantity_that_measures_more_than_a_number_is_refused_in_one_line(open_env, registered):
    places = replace(HIP_PATH, name="hip_place_m", reduce="mean", term=hip_path_m)
    message = r"^'hip_place_m' measures an array of shape \(3,\) of an infant; return a number, or .*'path'$"
    with registered(places), pytest.raises(KindError, match=message):
        StepMeasures(open_env(), "run")


def test_a_quantity_over_what_has_no_such_field_is_refused_in_one_line(registered):
    smiles = Quantity("smiles", "Smiles", over="episode", steps=("run",))
    message = r"^the quantity 'smiles' is over episode: EpisodeResult, which has no 'smiles'; name a field of it$"
    with registered(smiles), pytest.raises(KindError, match=message):
        measure("episode", "run", EPISODES)


def test_points_have_no_column_in_a_recording(open_env, registered):
    way = replace(HIP_PATH, name="way_m", term=hip_path_m, steps=("record",))
    with registered(way):
        assert StepMeasures(open_env(), "record").read({}) == {}


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
