"""Thresholds are those of the age above those of adults, and each number says where it comes from."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from support import store

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler.explain import explain
from mimoc.components.senses.hearing import ADULT_DB, excess_db, threshold_table

EXCESS_DB = {(0, 500): 40, (3, 8000): 28, (6, 1000): 14, (6, 4000): 9, (12, 1000): 12, (24, 4000): 4}


def infant(**keys) -> dict:
    return {"mimoc": 1, "name": "x", "age_months": 6, "senses": {"hearing": {}}, **keys}


@pytest.mark.parametrize(("age_months", "hz"), EXCESS_DB)
def test_thresholds_are_above_adults_by_the_table(age_months, hz):
    frequencies_hz, levels_db = threshold_table("age", age_months)
    assert levels_db[frequencies_hz.index(hz)] - ADULT_DB[hz] == pytest.approx(EXCESS_DB[age_months, hz])


@given(st.floats(0, 24), st.floats(0, 24), st.floats(100, 12_000))
def test_nobody_hears_worse_when_older(one, other, hz):
    assert excess_db(max(one, other), hz) <= excess_db(min(one, other), hz) + 1e-9


def test_adults_thresholds_are_those_without_an_excess_and_off_is_none():
    assert threshold_table("adult", 0)[1] == pytest.approx(list(ADULT_DB.values()))
    assert threshold_table("off", 0) == ((), ())


def test_the_manifest_and_provenance_say_what_is_heard():
    bundle = store.built(infant())
    entry = bundle.manifest.senses.hearing
    told = explain(bundle, "hearing.threshold_db.1000_hz")
    assert f"{entry.threshold_db[entry.threshold_hz.index(1000)]:g} dB" in told.lines[0]
    assert "Olsho" in told.lines[1]
    largest = explain(bundle, "hearing.largest_time_difference_us")
    assert "Woodworth" in largest.lines[1]
    assert largest.sources[0].key == "hearing.radius_m"


def test_a_bundle_without_hearing_does_not_mention_it():
    files = store.built(infant(senses={"vestibular": {}})).files
    assert [name for name, content in files.items() if b"hearing" in content and name != "README.md"] == []


def test_a_child_whose_head_is_large_has_ears_far_apart():
    radii_m = [
        store.built(
            infant(body={"individual": {"sex": "female", "head_percentile": share}})
        ).manifest.senses.hearing.radius_m
        for share in (3, 97)
    ]
    assert np.diff(radii_m) > 0.002


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (
            {"senses": {"hearing": {"sample_rate_hz": 22_050}}},
            "a control step of 10 ms has 220.50 samples; choose another",
        ),
        ({"senses": {"hearing": {"output": "cochlea"}}}, "cochleagram"),
        ({"senses": {"hearing": {"channels": 1}}}, "4"),
        ({"senses": {}, "noise": {"hearing_db": 2}}, "'hearing' is off, so it has no noise"),
        ({"senses": {}, "delays": {"hearing_ms": 5}}, "'hearing' is off, so it has no delay"),
    ],
)
def test_what_cannot_be_heard_is_refused(keys, message):
    with pytest.raises(SpecError, match=message):
        mimoc.InfantSpec.model_validate(infant(**keys))


def test_its_delay_by_age_is_that_of_the_brainstem():
    fine = infant(delays={"preset": "physiological"}, control={"timestep_ms": 0.5})
    assert store.built(fine).manifest.delays.hearing.ms == 6.0
    newborn = {**fine, "age_months": 0}
    assert store.built(newborn).manifest.delays.hearing.ms == 7.0
