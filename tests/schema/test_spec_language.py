"""What a spec may say, and what it then means."""

from pathlib import Path

import pytest
from hypothesis import given, settings, strategies as st
from pydantic import ValidationError
from support.any_specs import MINIMAL, specs

from mimoc.base.errors import SpecError
from mimoc.components.senses.vision import VisionSpec
from mimoc.schema import InfantSpec, read_spec, to_data
from mimoc.schema.source import dump, parse, read

CONFIGS = sorted((Path(__file__).parents[2] / "configs").glob("*.yaml"))
WHOLE_LANGUAGE = """\
mimoc: 1
name: nine_months
age_months: 9
body:
  hands: mitten
  chest_joint: false
  individual: {sex: female, length_percentile: 25, weight_percentile: 50, head_percentile: 50}
  measurements:
    foot_length_cm: 11.2
    left_forearm_circumference_cm: 13.0
  parts:
    right_upper_arm: {length: 0.95, girth: 1.05}
  remove: []
  expression: neutral
actuation:
  model: torque
  strength_age_months: 9
  strength: {neck: 0.5}
senses:
  proprioception: {include: [velocity, torque, limits, actuation]}
  vestibular: {}
  touch: {density: 1.0, quantity: force_vector, response: linear}
  vision: {width_px: 64, height_px: 64, fovy_deg: 60, acuity: age, foveation: 0}
delays:
  preset: none
  sensory_ms: 50
  vision_ms: 100
  motor_ms: 5
scene:
  kind: room
  seed: 7
  pose: supine
  room: {size_m: [[2.5, 5], [2.5, 5], [2.2, 3]]}
  toys:
    source: builtin
    root: ~/data/toys4k_obj_files
    subset: [ball, cup, truck_003]
    count: [3, 6]
    size_cm: [4, 12]
control: {step_ms: 10, timestep_ms: 5}
task: {kind: reach}
"""


def test_the_whole_language_is_understood():
    spec = read_spec(parse(WHOLE_LANGUAGE, "f"))
    assert spec.body.parts["right_upper_arm"].length == 0.95
    assert spec.senses.vision == VisionSpec()
    assert spec.scene.room.size_m[2] == (2.2, 3.0)
    assert spec.task is not None


def test_everything_but_version_name_and_age_has_a_default():
    spec = InfantSpec(mimoc=1, name="x", age_months=3)
    assert spec.actuation.strength_age_months is None
    assert set(dict(spec.senses).values()) == {None}
    assert (spec.scene.kind, spec.scene.pose, spec.control.step_ms) == ("flat", "supine", 10)
    assert spec.source is None


def test_to_data_fills_in_every_default():
    data = to_data(InfantSpec(mimoc=1, name="x", age_months=3))
    assert data["control"] == {"step_ms": 10.0, "timestep_ms": 5.0}
    assert data["senses"] == {}


@pytest.mark.parametrize("config", CONFIGS, ids=lambda config: config.stem)
def test_configs_are_specs_named_as_their_files(config):
    spec = read_spec(read(config))
    assert spec.name == config.stem
    assert spec.source is not None
    assert spec.source.text == config.read_text()


def test_configs_cover_the_first_two_years():
    ages = {read_spec(read(config)).age_months for config in CONFIGS}
    assert {0, 6, 9, 18, 24} <= ages


@settings(max_examples=40)
@given(specs())
def test_a_spec_reads_back_as_an_equal_one(spec):
    text = dump(to_data(spec))
    assert read_spec(parse(text, "f")) == spec
    assert dump(to_data(read_spec(parse(text, "f")))) == text


def test_specs_are_equal_when_they_say_the_same():
    written = read_spec(parse("mimoc: 1\nname: x\nage_months: 9\n", "one"))
    spelled_out = read_spec(parse("{age_months: 9.0, mimoc: 1, name: x, scene: {kind: flat}}", "two"))
    assert written == spelled_out == InfantSpec(mimoc=1, name="x", age_months=9)
    assert written != read_spec(parse("{age_months: 10, mimoc: 1, name: x}", "one"))
    assert written.source != spelled_out.source


def test_specs_share_nothing_that_can_change():
    one, other = InfantSpec(mimoc=1, name="x", age_months=9), InfantSpec(mimoc=1, name="x", age_months=9)
    assert one.body.measurements is not other.body.measurements
    with pytest.raises(ValidationError, match="frozen"):
        one.body.__setattr__("hands", "five_finger")


@pytest.mark.parametrize("acuity", ["off", "age", "0", "4.5", "{cpd: 4.2}"])
def test_acuity_takes_four_forms(acuity):
    spec = read_spec(parse(f"{{mimoc: 1, name: x, age_months: 9, senses: {{vision: {{acuity: {acuity}}}}}}}", "f"))
    assert read_spec(parse(dump(to_data(spec)), "f")) == spec


@pytest.mark.parametrize(
    ("section", "wrong"),
    [
        *[("age_months", "9"), ("age_months", True), ("body", {"chest_joint": 1}), ("body", {"chest_joint": "yes"})],
        *[
            ("scene", {"seed": 1.0}),
            ("scene", {"seed": True}),
            ("name", 9),
            ("mimoc", True),
            ("mimoc", 1.0),
            ("mimoc", "1"),
        ],
        *[("age_months", float("nan")), ("body", {"hands": 1}), ("delays", {"motor_ms": "5"}), ("task", "reach")],
    ],
)
def test_no_type_is_taken_for_another(section, wrong):
    with pytest.raises(SpecError):
        InfantSpec.model_validate({**MINIMAL, section: wrong})


@pytest.mark.parametrize("timestep_ms", [1, 2.5, 5])
def test_delays_are_whole_physics_steps_of_the_spec_s_own_clock(timestep_ms):
    given = {**MINIMAL, "control": {"timestep_ms": timestep_ms}, "senses": {"touch": {}}}
    InfantSpec.model_validate({**given, "delays": {"touch_ms": 3 * timestep_ms}})
    with pytest.raises(SpecError, match="nearest that works"):
        InfantSpec.model_validate({**given, "delays": {"touch_ms": 3.3 * timestep_ms}})


@given(st.data())
def test_mutilated_specs_are_read_or_refused(data):
    lines = WHOLE_LANGUAGE.splitlines(keepends=True)
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(lines) - 1))
        scrap = data.draw(st.sampled_from(["", "x", "[]", ": 1", "-1\n", "{}", "'", "\t", "null\n", "&a ", "  "]))
        cut = data.draw(st.integers(0, len(lines[at])))
        lines[at] = lines[at][:cut] + scrap + lines[at][cut + data.draw(st.integers(0, 5)) :]
    try:
        read_spec(parse("".join(lines), "f"))
    except SpecError as error:
        for line in str(error).splitlines():
            assert line.isprintable()
            assert line.startswith("f:")
            assert "Input should" not in line


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
    of(text)
