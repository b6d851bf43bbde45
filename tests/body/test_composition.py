"""Individuals' fat and rate of maturation, and what strength and joints make of them."""

from functools import lru_cache

import pytest
from hypothesis import given, settings, strategies as st

import mimoc
from mimoc.body.grow import grow_body
from mimoc.body.maturation import EYES, HAND, NECK
from mimoc.body.strength import STRENGTH
from mimoc.compiler.explain import explain
from mimoc.fits.standards import mean_fat_percent
from mimoc.schema.infant import InfantSpec

AGES = st.floats(0, 24).map(lambda months: round(months, 1))
RATES = st.floats(0.5, 2).map(lambda rate: round(rate, 2))


@lru_cache(maxsize=64)
def grown(age_months=6.0, development="maturing", **individual):
    body = {"individual": individual} if individual else {}
    spec = InfantSpec(mimoc=1, name="kim", age_months=age_months, body=body, development=development)
    return grow_body(spec)


def gears(grown_body) -> dict[str, float]:
    return {motor.joint: motor.gear_nm for motor in grown_body.tree.motors}


def groups(grown_body) -> dict[str, str]:
    return grown_body.reference.anatomy.groups


@given(AGES)
@settings(max_examples=10)
def test_a_child_of_average_rate_and_fat_is_the_average_child(age_months):
    assert grown(age_months, maturation_rate=1.0).tree == grown(age_months).tree
    percent = mean_fat_percent(age_months)
    assert gears(grown(age_months, fat_percent=percent)) == gears(grown(age_months))


@given(AGES, RATES)
@settings(max_examples=15)
def test_a_child_is_as_mature_as_the_average_child_at_its_age_times_its_rate(age_months, rate):
    """Strength beyond size, tone and ranges; size itself is that of its age."""
    child, usual = grown(age_months, maturation_rate=rate), grown(age_months)
    older = grown(min(rate * age_months, 24.0))
    assert child.tree.mass_kg == usual.tree.mass_kg
    for joint, group in groups(child).items():
        if joint in gears(child) and group != HAND:
            share = STRENGTH[group](rate * age_months) / STRENGTH[group](age_months)
            assert gears(child)[joint] == pytest.approx(gears(usual)[joint] * share), joint
        assert child.tree.joints[joint].range_deg == older.tree.joints[joint].range_deg
    tones = [{motor.name: motor.tone and motor.tone.angle_deg for motor in body.tree.motors} for body in (child, older)]
    assert tones[0] == tones[1]


@given(AGES, RATES, RATES)
@settings(max_examples=15)
def test_the_faster_it_matures_the_stronger_it_is(age_months, one, other):
    """But for fingers, whose grasp newborns lose."""
    slow, fast = (gears(grown(age_months, maturation_rate=rate)) for rate in sorted((one, other)))
    of_group = groups(grown(age_months))
    assert all(slow[joint] <= fast[joint] * (1 + 1e-12) for joint in slow if of_group[joint] != HAND)


@given(AGES, st.floats(5, 50), st.floats(5, 50))
@settings(max_examples=15)
def test_the_fatter_of_two_children_of_one_size_is_weaker_but_for_neck_and_eyes(age_months, one, other):
    low, high = sorted((round(one, 1), round(other, 1)))
    lean, fatty = grown(age_months, fat_percent=low), grown(age_months, fat_percent=high)
    for joint, torque_nm in gears(lean).items():
        factor = 1.0 if groups(lean)[joint] in (NECK, EYES) else (100 - high) / (100 - low)
        assert gears(fatty)[joint] == pytest.approx(torque_nm * factor)


@given(st.sampled_from([1.0, 3.0, 6.0, 9.0, 12.0]), st.floats(2, 97), st.floats(2, 97))
@settings(max_examples=10)
def test_the_heavier_of_two_children_of_one_length_is_stronger_but_less_than_what_it_carries_is_heavier(
    age_months, one, other
):
    """Of what it carries, the head is not heavier, so that this is trunk and limbs."""
    low, high = sorted((round(one, 1), round(other, 1)))
    if high - low < 1:
        return
    light, heavy = (
        grown(age_months, sex="female", length_percentile=50.0, weight_percentile=percentile)
        for percentile in (low, high)
    )
    knees_nm = [gears(body)["robot:left_knee"] for body in (light, heavy)]
    loads_kg = [sum(part.mass_kg for part in body.tree.bodies if part.name != "head") for body in (light, heavy)]
    assert knees_nm[0] < knees_nm[1]
    assert knees_nm[0] / loads_kg[0] > knees_nm[1] / loads_kg[1]


def test_newborns_have_the_fat_that_was_measured():
    """87 newborns of three days (Roggero et al. 2009)."""
    assert mean_fat_percent(0) == 8.6
    assert mean_fat_percent(6) == 25.9


def test_a_newborns_excess_weight_is_mostly_lean_and_that_of_infants_is_more_fat():
    """Of each SD of newborns' weight, .342 of .463 kg (Perng et al. 2017); at 5 months less than half is lean."""

    def lean_share(age_months):
        by_volume = 1.01  # A child 1 % heavier than its length asks for, whose share of fat is 1 % larger.
        usual = mean_fat_percent(age_months) / 100
        return (by_volume * (1 - usual * by_volume) - (1 - usual)) / (by_volume - 1)

    assert lean_share(0) == pytest.approx(0.342 / 0.463, abs=0.1)
    assert 0.4 < lean_share(5) < 0.5


def test_by_the_published_law_strength_follows_size_alone_and_a_note_says_so():
    plain, child = (grown(6.0, "published", **keys) for keys in ({}, {"maturation_rate": 1.5, "fat_percent": 40.0}))
    assert child.tree == plain.tree
    spec = {"mimoc": 1, "name": "kim", "age_months": 6, "development": "published"}
    bundle = mimoc.build(InfantSpec(**spec, body={"individual": {"maturation_rate": 1.5}}))
    note = "'body.individual.maturation_rate' has no effect: by the law 'published', strength follows size alone"
    assert note in bundle.manifest.notes


def test_explain_tells_both():
    individual = {"maturation_rate": 1.2, "fat_percent": 32.0}
    bundle = mimoc.build(InfantSpec(mimoc=1, name="kim", age_months=6, body={"individual": individual}))
    knee = explain(bundle, "actuator.act:left_knee.gear")
    assert {f"spec.body.individual.{key}" for key in individual} <= {source.key for source in knee.sources}
    assert "leaner than the average child" in knee.lines[1]
    neck = explain(bundle, "actuator.act:head_tilt.gear").lines[1]
    assert "leaner" not in neck
    for rule in (knee.lines[1], neck, explain(bundle, "joint.robot:left_knee.range").lines[1]):
        assert rule.endswith("at a maturity of 7.2 months")


def test_the_strength_of_an_age_that_a_spec_asks_for_is_the_average_childs():
    spec = InfantSpec(mimoc=1, name="kim", age_months=6, actuation={"strength_age_months": 12})
    fast = spec.with_(body={"individual": {"maturation_rate": 1.5}})
    assert gears(grow_body(fast)) == pytest.approx(gears(grow_body(spec)))
