"""The delays of an infant are those that its spec gives, else those of the preset."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.body.tree import remove_parts
from mimoc.compiler.explain import entries_of
from mimoc.compiler.presets import MOTOR_DELAY, PRESETS, RULES, delays
from mimoc.fits import measure
from mimoc.schema import InfantSpec
from mimoc.schema.kinds import SENSES
from mimoc.schema.senses import MOTOR, DelayEntry, DelaysEntry, DelaysSpec, signals

TABLES = {name: SENSES[name].physiological_delay for name in SENSES} | {MOTOR: MOTOR_DELAY}
TREE = grow_tree(measure(9), assemble("mitten", False))


def entry(age_months=9, timestep_ms=5, tree=TREE, **keys) -> DelaysEntry:
    control = {"timestep_ms": timestep_ms, "step_ms": 2 * timestep_ms}
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "delays": keys, "control": control}
    spec["senses"] = {sense: {} for sense in SENSES}
    return delays(InfantSpec.model_validate(spec), tree)


def test_every_preset_of_the_language_and_every_signal_is_known():
    assert tuple(PRESETS) == DelaysSpec.model_fields["preset"].annotation.__args__
    assert {f"{signal}_ms" for signal in signals()} == DelaysSpec.model_fields.keys() - {
        "preset",
        "sensory_ms",
        "processing",
    }
    assert set(signals()) == DelaysEntry.model_fields.keys() - {"legs", "processing"}


def test_there_is_no_delay_by_default():
    assert entry() == DelaysEntry(legs=("right_upper_leg", "left_upper_leg"))


def test_the_more_specific_key_takes_precedence():
    found = entry(preset="physiological", sensory_ms=50, vision_ms=100)
    assert [getattr(found, sense) for sense in SENSES] == [DelayEntry(ms=ms) for ms in (50, 50, 50, 100, 50, 50)]
    assert found.motor == entry(preset="physiological").motor


def test_no_delay_can_be_given_against_a_preset():
    assert entry(preset="paper", vision_ms=0).vision == DelayEntry(ms=0)


def test_the_preset_of_the_paper_is_50_ms_and_one_physics_step():
    found = entry(preset="paper")
    assert {getattr(found, sense).ms for sense in SENSES} == {50}
    assert found.motor.ms == 5
    assert entry(preset="paper", timestep_ms=2).motor.ms == 2


@pytest.mark.parametrize(
    ("age_months", "vision_ms", "touch_ms", "touch_legs_ms", "motor_ms", "motor_legs_ms"),
    [(0, 245, 40, None, 30, 40), (1, 205, 35, 40, 30, 40), (3, 115, 25, 35, 25, 35), (24, 105, 20, 30, 20, 30)],
)
def test_physiological_delays_are_those_of_the_table(
    age_months, vision_ms, touch_ms, touch_legs_ms, motor_ms, motor_legs_ms
):
    found = entry(age_months, preset="physiological")
    assert found.vision == DelayEntry(ms=vision_ms)
    assert found.touch == found.proprioception == DelayEntry(ms=touch_ms, legs_ms=touch_legs_ms)
    assert found.motor == DelayEntry(ms=motor_ms, legs_ms=motor_legs_ms)
    assert found.vestibular == DelayEntry(ms=10)


@given(st.floats(0, 24), st.floats(0, 24), st.sampled_from([0.5, 1, 2, 4, 5, 7]))
def test_older_is_never_slower(one, other, timestep_ms):
    younger, older = (entry(age, timestep_ms, preset="physiological") for age in sorted((one, other)))
    for signal in signals():
        young, old = getattr(younger, signal), getattr(older, signal)
        assert old.ms <= young.ms
        assert (old.legs_ms or old.ms) <= (young.legs_ms or young.ms)


@given(st.floats(0, 24), st.sampled_from([0.5, 1, 2, 4, 5, 7]), st.sampled_from(sorted(PRESETS)))
def test_presets_are_whole_steps_and_within_half_a_step_of_what_they_say(age_months, timestep_ms, preset):
    found = entry(age_months, timestep_ms, preset=preset)
    for signal, table in TABLES.items():
        delay = getattr(found, signal)
        for ms, measured_ms in ((delay.ms, table.ms), (delay.legs_ms or delay.ms, table.legs_ms or table.ms)):
            assert ms / timestep_ms == pytest.approx(round(ms / timestep_ms))
            if preset == "physiological":
                assert abs(ms - np.interp(age_months, table.ages_months, measured_ms)) <= timestep_ms / 2 + 1e-9


def test_an_infant_without_a_leg_has_one_leg():
    assert entry(tree=remove_parts(TREE, ("left_upper_leg",))).legs == ("right_upper_leg",)


def provenance(**keys) -> dict:
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9, **keys})
    return entries_of(mimoc.build(spec))


def test_every_preset_has_a_rule():
    assert RULES.keys() == PRESETS.keys()


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
