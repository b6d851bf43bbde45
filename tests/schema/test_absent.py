"""A spec says nothing of what its infant does not have."""

import pytest

from mimoc.base.errors import SpecError
from mimoc.schema import InfantSpec, read_spec
from mimoc.schema.source import parse

HEAD = "mimoc: 1\nname: x\nage_months: 9\n"
NO_ARM, NO_LEGS = "remove: [left_upper_arm]", "remove: [left_upper_leg, right_upper_leg]"

SAID = {
    f"body: {{{NO_ARM}, parts: {{left_hand: {{girth: 1.1}}}}}}": "body.parts.left_hand: 'left_hand' is removed",
    f"body: {{{NO_ARM}, measurements: {{left_hand_length_cm: 9}}}}": "left_hand_length_cm: all that follows this is",
    f"body: {{{NO_LEGS}, measurements: {{calf_circumference_cm: 18}}}}": "calf_circumference_cm: all that follows",
    f"body: {{{NO_ARM}}}\nactuation: {{strength: {{left_arm: 2}}}}": "actuation.strength.left_arm: all of 'left_arm'",
    f"body: {{{NO_ARM}}}\nactuation: {{locked: [legs, left_hand]}}": "actuation.locked[1]: all of 'left_hand' is",
    f"body: {{{NO_LEGS}}}\nactuation: {{regions: [legs]}}": "actuation.regions[0]: all of 'legs' is removed",
    f"body: {{{NO_ARM}}}\nsenses: {{touch: {{regions: [left_arm]}}}}": "senses.touch.regions[0]: all of 'left_arm'",
    "delays: {vision_ms: 100}": "delays.vision_ms: 'vision' is off, so it has no delay; add 'vision: {}' to the senses",
    "body: {skin: false}\nsenses: {vision: {body: skin}}": "senses.vision.body: there is no skin to see",
}

ALLOWED = (
    f"body: {{{NO_ARM}, parts: {{right_hand: {{girth: 1.1}}}}}}",
    f"body: {{{NO_ARM}, measurements: {{hand_length_cm: 9, right_hand_length_cm: 9}}}}",
    f"body: {{{NO_ARM}}}\nactuation: {{strength: {{arms: 2}}, regions: [arms, left_leg]}}",
    f"body: {{{NO_ARM}}}\nsenses: {{touch: {{regions: [arms]}}}}",
    "body: {remove: [left_hand], measurements: {left_elbow_hand_length_cm: 17.5, left_hand_length_cm: 9}}",
    "delays: {vision_ms: 0, motor_ms: 5, sensory_ms: 5}",
    "body: {skin: true}\nsenses: {vision: {body: skin}}",
)


def of(text: str) -> InfantSpec:
    return read_spec(parse(HEAD + text + "\n", "spec.yaml"))


@pytest.mark.parametrize("text", SAID)
def test_what_is_about_something_missing_is_refused_where_it_is_written(text):
    with pytest.raises(SpecError) as refusal:
        of(text)
    assert SAID[text] in str(refusal.value)
    assert len(refusal.value.problems) == 1


@pytest.mark.parametrize("text", ALLOWED)
def test_what_is_about_something_that_remains_is_not(text):
    """Also the length of a hand that is removed: the forearm is as long as elbow to fingertips less this."""
    of(text)
