from itertools import pairwise
from typing import get_args

import numpy as np
import pytest

import mimoc
from mimoc.components.senses.vision import VisionSpec
from mimoc.components.senses.vision.build_acuity import (
    MAYER_1995_CPD,
    MIMO_V2_CPD,
    NEWBORN_CPD,
    PROFILES,
    acuity_at,
    resolve_acuity,
)

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


def test_the_runtime_is_told():
    spec = {"mimoc": 1, "name": "infant", "age_months": 4, "senses": {"vision": {"acuity_profile": "mayer1995"}}}
    told = mimoc.build(mimoc.InfantSpec.model_validate(spec)).manifest.senses.vision
    assert told
    assert told.acuity_cpd == pytest.approx(2.68)
