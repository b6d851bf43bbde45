"""The same child at another age, whether its spec gives percentiles or what was measured at one age."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.full import FULL

import mimoc
from mimoc.base.errors import SpecError
from mimoc.body.measurements import targets
from mimoc.bundle.model import load_model
from mimoc.compiler.variants import SpecVariants
from mimoc.fits import load_tables, measure
from mimoc.fits.standards import percentile
from mimoc.schema import InfantSpec, read_spec
from mimoc.schema.body import INDICATORS
from mimoc.schema.source import parse
from mimoc.studies.growth import compare_with_anthrokids, grow_against_who
from mimoc.studies.milestones import validate_milestones
from mimoc.studies.milestones.trial import Conditions

BY_CM = {"sex": "male", "length_cm": 66.0, "weight_kg": 7.2, "head_circumference_cm": 43.1}
ATTEMPTED = "leg_lift"


def child(age_months: float = 7, **individual) -> InfantSpec:
    return InfantSpec.model_validate(
        {"mimoc": 1, "name": "kim", "age_months": age_months, "body": {"individual": individual}}
    )


def by_percentile(spec: InfantSpec) -> InfantSpec:
    individual, who = spec.body.individual, load_tables().who
    scores = {key: who[key].z_score(getattr(individual, key), spec.age_months, individual.sex) for key in INDICATORS}
    found = {INDICATORS[key]: percentile(z) for key, z in scores.items()}
    return child(spec.age_months, sex=individual.sex, **found)


ages = st.floats(0, 24)


@settings(max_examples=50)
@given(before=ages, after=ages, sex=st.sampled_from(["male", "female"]), z=st.tuples(*[st.floats(-3, 3)] * 3))
def test_a_measured_child_is_at_every_age_what_it_is_by_percentile(before, after, sex, z):
    who = load_tables().who
    cm = {key: who[key].value(score, before, sex) for key, score in zip(INDICATORS, z, strict=True)}
    measured = child(before, sex=sex, **cm)
    found, expected = (
        targets(spec.with_(age_months=after).body.individual, after) for spec in (measured, by_percentile(measured))
    )
    for key in ("length_m", "weight_kg", "head_m"):
        assert getattr(found, key) == pytest.approx(getattr(expected, key), rel=1e-7)


@pytest.mark.full
def test_the_same_child_by_cm_and_by_percentile_is_the_same_bundle_at_other_ages():
    measured = child(**BY_CM)
    kept = {"looks": {"clothes": measured.clothes}}  # As it grows.
    for age_months in (0, 7, 16.5, 24):
        one, other = (
            mimoc.build(spec.with_(age_months=age_months, body=kept)) for spec in (measured, by_percentile(measured))
        )
        for name in ("length_cm", "weight_kg", "head_circumference_cm", "arm_circumference_cm"):
            found, expected = getattr(one.manifest.child, name), getattr(other.manifest.child, name)
            assert found == pytest.approx(expected, rel=1e-7), name
        models = [load_model(bundle) for bundle in (one, other)]
        for field in ("body_mass", "body_pos", "geom_size", "actuator_gear", "jnt_range"):
            assert np.allclose(*(getattr(model, field) for model in models), rtol=1e-6, atol=1e-9), field
        grown = SpecVariants(child(**BY_CM))(age_months, 0).bundle
        assert grown.files["infant.xml"] == one.files["infant.xml"]


@FULL
def test_every_validation_says_the_same_of_a_child_by_cm_and_by_percentile():
    one, other = child(**BY_CM), by_percentile(child(**BY_CM))
    who = [grow_against_who(spec, (0, 24)) for spec in (one, other)]
    assert [row.missed for row in who[0].rows] == [row.missed for row in who[1].rows]
    assert [row.value for row in who[0].rows] == pytest.approx([row.value for row in who[1].rows], rel=1e-7)
    surveys = [compare_with_anthrokids(spec) for spec in (one, other)]
    assert surveys[0].within_tolerance
    deviations = [[row.deviation for row in survey.rows] for survey in surveys]
    assert deviations[0] == pytest.approx(deviations[1], abs=1e-6)
    trials = [
        validate_milestones(spec, Conditions(), names=[ATTEMPTED], ages=[0, 24]).to_data()["milestones"]
        for spec in (one, other)
    ]
    assert [tried["success"] for tried in trials[0][0]["tried"]] == [
        tried["success"] for tried in trials[1][0]["tried"]
    ]
    assert [tried["age_months"] for tried in trials[0][0]["tried"]] == [0, 24]


def test_what_changes_are_given_for_another_age_is_of_that_age():
    older = child(**BY_CM).with_(age_months=np.int64(12), body={"individual": {"weight_kg": 9.0}})
    assert older.body.individual
    assert older.body.individual.weight_kg == 9.0
    assert 70 < older.body.individual.length_cm < 74
    whole = child(**BY_CM).with_(age_months=12, body=mimoc.schema.BodySpec())
    assert whole.body.individual is None


def test_a_single_measurement_keeps_its_ratio_to_the_average_child():
    body = {"measurements": {"left_forearm_circumference_cm": 15.0}, "parts": {"head": {"girth": 1.1}}}
    older = InfantSpec.model_validate({"mimoc": 1, "name": "kim", "age_months": 7, "body": body}).with_(age_months=20)
    ratio = measure(20)["forearm_circumference"] / measure(7)["forearm_circumference"]
    assert older.body.measurements == {"left_forearm_circumference_cm": pytest.approx(15.0 * ratio)}
    assert older.body.parts["head"].girth == 1.1


def test_what_is_said_twice_is_still_one_child_at_another_age():
    """A measurement would keep its ratio, the individual its percentile: the individual counts."""
    individual = {"sex": "female", "length_percentile": 50, "length_cm": 70.1}
    body = {"individual": individual, "measurements": {"crown_sole_length_cm": 70.1}}
    older = InfantSpec.model_validate({"mimoc": 1, "name": "kim", "age_months": 9, "body": body}).with_(age_months=20)
    assert older.body.individual
    assert older.body.individual.length_percentile is None
    assert older.body.measurements == {}
    assert older.body.individual.length_cm == pytest.approx(82.6, abs=0.2)


@pytest.mark.parametrize("age_months", [True, "nine", 30, -1, float("nan"), None])
def test_an_age_that_is_none_is_refused_as_for_any_spec(age_months):
    with pytest.raises(SpecError, match="age_months"):
        child(**BY_CM).with_(age_months=age_months)


EXTREME = """\
mimoc: 1
name: kim
age_months: 7
body:
  individual: {length_cm: 52.5}
"""
"""As small for its age as there are children; with the same z-score, none is born."""


@pytest.mark.parametrize(
    "ask",
    [
        grow_against_who,
        compare_with_anthrokids,
        lambda spec: validate_milestones(spec, Conditions(), names=[ATTEMPTED], ages=[0, 7]),
        lambda spec: SpecVariants(spec)(0.0, 0),
    ],
    ids=["who", "anthrokids", "milestones", "grow"],
)
def test_an_error_that_concerns_another_age_says_which_and_where(ask):
    with pytest.raises(SpecError) as refused:
        ask(read_spec(parse(EXTREME, "kim.yaml")))
    assert str(refused.value).startswith("kim.yaml:5:15: body.individual: at ")
    assert " months: a child of this age is not " in str(refused.value)
    assert str(refused.value).endswith("; leave this age out, or give what is nearer to the average child of 7 months")
