"""How late signals are follows from the spec: what is given, else the preset."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimoc.body import assemble, grow
from mimoc.body.prune import prune
from mimoc.delays.presets import AGES_MONTHS, PHYSIOLOGICAL, PRESETS, delays
from mimoc.delays.spec import DelayEntry, DelaysEntry, DelaysSpec
from mimoc.fits import measure
from mimoc.schema import InfantSpec

SENSES = ("proprioception", "vestibular", "touch", "vision")
TREE = grow(measure(9), assemble("mitten", False))


def entry(age_months=9, timestep_ms=5, tree=TREE, **keys) -> DelaysEntry:
    control = {"timestep_ms": timestep_ms, "step_ms": 2 * timestep_ms}
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "delays": keys, "control": control}
    return delays(InfantSpec.model_validate(spec), tree)


def test_every_preset_of_the_language_and_every_channel_is_known():
    assert tuple(PRESETS) == DelaysSpec.model_fields["preset"].annotation.__args__
    assert tuple(PHYSIOLOGICAL) == tuple(name for name in DelaysEntry.model_fields if name != "legs")


def test_without_a_word_nothing_is_late():
    assert entry() == DelaysEntry(legs=("right_upper_leg", "left_upper_leg"))


def test_what_is_more_particular_wins():
    found = entry(preset="physiological", sensory_ms=50, vision_ms=100)
    assert [getattr(found, sense) for sense in SENSES] == [DelayEntry(ms=ms) for ms in (50, 50, 50, 100)]
    assert found.motor == entry(preset="physiological").motor


def test_no_delay_can_be_given_against_a_preset():
    assert entry(preset="paper", vision_ms=0).vision == DelayEntry(ms=0)


def test_the_paper_is_50_ms_late_and_one_step():
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
    for channel in PHYSIOLOGICAL:
        young, old = getattr(younger, channel), getattr(older, channel)
        assert old.ms <= young.ms
        assert (old.legs_ms or old.ms) <= (young.legs_ms or young.ms)


@given(st.floats(0, 24), st.sampled_from([0.5, 1, 2, 4, 5, 7]), st.sampled_from(sorted(PRESETS)))
def test_presets_are_whole_steps_and_within_half_a_step_of_what_they_say(age_months, timestep_ms, preset):
    found = entry(age_months, timestep_ms, preset=preset)
    for channel, nerve in PHYSIOLOGICAL.items():
        delay = getattr(found, channel)
        for ms, table in ((delay.ms, nerve.ms), (delay.legs_ms or delay.ms, nerve.legs_ms or nerve.ms)):
            assert ms / timestep_ms == pytest.approx(round(ms / timestep_ms))
            if preset == "physiological":
                assert abs(ms - np.interp(age_months, AGES_MONTHS, table)) <= timestep_ms / 2 + 1e-9


def test_an_infant_without_a_leg_has_one_leg():
    assert entry(tree=prune(TREE, ("left_upper_leg",))).legs == ("right_upper_leg",)
