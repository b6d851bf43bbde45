from itertools import pairwise
from typing import get_args

import numpy as np
import pytest

import mimoc
from mimoc.compiler.explain import entries_of
from mimoc.components.senses.vision import VisionEntry, VisionSpec, build as maturity
from mimoc.components.senses.vision.build import (
    MAYER_1995_CPD,
    MIMO_V2_CPD,
    NEWBORN_CPD,
    PROFILES,
    acuity_at,
    resolve_acuity,
)
from mimoc.components.senses.vision.thresholds import sensitivity_at

SALOMAO_1995_CPD = {2: 2.31, 3: 3.09, 4: 4.15, 6: 7.18, 8: 8.31, 10: 10.88, 12: 9.82, 18: 9.95, 24: 12.31, 30: 14.12}
"""Monocular, Salomão & Ventura 1995."""
CARDS_TO_TAC2 = 2**-0.3
"""From the scale of the Teller Acuity Cards to that of their second edition (Neijzen et al. 2025)."""
MONTHS = np.linspace(0, 24, 97)


def vision(**keys) -> VisionSpec:
    return VisionSpec.model_validate(keys)


def test_the_profiles_are_those_of_the_schema():
    assert tuple(PROFILES) == get_args(VisionSpec.model_fields["acuity_profile"].annotation)


@pytest.mark.parametrize(("months", "cpd"), [(1, 0.66), (3, 2.28), (6, 4.25), (12, 7.0), (24, 10.2), (36, 12.0)])
def test_tac2_is_what_the_fit_gives(months, cpd):
    """Worked out by hand from its three figures."""
    assert acuity_at(months, "tac2") == pytest.approx(cpd, rel=0.01)


def test_tac2_is_as_near_to_its_sources_as_they_are_to_each_other():
    sources = [*MAYER_1995_CPD.items(), *SALOMAO_1995_CPD.items()]
    octaves = [np.log2(acuity_at(months, "tac2") / (CARDS_TO_TAC2 * cpd)) for months, cpd in sources if months <= 36]
    assert np.sqrt(np.mean(np.square(octaves))) < 0.4


def test_tac2_begins_with_a_newborn_and_meets_the_fit_at_one_month():
    first_month = [acuity_at(months, "tac2") for months in (0, 0.5, 1, 1.001)]
    assert first_month[0] == NEWBORN_CPD
    assert first_month[1] == pytest.approx((first_month[0] + first_month[2]) / 2)
    assert first_month[3] == pytest.approx(first_month[2], rel=0.01)


@pytest.mark.parametrize(("profile", "table"), [("mayer1995", MAYER_1995_CPD), ("mimo_v2", MIMO_V2_CPD)])
def test_tables_are_met_and_between_their_ages_acuity_is_even_in_octaves(profile, table):
    assert {months: acuity_at(months, profile) for months in table} == pytest.approx(dict(table))
    for (month, cpd), (next_month, next_cpd) in pairwise(table.items()):
        assert acuity_at(np.sqrt(month * next_month), profile) == pytest.approx(np.sqrt(cpd * next_cpd))


@pytest.mark.parametrize("profile", ["mayer1995", "mimo_v2"])
def test_before_a_table_begins_acuity_is_its_first(profile):
    assert acuity_at(0, profile) == acuity_at(0.5, profile) == pytest.approx(acuity_at(1, profile))


@pytest.mark.parametrize("profile", PROFILES)
def test_beyond_the_last_age_acuity_stays(profile):
    assert acuity_at(48, profile) == acuity_at(60, profile)


@pytest.mark.parametrize("profile", PROFILES)
def test_acuity_grows_with_age_but_for_mayers_dip_at_a_year(profile):
    acuities_cpd = [acuity_at(months, profile) for months in MONTHS]
    falls = MONTHS[:-1][np.diff(acuities_cpd) < 0]
    assert all(9 <= months < 12 for months in falls)
    assert bool(len(falls)) == (profile == "mayer1995")


def test_acuity_is_that_of_the_body_unless_the_spec_says_another():
    assert resolve_acuity(vision(), 6) == resolve_acuity(vision(acuity="age"), 6) == acuity_at(6, "tac2")
    assert resolve_acuity(vision(acuity=3), 6) == acuity_at(3, "tac2")
    assert resolve_acuity(vision(acuity={"cpd": 4.2}), 6) == 4.2
    assert resolve_acuity(vision(acuity="off"), 6) is None
    assert resolve_acuity(vision(acuity_profile="mimo_v2"), 6) == 5.64


def provenance(**vision) -> dict:
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "senses": {"vision": vision}}
    return entries_of(mimoc.build(mimoc.InfantSpec.model_validate(spec)))


@pytest.mark.parametrize("profile", PROFILES)
def test_acuity_is_traced_to_its_profile_and_the_age(profile):
    entry = provenance(acuity_profile=profile)["vision.acuity_cpd"]
    assert entry["value"] == pytest.approx(acuity_at(9, profile))
    assert entry["rule"] == PROFILES[profile].rule
    assert "spec.age_months" in entry["from"]


def test_acuity_that_is_given_is_traced_to_the_spec():
    assert provenance(acuity={"cpd": 4.2})["vision.acuity_cpd"]["rule"] == "given by the spec"


AGES = np.linspace(0, 36, 73)
ALL_BY_AGE = dict.fromkeys(("contrast", "colour", "field", "focus", "vergence", "fovea", "flicker"), "age")
CURVES = {"sensitivity": maturity.SENSITIVITY, **maturity.CURVES}
FALLING = ("purity_threshold", "unfocused", "focus_depth_dioptres")


def built(age_months: float = 2, **vision) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "senses": {"vision": vision}}
    return mimoc.build(mimoc.InfantSpec.model_validate(spec))


@pytest.mark.parametrize("name", CURVES)
def test_all_curves_are_monotone_and_end_before_adults(name):
    values = [CURVES[name]("age", age) for age in AGES] + [CURVES[name].adult]
    steps = np.diff(values) * (-1 if name in FALLING else 1)
    assert (steps >= -1e-12).all()
    assert steps.sum() > 0


@pytest.mark.parametrize(
    ("name", "age_months", "value"),
    [
        ("sensitivity", 0, 3.5), ("sensitivity", 6, 28), ("sensitivity", 24, 90),
        ("chroma_gain", 1.5, 0.2), ("chroma_gain", 12, 1.0),
        ("purity_threshold", 0, 0.5), ("purity_threshold", 3, 52 * 0.005), ("purity_threshold", 24, 7.2 * 0.005),
        ("noticed_deg", 1, 28), ("noticed_deg", 4, 47.5), ("unfocused", 1, 1.0), ("unfocused", 4, 0.0),
        ("vergence", 3, 0.0), ("vergence", 4, 0.5), ("flicker_hz", 1, 2), ("flicker_hz", 9, 15),
    ],
)  # fmt: skip
def test_curves_go_through_what_is_entered(name, age_months, value):
    assert CURVES[name]("age", age_months) == pytest.approx(value, rel=0.02)
    assert CURVES[name](age_months, 20) == CURVES[name]("age", age_months)


@pytest.mark.parametrize(
    ("sensitivity", "ratio"), [(5, 4.5), (8, 5.2), (12, 5.8), (28, 7.0), (50, 7.8), (90, 8.6), (250, 10)]
)
def test_a_sensitivity_falls_to_1_at_the_acuity(sensitivity, ratio):
    solution = maturity.cut_off_ratio(sensitivity)
    assert solution == pytest.approx(ratio, abs=0.06)
    assert sensitivity_at(np.array(solution), sensitivity, 1.0) == pytest.approx(1.0)


def test_an_eye_without_these_keys_has_the_entry_that_it_had():
    """And so has one where all are off: no byte of a bundle's manifest is another."""
    plain, off = (built(**keys).manifest.senses.vision for keys in ({}, dict.fromkeys(ALL_BY_AGE, "off")))
    assert plain == off
    written = plain.model_dump(mode="json")
    assert written["contrast"] == "linear"
    assert not {*ALL_BY_AGE, "sensitivity", "sensitivity_peak_cpd", "purity_threshold", "noticed_deg"} & (
        written.keys() - {"contrast"}
    )
    assert "colour" not in built().files["resolved.yaml"].decode()


def test_an_eye_by_age_has_all_and_says_of_each_where_it_is_from():
    bundle = built(2, foveation=5, **ALL_BY_AGE)
    entry, origins = bundle.manifest.senses.vision, entries_of(bundle)
    assert (entry.contrast, entry.sensitivity, entry.unfocused, entry.vergence) == ("threshold", 8, 0.8, 0)
    assert entry.sensitivity_peak_cpd == pytest.approx(acuity_at(2, "tac2") / 5.18, rel=1e-3)
    assert entry.foveation == pytest.approx(5 * (acuity_at(2, "tac2") / 40) ** 0.5)
    names = [*CURVES, "sensitivity_peak_cpd", "foveation"]
    for name in names:
        assert origins[f"vision.{name}"]["value"] == pytest.approx(getattr(entry, name)), name
        assert "spec.age_months" in origins[f"vision.{name}"]["from"]
    assert "guess" in origins["vision.chroma_gain"]["rule"]


def test_an_adult_is_limited_by_little():
    entry = built(9, foveation=5, **dict.fromkeys(ALL_BY_AGE, "adult")).manifest.senses.vision
    assert (entry.sensitivity, entry.purity_threshold, entry.chroma_gain) == (250, 0.005, 1)
    assert (entry.noticed_deg, entry.unfocused, entry.vergence, entry.flicker_hz, entry.foveation) == (
        None, 0, 1, None, 5,
    )  # fmt: skip


def test_the_template_follows_the_acuity_that_is_asked_for():
    """Measured, of another age, or of nobody: then of the age of the contrast sensitivity."""
    ratio = maturity.cut_off_ratio(28)
    peaks = [
        maturity.maturity_of(VisionSpec.model_validate({"contrast": 6, "acuity": acuity}), 1)["sensitivity_peak_cpd"]
        for acuity in ({"cpd": 4.2}, 12, "off")
    ]
    assert peaks == pytest.approx([4.2 / ratio, acuity_at(12, "tac2") / ratio, acuity_at(6, "tac2") / ratio])


@pytest.mark.parametrize(("strength", "seen"), [(0.3, 0.3), (1, 0.5), (1000, 1000 * (0.64 / 40) ** 0.5)])
def test_a_newborns_fovea_is_weaker_but_never_stronger_than_an_adults(strength, seen):
    assert maturity.foveation_at(VisionSpec(foveation=strength, fovea="age"), 0) == pytest.approx(seen)


def test_a_threshold_without_its_numbers_is_no_entry():
    entry = built().manifest.senses.vision.model_dump()
    with pytest.raises(ValueError, match="they belong to the contrast law 'threshold'"):
        VisionEntry.model_validate({**entry, "contrast": "threshold"})
