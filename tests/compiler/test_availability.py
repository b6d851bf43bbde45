"""What this version cannot build is refused, all at once and where it is written; nothing is passed over in silence.

Texts are golden; renew them with `pytest --snapshot-update`.
"""

from pathlib import Path

import pytest
from support import store

import mimoc
from mimoc.base.errors import SpecError
from mimoc.schema import InfantSpec
from mimoc.schema.kinds import SENSES

HEAD = "mimoc: 1\nname: x\nage_months: 9\n"

EVERYTHING = (
    HEAD
    + """\
body:
  measurements: {head_breadth_cm: 11, left_thumb_diameter_cm: 1, foot_length_cm: 11}
development: published
"""
)
"""One of each, so that one refusal shows them all."""

INERT = {
    "impairments.side",
    "body.extra",
    "body.size_is_known",
    "scene.seed",
    "scene.room",
    "scene.textures",
    "scene.start_at",
}
"""The smallest spec is in no room and at no furniture, nothing in it is random, and it has no disorder of one side;
parts besides a child's come from others."""

BUILT = {
    "name": "other",
    "age_months": 10,
    "development": "published",
    "impairments": {"preset": "hypotonia"},
    "impairments.preset": "diplegia",
    "impairments.weakness": {"right_arm": 0.05},
    "impairments.tone": {"legs": {"kind": "spastic"}},
    "impairments.range": {"left_elbow": [-90, -20]},
    "impairments.delay": {"right_side": 2},
    "impairments.noise": {"hands": 0.2},
    "impairments.acuity": {"left_eye": 0.3},
    "impairments.field_deg": {"right": 0},
    "impairments.gestation_weeks": 34,
    "body.hands": "five_finger",
    "body.chest_joint": True,
    "body.individual": {"sex": "female", "length_percentile": 25, "fat_percent": 30, "maturation_rate": 1.1},
    "body.measurements": {"foot_length_cm": 11.2},
    "body.parts": {"right_upper_arm": {"length": 0.95}},
    "body.remove": ["left_lower_arm"],
    "body.expression": "happy",
    "body.looks": {"hair": "black", "clothes": "trousers"},
    "body.looks.skin": "dark",
    "body.looks.hair": "red",
    "body.looks.eyes": "green",
    "body.looks.clothes": "nappy",
    "body.skin": False,
    "actuation.model": "muscle",
    "actuation.arousal": 0.5,
    "actuation.bandwidth_hz": 4.0,
    "actuation.strength_age_months": 12,
    "actuation.strength": {"neck": 0.5},
    "actuation.regions": ["arms"],
    "actuation.locked": ["legs"],
    "actuation.voice": True,
    "senses.proprioception": {"include": ["velocity"]},
    "senses.vestibular": {"include": ["gyro"], "canals": "age"},
    "senses.pain": {"threshold": "adult"},
    "senses.touch": {"spacing_cm": {"left_hand": 1}, "quantity": "normal", "response": "nearest", "channels": ["sa1"]},
    "senses.vision": {"width_px": 32, "acuity": 3, "acuity_profile": "mayer1995", "foveation": 5, "supersample": 2},
    "senses.hearing": {"output": "waveform", "sample_rate_hz": 16_000, "thresholds": "adult", "channels": 24},
    "senses.vision.contrast": "age",
    "senses.vision.colour": 3,
    "senses.vision.field": "age",
    "senses.vision.focus": 1,
    "senses.vision.vergence": "age",
    "senses.vision.fovea": "age",
    "senses.vision.flicker": "age",
    "delays.preset": "paper",
    "delays.sensory_ms": 50,
    "delays.proprioception_ms": 50,
    "delays.vestibular_ms": 50,
    "delays.pain_ms": 50,
    "delays.touch_ms": 50,
    "delays.vision_ms": 100,
    "delays.hearing_ms": 5,
    "delays.motor_ms": 5,
    "delays.processing": "age",
    "noise.motor": 0.1,
    "noise.proprioception_deg": 1,
    "noise.vestibular_thresholds": "age",
    "noise.touch_n": 0.05,
    "noise.hearing_db": 2,
    "noise.delay_jitter_ms": 5,
    "scene.kind": "room",
    "scene.toys": {"count": [1, 2]},
    "scene.objects": [{"name": "ball", "at": {"x_cm": 60}}],
    "scene.pose": "prone",
    "scene.caregiver": {"distance_cm": 30},
    "scene.held": ["chest"],
    "task": {"kind": "reach"},
    "control.step_ms": 20,
    "control.timestep_ms": 2.5,
}
"""What this version builds: keys and values that are not the default."""

NEEDED = {
    "impairments.delay": {"delays": {"preset": "physiological"}},
    "impairments.acuity": {"senses": {"vision": {}}},
    "impairments.field_deg": {"senses": {"vision": {}}},
    **{f"delays.{sense}_ms": {"senses": {sense: {}}} for sense in SENSES},
    "noise.proprioception_deg": {"senses": {"proprioception": {}}},
    "noise.vestibular_thresholds": {"senses": {"vestibular": {}}},
    "noise.touch_n": {"senses": {"touch": {}}},
    "noise.hearing_db": {"senses": {"hearing": {}}},
    "noise.delay_jitter_ms": {"delays": {"motor_ms": 10}},
}
"""What else must be in the spec, by key."""


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def load(text: str) -> InfantSpec:
    Path("spec.yaml").write_text(text)
    return mimoc.load_spec("spec.yaml")


def refusal_of(spec: InfantSpec) -> SpecError:
    with pytest.raises(SpecError) as refusal:
        mimoc.build(spec)
    return refusal.value


def with_value(key: str, value, **others) -> InfantSpec:
    """Return the smallest spec with one key, dotted, set to a value, and others at the top."""
    data: dict = {"mimoc": 1, "name": "x", "age_months": 9, **others}
    *sections, last = key.split(".")
    section = data
    for name in sections:
        section = section.setdefault(name, {})
    section[last] = value
    return InfantSpec.model_validate(data)


def test_everything_at_once_gets_this_text(snapshot):
    assert str(refusal_of(load(EVERYTHING))) == snapshot


def test_every_problem_is_at_its_key():
    lines = EVERYTHING.splitlines()
    problems = refusal_of(load(EVERYTHING)).problems
    assert len(problems) == 2
    for problem in problems:
        assert lines[problem.line - 1][problem.column - 1 :].startswith(problem.key.split(".")[-1] + ":"), problem


def test_a_spec_from_python_is_refused_with_its_name(snapshot):
    assert (
        str(refusal_of(with_value("body.measurements", {"head_breadth_cm": 11}, development="published"))) == snapshot
    )


@pytest.mark.parametrize(
    ("hands", "inert", "followed"),
    [("mitten", "middle_finger", "maximum_fist"), ("five_finger", "maximum_fist", "middle_finger")],
)
def test_a_measurement_that_makes_no_difference_is_refused(hands, inert, followed):
    """Each kind of hands has its own; and by the published law, heads are round."""
    keys = {"middle_finger": "middle_finger_diameter_cm", "maximum_fist": "maximum_fist_breadth_cm"}
    usual_cm = {"middle_finger": 1.0, "maximum_fist": 5.0}
    body = {
        "hands": hands,
        "measurements": {keys[inert]: usual_cm[inert], "head_breadth_cm": 11.0, keys[followed]: usual_cm[followed]},
    }
    infant = {"mimoc": 1, "name": "x", "age_months": 9, "development": "published", "body": body}
    spec = InfantSpec.model_validate(infant)
    refused = {problem.key for problem in refusal_of(spec).problems}
    assert refused == {f"body.measurements.{key}" for key in (keys[inert], "head_breadth_cm")}


def test_nothing_is_built_by_half(tmp_path):
    refusal_of(load(EVERYTHING))
    assert [path.name for path in tmp_path.iterdir()] == ["spec.yaml"]


def test_what_is_written_out_but_off_can_be_built():
    text = "body: {chest_joint: false, measurements: {}, parts: {}, remove: []}\n"
    text += "actuation: {strength: {}}\ndelays: {preset: none, motor_ms: 0}\n"
    assert mimoc.build(load(HEAD + text)).files


@pytest.mark.parametrize("key", BUILT)
def test_what_is_accepted_makes_a_difference(key):
    """Beyond the files that only repeat the spec."""
    said = {"spec.yaml", "resolved.yaml", "provenance.json", "lock.json"}
    others = NEEDED.get(key, {})
    before = store.built({"mimoc": 1, "name": "x", "age_months": 9, **others}).files
    after = mimoc.build(with_value(key, BUILT[key], **others)).files
    assert any(before.get(name) != content for name, content in after.items() if name not in said)


def test_every_key_of_the_language_is_built_or_refused_or_known_to_be_inert():
    refused = {".".join(problem.key.split(".")[:2]) for problem in refusal_of(load(EVERYTHING)).problems}
    for section, field in InfantSpec.model_fields.items():
        keys = getattr(field.annotation, "model_fields", None) or {"": None}
        for key in (".".join(filter(None, (section, name))) for name in keys):
            assert key in refused | BUILT.keys() | INERT | {"mimoc"}, key
