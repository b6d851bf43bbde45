"""Numbers of senses and delays say where they come from."""

import json

import pytest
from mimoc.compiler.provenance.senses import PRESETS, PROFILES

import mimoc
from mimoc.delays import presets
from mimoc.senses.vision import acuity_by_age


def provenance(**keys) -> dict:
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9, **keys})
    return json.loads(mimoc.build(spec).files["provenance.json"])


def test_every_profile_and_every_preset_has_a_rule():
    assert PROFILES.keys() == acuity_by_age.PROFILES.keys()
    assert PRESETS.keys() == presets.PRESETS.keys()


@pytest.mark.parametrize("profile", PROFILES)
def test_acuity_is_led_back_to_its_profile_and_the_age(profile):
    entry = provenance(senses={"vision": {"acuity_profile": profile}})["vision.acuity_cpd"]
    assert entry["value"] == pytest.approx(acuity_by_age.acuity_at(9, profile))
    assert entry["rule"] == PROFILES[profile]
    assert "spec.age_months" in entry["from"]


def test_acuity_that_is_given_is_led_back_to_the_spec():
    assert provenance(senses={"vision": {"acuity": {"cpd": 4.2}}})["vision.acuity_cpd"]["rule"] == "given by the spec"


def test_a_delay_is_led_back_to_the_key_that_says_so():
    found = provenance(delays={"preset": "physiological", "sensory_ms": 50, "vision_ms": 100})
    assert (found["delays.vision.ms"]["value"], found["delays.vision.ms"]["from"]) == (100, ["spec.delays.vision_ms"])
    assert (found["delays.touch.ms"]["value"], found["delays.touch.ms"]["from"]) == (50, ["spec.delays.sensory_ms"])
    assert found["delays.motor.ms"]["from"][0] == "spec.delays.preset"
    assert (found["delays.motor.ms"]["value"], found["delays.motor.legs_ms"]["value"]) == (20, 30)


def test_every_source_is_an_entry_itself():
    found = provenance(senses={"touch": {}, "vision": {}}, delays={"preset": "paper"})
    mine = [key for key in found if key.split(".")[0] in ("vision", "delays", "skin")]
    assert len(mine) > 20
    assert all(source in found for key in mine for source in found[key]["from"])
