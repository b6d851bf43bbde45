"""Each delay says where it comes from."""

import mimoc
from mimoc.compiler.delays import presets as presets
from mimoc.compiler.delays.presets import RULES
from mimoc.compiler.explain import entries_of


def provenance(**keys) -> dict:
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9, **keys})
    return entries_of(mimoc.build(spec))


def test_every_preset_has_a_rule():
    assert RULES.keys() == presets.PRESETS.keys()


def test_a_delay_is_led_back_to_the_key_that_says_so():
    delays = {"preset": "physiological", "sensory_ms": 50, "vision_ms": 100}
    found = provenance(senses={"touch": {}, "vision": {}}, delays=delays)
    assert (found["delays.vision.ms"]["value"], found["delays.vision.ms"]["from"]) == (100, ["spec.delays.vision_ms"])
    assert (found["delays.touch.ms"]["value"], found["delays.touch.ms"]["from"]) == (50, ["spec.delays.sensory_ms"])
    assert found["delays.motor.ms"]["from"][0] == "spec.delays.preset"
    assert (found["delays.motor.ms"]["value"], found["delays.motor.legs_ms"]["value"]) == (20, 30)


def test_every_source_is_an_entry_itself():
    found = provenance(senses={"touch": {}, "vision": {}}, delays={"preset": "paper"})
    mine = [key for key in found if key.split(".")[0] in ("vision", "delays", "skin")]
    assert len(mine) > 20
    assert all(source in found for key in mine for source in found[key]["from"])
