"""A spec can be changed in Python, and nothing is built of one that has not passed validation."""

import re
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import mimoc
from mimoc.base.errors import SpecError
from mimoc.components.senses.touch import TouchSpec
from mimoc.schema import BodySpec, as_written, read_spec, to_data
from mimoc.schema.base import plain
from mimoc.schema.source import dump, parse
from mimoc.studies.growth import grow_against_who

TEXT = """\
# An infant of ours.
mimoc: 1
name: ours
age_months: 9
body: {hands: five_finger, parts: {head: {girth: 1.1}}}
senses: {vestibular: {}, touch: {density: 0.5}}
scene: {kind: room, textures: {floor: papers}}
"""


@pytest.fixture
def spec(tmp_path) -> mimoc.InfantSpec:
    (tmp_path / "ours.yaml").write_text(TEXT)
    return mimoc.load_spec(tmp_path / "ours.yaml")


def from_python(**keys) -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "ours", "age_months": 9, **keys})


def refusal(act) -> list[str]:
    with pytest.raises(SpecError) as refused:
        act()
    return str(refused.value).splitlines()


def test_a_dictionary_changes_the_keys_that_it_names_and_no_others(spec):
    changed = spec.with_(age_months=9.5, body={"hands": "mitten", "parts": {"left_foot": {"length": 1.2}}})
    assert changed.age_months == 9.5
    assert changed.body.hands == "mitten"
    assert {name: part.model_dump() for name, part in changed.body.parts.items()} == {
        "head": {"length": 1.0, "girth": 1.1},
        "left_foot": {"length": 1.2, "girth": 1.0},
    }
    assert changed.senses == spec.senses
    assert spec.age_months == 9


def test_none_takes_a_key_or_a_section_back_to_its_default(spec):
    assert spec.with_(body=None).body == BodySpec()
    assert spec.with_(body={"hands": None}).body.parts == spec.body.parts
    assert spec.with_(body={"hands": None}).body.hands == "mitten"
    assert spec.with_(senses={"touch": None}).senses.touch is None
    assert spec.with_(task={"kind": "reach"}).with_(task=None).task is None


def test_a_section_as_an_object_replaces_the_whole_section(spec):
    assert spec.with_(body=BodySpec(expression="happy")).body == BodySpec(expression="happy")
    assert spec.with_(senses={"touch": TouchSpec(quantity="normal")}).senses.touch == TouchSpec(quantity="normal")


def test_what_was_written_stays_as_it_was_written(spec):
    changed = spec.with_(age_months=9.5)
    assert as_written(changed).data == {**as_written(spec).data, "age_months": 9.5}
    assert changed.source.folder == spec.source.folder
    assert read_spec(parse(as_written(changed).text, "again.yaml")) == changed


def test_paths_are_still_seen_from_the_folder_of_the_file(spec, tmp_path, monkeypatch):
    monkeypatch.chdir(Path("/"))
    (problem,) = refusal(lambda: mimoc.build(spec.with_(age_months=9.5)))
    assert problem.startswith(f"<ours>: scene.textures.floor: {tmp_path / 'papers'}: ")


def test_numbers_of_numpy_and_sets_are_taken(spec):
    changed = spec.with_(age_months=np.float64(3), body={"remove": {"left_hand"}}, scene={"seed": np.int64(4)})
    assert (changed.age_months, changed.body.remove, changed.scene.seed) == (3.0, ("left_hand",), 4)


@pytest.mark.parametrize("made", ["read", "python"])
def test_every_problem_is_told_at_once_by_its_key(made, spec):
    changing = spec if made == "read" else from_python()
    assert refusal(lambda: changing.with_(age_monts=9.5, age_months=99, body={"hands": "miten"}, name=object)) == [
        "<ours>: age_months: 99 is too large; give 0 to 24 months",
        "<ours>: age_monts: unknown key; did you mean 'age_months'?",
        "<ours>: body.hands: 'miten' is not a choice; did you mean 'mitten'?",
        f"<ours>: name: {object!s} is not text; write a word, or put it in quotes",
    ]


@pytest.mark.parametrize(
    "keys",
    [
        {"senses": {"smell": {}}},
        {"delays": {"smell_ms": 5}},
        {"task": {"kind": "smell"}},
        {"senses": {"vision": {"fovy": 40}}, "body": {"remove": ("left_fot",)}, "age_month": 3},
        {"age_months": 99, "control": {"step_ms": 7}},
    ],
)
def test_data_from_python_is_refused_as_a_file_that_says_the_same(keys):
    data = {"mimoc": 1, "name": "ours", "age_months": 9, **keys}
    written = refusal(lambda: read_spec(parse(dump(plain(data)), "<ours>")))
    for act in (lambda: mimoc.InfantSpec(**data), lambda: mimoc.InfantSpec.model_validate(data)):
        assert refusal(act) == [
            re.sub(r":\d+:\d+: ", ": ", line) for line in sorted(written, key=lambda line: line.split(": ")[1])
        ]


UNVALIDATED = {
    "an age that is none": ({"age_months": 99.0}, "age_months: 99.0 is too large"),
    "a misspelt key": ({"age_month": 9.5}, "age_month: unknown key; did you mean 'age_months'?"),
    "no section": ({"body": 5}, "body: 5 is not a section"),
    "a section unchecked": ({"body": BodySpec().model_copy(update={"hands": "miten"})}, "body.hands: 'miten' is not"),
    "a section made so": ({"body": BodySpec.model_construct(hands="fist")}, "body.hands: 'fist' is not a choice"),
    "keys against each other": ({"body": BodySpec(remove=("left_eye", "right_eye"))}, "senses.vision: 'vision' req"),
}
TAKERS = {"build": mimoc.build, "make": mimoc.make, "grow_against_who": lambda spec: grow_against_who(spec, [9.0])}


@pytest.mark.parametrize("taker", TAKERS)
@pytest.mark.parametrize("case", UNVALIDATED)
def test_what_did_not_pass_validation_is_refused(case, taker):
    update, message = UNVALIDATED[case]
    copied = from_python(senses={"vision": {}}).model_copy(update=update)
    (problem,) = refusal(lambda: TAKERS[taker](copied))
    assert problem.startswith(f"<ours>: {message}")


@pytest.mark.extras
def test_a_training_refuses_it_too(tmp_path):
    copied = from_python().model_copy(update={"age_months": 99.0})
    assert refusal(lambda: mimoc.train(copied, tmp_path / "run"))
    assert not (tmp_path / "run").exists()


def test_a_spec_that_is_constructed_without_its_keys_is_refused():
    assert refusal(lambda: mimoc.build(mimoc.InfantSpec.model_construct(age_months=9.0))) == [
        "<spec>: mimoc: is missing; add it, such as 'mimoc: 1'",
        "<spec>: name: is missing; add it, such as 'name: my_infant'",
    ]


@pytest.mark.full
def test_a_right_value_that_was_copied_in_is_built():
    copied = from_python().model_copy(update={"body": {"hands": "five_finger"}, "age_months": 12})
    built = mimoc.build(copied)
    assert (built.manifest.child.age_months, len(built.manifest.actuation.actuators)) == (12.0, 88)
    right = mimoc.build(from_python(age_months=12, body={"hands": "five_finger"}))
    assert built.files["infant.xml"] == right.files["infant.xml"]


def test_a_path_or_a_string_of_one_is_built(spec, tmp_path):
    path = tmp_path / "infant.yaml"
    path.write_text(TEXT.replace("scene", "# scene"))
    files = mimoc.build(mimoc.load_spec(path)).files
    assert mimoc.build(path).files == mimoc.build(str(path)).files == files


def test_what_one_says_of_itself_is_a_line():
    from mimoc.compiler.building import builder

    spec = from_python(senses={"touch": {}}, scene={"kind": "room", "toys": {}})
    bundle = mimoc.build(spec)
    for told in (bundle, bundle.manifest, spec, spec.with_(age_months=3).source, builder(spec), bundle.manifest.senses):
        assert len(repr(told)) < 2500
        assert "\n" not in repr(told)
    assert len(repr(bundle)) < 120
    assert repr(from_python(body={"hands": "mitten"})) == (
        "InfantSpec(mimoc=1, name='ours', age_months=9.0, body=BodySpec(hands='mitten'))"
    )


values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.text(max_size=5), inner, max_size=2),
    max_leaves=4,
)
keys = st.sampled_from([*mimoc.InfantSpec.model_fields, "hands"])


@given(changes=st.dictionaries(keys, values, max_size=3))
@settings(max_examples=150, deadline=None)
def test_whatever_is_changed_the_result_is_a_spec_that_can_be_written_or_a_clear_refusal(changes):
    with suppress(SpecError):
        changed = from_python().with_(**changes)
        assert read_spec(parse(as_written(changed).text, "again.yaml")) == changed
        assert mimoc.InfantSpec.model_validate(to_data(changed)) == changed
