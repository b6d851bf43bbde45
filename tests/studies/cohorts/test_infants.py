"""Which infants a cohort has, and which jobs."""

from pathlib import Path
from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.base.errors import SpecError
from mimoc.body.measurements import targets
from mimoc.fits import load_tables
from mimoc.schema.cohort_file import DrawnChildren
from mimoc.studies.cohorts.infants import CORRELATIONS, FAT_BUILD, PERCENTILES, RATE_SD, build_z, draw_children

BASE = {"mimoc": 1, "name": "infant", "age_months": 9}


def values(cohort, key):
    return [infant.factors[key] for infant in cohort.infants]


def test_a_grid_has_every_child_with_every_value(cohort):
    study = cohort(children={"draw": 2}, vary={"age_months": [3, 6], "delays.preset": ["none", "physiological"]})
    assert values(study, "child") == [0] * 4 + [1] * 4
    assert values(study, "age_months") == [3, 3, 6, 6] * 2
    assert values(study, "delays.preset") == ["none", "physiological"] * 4
    assert [spec.delays.preset for spec in study.specs[:2]] == ["none", "physiological"]


def test_zip_goes_through_all_lists_in_parallel_for_each_child(cohort):
    study = cohort(children={"draw": 2}, vary={"age_months": [3, 6], "scene.seed": [1, 2]}, design="zip")
    assert [(infant.factors["age_months"], infant.factors["scene.seed"]) for infant in study.infants] == [
        (3, 1),
        (6, 2),
    ] * 2


def test_a_sample_has_as_many_infants_as_it_says_and_depends_on_its_seed(cohort):
    keys = {"children": {"draw": 5}, "vary": {"age_months": {"uniform": [0, 24]}, "scene.seed": [1, 2]}}
    samples = [cohort(**keys, design={"sample": {"n": 20, "seed": seed}}) for seed in (1, 1, 2)]
    factors = [[infant.factors for infant in sample.infants] for sample in samples]
    assert len(factors[0]) == 20
    assert factors[0] == factors[1] != factors[2]
    assert len(set(values(samples[0], "age_months"))) == 20
    assert set(values(samples[0], "scene.seed")) == {1, 2}


@pytest.mark.parametrize(
    ("levels", "expected"),
    [
        ({"from": 0, "to": 1, "step": 0.25}, [0, 0.25, 0.5, 0.75, 1]),
        ({"from": 0, "to": 0.3, "step": 0.1}, [0, 0.1, 0.2, 0.3]),
        ({"from": 3, "to": 10, "step": 3}, [3, 6, 9]),
    ],
)
def test_a_range_has_decimal_values_up_to_its_end(cohort, levels, expected):
    assert values(cohort(vary={"age_months": levels}), "age_months") == expected


def test_draws_stay_within_their_distribution(cohort):
    drawn = {"age_months": {"uniform": [3, 6], "n": 50}, "body.hands": ["mitten"]}
    assert all(3 <= age <= 6 for age in values(cohort(vary=drawn), "age_months"))
    stepped = cohort(vary={"scene.seed": {"log_uniform": [10, 1000], "step": 5, "n": 9}})
    assert all(seed % 5 == 0 and 10 <= seed <= 1000 for seed in values(stepped, "scene.seed"))
    normal = cohort(vary={"noise.motor": {"normal": [0.3, 0.01], "n": 20, "seed": 4}})
    assert sum(values(normal, "noise.motor")) / 20 == pytest.approx(0.3, abs=0.01)


def test_a_child_stays_on_its_percentiles_as_it_ages(cohort):
    """A measured child as well: its weight in [kg] grows along its percentile."""
    study = cohort(children=[{"sex": "male", "weight_kg": 8.0, "length_percentile": 30}], vary={"age_months": [9, 18]})
    nine, eighteen = (spec.body.individual for spec in study.specs)
    assert (nine.weight_kg, nine.length_percentile, eighteen.length_percentile) == (8.0, 30, 30)
    weight = load_tables().who["weight_kg"]
    assert weight.z_score(eighteen.weight_kg, 18, "male") == pytest.approx(weight.z_score(8.0, 9, "male"), abs=1e-6)


def test_a_value_that_the_spec_does_not_allow_is_reported_where_it_stands(cohort):
    with pytest.raises(SpecError) as caught:
        _ = cohort(vary={"age_months": [3, 99], "body.hands": ["fist", "mitten"]}).infants
    lines = [str(problem).partition("cohort.yaml:")[2] for problem in caught.value.problems]
    assert [line.partition(": ")[2] for line in lines] == [
        "vary.age_months[1]: 99 is too large; give 0 to 24 months",
        "vary.body.hands[0]: 'fist' is not a choice; choose from five_finger, mitten",
    ]
    assert len({line.partition(": ")[0] for line in lines}) == 2


def test_a_section_that_is_none_is_not_hidden_by_the_child(cohort):
    with pytest.raises(SpecError, match=r"vary\.body\[0\]: 3 is not a section"):
        _ = cohort(children={"draw": 1}, vary={"body": [3]}).infants


def test_lists_of_different_length_are_not_zipped(cohort):
    with pytest.raises(SpecError, match=r"equally many values of each key, got age_months 2, scene.seed 3"):
        _ = cohort(vary={"age_months": [3, 6], "scene.seed": [1, 2, 3]}, design="zip").infants


def test_equal_jobs_have_equal_names_wherever_the_cohort_file_is(cohort, tmp_path):
    jobs = cohort(vary={"age_months": [3, 6]}).jobs()
    moved = tmp_path / "elsewhere"
    moved.mkdir()
    (moved / "other.yaml").write_bytes((tmp_path / "cohort.yaml").read_bytes())
    assert [job.key for job in mimoc.read_cohort(moved / "other.yaml").jobs()] == [job.key for job in jobs]


def test_a_job_is_named_by_all_that_it_does(cohort, monkeypatch, tmp_path):
    (tmp_path / "own.py").write_text("def probe(work):\n    return {}\n")

    usual = {"do": ["check", {"run": {"seeds": "0:2"}}, {"python": "own:probe"}]}

    def keys(**changes):
        return {job.key for job in cohort(**usual | changes).jobs()}

    before = keys()
    assert len(before) == 4
    assert keys(cohort="another", measure=["length_cm"]) == before
    assert not keys(vary={"age_months": [9.5]}) & before
    assert len(keys(do=["check", {"run": {"seeds": "0:3"}}, {"python": "own:probe"}]) & before) == 4
    assert len(keys(do=["check", {"run": {"seeds": "0:2", "steps": 7}}, {"python": "own:probe"}]) & before) == 2
    (tmp_path / "own.py").write_text("def probe(work):\n    return {'x': 1}\n")
    assert len(keys() & before) == 3
    monkeypatch.setattr("mimoc.studies.cohorts.job.__version__", "99")
    assert not keys() & before


def test_steps_that_bring_their_own_infants_are_done_once(cohort):
    study = cohort(children={"draw": 3}, do=["check", {"experiment": "growth"}])
    assert [job.step for job in study.jobs()].count("experiment") == 1


def test_the_example_is_a_cohort():
    study = mimoc.read_cohort(Path(__file__).parents[3] / "examples" / "cohort" / "spring.yaml")
    assert len(study.jobs()) == 8 * 3 * 5


def test_a_cohort_is_the_population_of_a_vector_environment(cohort):
    study = cohort(children={"draw": 2}, vary={"age_months": [3, 6]})
    envs = mimoc.make_vec(study, threads=1)
    envs.close()
    assert [infant.age_months for infant in envs.infants] == [3, 6, 3, 6]


@pytest.mark.parametrize(
    "body", [{"individual": {"sex": "male", "length_cm": 72.0}}, {"measurements": {"hand_length_cm": 9}}]
)
def test_the_child_of_the_base_grows_as_any_spec_does(cohort, body):
    """Measures of the base are of the base's age; a varied measure is of the age that is varied with it."""
    base = mimoc.InfantSpec.model_validate({**BASE, "body": body})
    study = cohort(base={**BASE, "body": body}, vary={"age_months": [0, 9, 24]})
    assert [spec.body for spec in study.specs] == [base.with_(age_months=age).body for age in (0, 9, 24)]
    varied = cohort(
        base={**BASE, "body": body},
        vary={"age_months": [0, 24], "body.measurements.foot_length_cm": [7, 13]},
        design="zip",
    )
    assert [spec.body.measurements["foot_length_cm"] for spec in varied.specs] == [7, 13]


def test_listed_children_that_contradict_themselves_or_the_base_are_refused_where_they_stand(cohort):
    base = {**BASE, "body": {"measurements": {"head_circumference_cm": 44}}}
    children = [{"sex": "male", "length_percentile": 50, "length_cm": 80}, {"head_circumference_cm": 46}]
    with pytest.raises(SpecError) as caught:
        _ = cohort(base=base, children=children, vary={"age_months": [24]}).infants
    assert [problem.key for problem in caught.value.problems] == ["children[0].length_cm", "children[1]"]


SAME = {
    "whole and not": ([6, 6.0], {}),
    "an exponent": ([6, 60e-1], {}),
    "NumPy": ([6, 7, np.float64(6)], {}),
    "NumPy's integers": ([np.int64(6), 6.0], {}),
    "an array": (np.array([6, 7, 6]), {}),
    "digits that no file holds": ([6, 6 + 1e-12], {}),
    "rows in parallel": ([6, 7, 6.0], {"body.hands": ["mitten", "mitten", "mitten"]}),
    "a range": ({"from": 6, "to": 6.0000001, "step": 1e-10}, {}),
}


@pytest.mark.parametrize("case", SAME)
def test_one_infant_twice_is_refused_however_its_values_are_written(case):
    ages, others = SAME[case]
    keys = {"mimoc": 1, "cohort": "small", "base": BASE, "do": ["build"], "vary": {"age_months": ages, **others}}
    with pytest.raises(SpecError, match=r"there twice; leave one of the two out|neighbours are equal"):
        mimoc.Cohort({**keys, **({"design": "zip"} if others else {})})


def test_sections_are_equal_whatever_the_order_of_their_keys():
    delays = [{"motor_ms": 5, "preset": "none"}, {"preset": "none", "motor_ms": 5.0}]
    with pytest.raises(SpecError, match="there twice"):
        mimoc.Cohort({"mimoc": 1, "cohort": "small", "base": BASE, "do": ["build"], "vary": {"delays": delays}})


def test_equal_values_in_different_rows_and_large_seeds_are_different_infants():
    keys = {"mimoc": 1, "cohort": "small", "base": BASE, "do": ["build"]}
    rows = {"age_months": [6, 6.0], "body.hands": ["mitten", "five_finger"]}
    assert len(mimoc.Cohort({**keys, "vary": rows, "design": "zip"}).infants) == 2
    assert len(mimoc.Cohort({**keys, "vary": {"scene.seed": [2**31 - 2, 2**31 - 1]}}).infants) == 2
    assert len(mimoc.Cohort({**keys, "vary": {"body.skin": [True, False], "scene.seed": [0, 1]}}).infants) == 4


MANY = 2000
Z = {"length_cm": 0, "weight_kg": 1, "head_circumference_cm": 2}


@pytest.fixture(scope="module")
def population():
    return draw_children(DrawnChildren(draw=MANY, seed=3))


@pytest.mark.parametrize("age_months", [0, 2, 9, 24])
@pytest.mark.parametrize("sex", ["female", "male"])
def test_the_drawn_population_has_the_means_and_deviations_of_who(population, age_months, sex):
    """At every age, in the transformed measures in which WHO's distributions are normal; within 4 standard errors."""
    children = [targets(child, age_months) for child in population if child.sex == sex]
    measures = {
        "length_cm": [100 * child.length_m for child in children],
        "weight_kg": [child.weight_kg for child in children],
        "head_circumference_cm": [100 * child.head_m for child in children],
    }
    for indicator, values in measures.items():
        z = np.array([load_tables().who[indicator].z_score(value, age_months, sex) for value in values])
        assert abs(z.mean()) < 4 / np.sqrt(len(z)), indicator
        assert z.std() == pytest.approx(1, abs=4 / np.sqrt(2 * len(z))), indicator


@pytest.mark.parametrize("sex", ["female", "male"])
def test_the_drawn_population_has_the_median_and_the_spread_of_who_in_centimetres(population, sex):
    lengths_cm = [100 * targets(child, 12).length_m for child in population if child.sex == sex]
    standard = load_tables().who["length_cm"]
    median, above = standard.value(0, 12, sex), standard.value(1, 12, sex)
    assert np.mean(lengths_cm) == pytest.approx(median, abs=4 * (above - median) / np.sqrt(len(lengths_cm)))
    assert np.std(lengths_cm) == pytest.approx(above - median, rel=0.07)


def test_length_weight_and_head_are_correlated_as_documented(population):
    z = [scores(population, name) for name in PERCENTILES]
    assert np.corrcoef(z) == pytest.approx(CORRELATIONS, abs=0.06)


@given(st.integers(1, 30), st.integers(0, 2**32 - 1))
def test_a_child_is_the_same_however_many_are_drawn(number, seed):
    few, more = (draw_children(DrawnChildren(draw=count, seed=seed)) for count in (number, number + 3))
    assert more[:number] == few


def test_girls_and_boys_take_turns_and_seeds_differ():
    assert [child.sex for child in draw_children(DrawnChildren(draw=4))] == ["female", "male", "female", "male"]
    assert {child.sex for child in draw_children(DrawnChildren(draw=4, sex="male"))} == {"male"}
    assert draw_children(DrawnChildren(draw=1)) != draw_children(DrawnChildren(draw=1, seed=1))


def test_what_else_differs_is_drawn_after_the_size(population):
    """Child 0 of seed 1 has had these percentiles from the first release on."""
    sizes = draw_children(DrawnChildren(draw=MANY, seed=3, sizes_only=True))
    kept = {"fat_percentile", "maturation_rate"}
    assert [child.model_dump(exclude=kept) for child in population] == [
        child.model_dump(exclude=kept) for child in sizes
    ]
    assert all(child.fat_percentile is None and child.maturation_rate is None for child in sizes)
    (first,) = draw_children(DrawnChildren(draw=1, seed=1, sizes_only=True))
    assert (first.length_percentile, first.weight_percentile) == (59.9782018, 97.5737518)


def test_fat_goes_with_weight_for_length_and_the_rate_with_nothing(population):
    z = {name: scores(population, name) for name in (*PERCENTILES, "fat_percentile")}
    build = build_z(z["length_percentile"], z["weight_percentile"])
    rate = np.log([child.maturation_rate for child in population])
    margin = 4 / np.sqrt(MANY)
    assert np.corrcoef(z["fat_percentile"], build)[0, 1] == pytest.approx(FAT_BUILD, abs=margin)
    assert abs(np.corrcoef(z["fat_percentile"], z["length_percentile"])[0, 1]) < margin
    for other in (*z.values(), [child.sex == "male" for child in population]):
        assert abs(np.corrcoef(rate, other)[0, 1]) < margin
    assert np.std(rate) == pytest.approx(RATE_SD, rel=0.07)
    assert np.mean(np.exp(-rate)) == pytest.approx(1, abs=4 * RATE_SD / np.sqrt(MANY))


def scores(population, name):
    return np.array([NormalDist().inv_cdf(getattr(child, name) / 100) for child in population])
