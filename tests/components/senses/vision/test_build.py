"""The acuity of an infant says where it comes from."""

import pytest

import mimoc
from mimoc.compiler.explain import entries_of
from mimoc.components.senses.vision import build_acuity as acuity_by_age
from mimoc.components.senses.vision.build import PROFILES


def provenance(**vision) -> dict:
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "senses": {"vision": vision}}
    return entries_of(mimoc.build(mimoc.InfantSpec.model_validate(spec)))


def test_every_profile_has_a_rule():
    assert PROFILES.keys() == acuity_by_age.PROFILES.keys()


@pytest.mark.parametrize("profile", PROFILES)
def test_acuity_is_traced_to_its_profile_and_the_age(profile):
    entry = provenance(acuity_profile=profile)["vision.acuity_cpd"]
    assert entry["value"] == pytest.approx(acuity_by_age.acuity_at(9, profile))
    assert entry["rule"] == PROFILES[profile]
    assert "spec.age_months" in entry["from"]


def test_acuity_that_is_given_is_traced_to_the_spec():
    assert provenance(acuity={"cpd": 4.2})["vision.acuity_cpd"]["rule"] == "given by the spec"


def test_an_infant_with_one_eye_sees_with_it():
    body, senses = {"remove": ["left_eye"], "skin": False}, {"vision": {"width_px": 16, "height_px": 16}}
    spec = {"mimoc": 1, "name": "x", "age_months": 6, "body": body, "senses": senses}
    with mimoc.make(mimoc.InfantSpec.model_validate(spec)) as env:
        observation, _ = env.reset(seed=0)
    assert list(observation) == ["eye_right"]
