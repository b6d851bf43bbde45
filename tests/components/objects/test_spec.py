"""The language of objects: documented fields with units, one kind by default, and errors that say what to do."""

import re

import pytest
from support.scenes_of_objects import spec_with

import mimoc
from mimoc.base.errors import SpecError
from mimoc.schema.infant import to_data
from mimoc.schema.kinds import OBJECTS
from mimoc.schema.objects import PointSpec, in_words

UNITS = ("cm", "g", "kg_m3", "deg")
NO_UNIT = {"friction", "colour"}
BALL = {"name": "ball", "at": {"x_cm": 60}}


@pytest.mark.parametrize("section", [PointSpec, *(kind.spec for kind in OBJECTS.values())])
def test_every_field_is_documented_and_its_unit_is_in_its_name(section):
    assert section.__doc__
    for name, field in section.model_fields.items():
        assert field.description, name
        if re.search(r"float", str(field.annotation)) and name not in NO_UNIT:
            assert name.endswith(tuple(f"_{unit}" for unit in UNITS)), name


def test_an_object_that_says_no_kind_is_a_shape_and_reads_back_as_it_was_written():
    spec = mimoc.InfantSpec.model_validate(spec_with(BALL))
    assert spec.scene.objects[0].kind == "shape"
    assert mimoc.InfantSpec.model_validate(to_data(spec)) == spec


def test_specs_without_objects_say_nothing_of_them():
    spec = mimoc.InfantSpec(mimoc=1, name="x", age_months=6)
    assert "objects" not in to_data(spec)["scene"]
    bundle = mimoc.build(spec)
    assert b'"objects"' not in bundle.files["manifest.json"]
    assert b"scene.objects" not in bundle.files["provenance.json"]


def test_words_are_a_relation_and_a_name():
    assert in_words("within  reach of right_hand") == ("within reach of", "right_hand")
    assert in_words("in front of the infant") == ("in front of", "infant")


@pytest.mark.parametrize(
    ("objects", "message"),
    [
        ([BALL, BALL], "objects[1].name: there is another object 'ball'; give each a name of its own"),
        ([{**BALL, "kind": "moblie"}], "objects[0].kind: 'moblie' is not a choice; did you mean 'mobile'?"),
        ([{**BALL, "raduis_cm": 4}], "objects[0].raduis_cm: unknown key; did you mean 'radius_cm'"),
        ([{**BALL, "radius": 4}], "objects[0].radius: unknown key; write 'radius_cm', in cm"),
        ([{**BALL, "radius_cm": 0}], "objects[0].radius_cm: 0 is too small; give 0.5 to 300 cm"),
        ([{**BALL, "at": "near chest"}], "objects[0].at: 'near chest' is not a place; write 'within reach of NAME'"),
        ([{**BALL, "at": 3}], "objects[0].at: 3 is not a place; write 'within reach of right_hand' or {x_cm: 20"),
        ([{**BALL, "above": "chest"}], "objects[0].above: it is at another place already; leave out 'at' or 'above'"),
        ([{**BALL, "height_cm": 9}], "objects[0].height_cm: it is above nothing; add 'above', or leave this out"),
        ([{**BALL, "sides_cm": [1, 2, 3]}], "objects[0].sides_cm: a sphere has no 'sides_cm'; leave it out"),
        ([{**BALL, "toy": "cup", "shape": "box"}], "objects[0].toy: it is a shape already; keep one of"),
        ([{**BALL, "mass_g": 9, "density_kg_m3": 99}], "objects[0].density_kg_m3: its mass is given already"),
        ([{**BALL, "tether_cm": 9}], "objects[0].tether_cm: this object is not hanging; write 'motion: hanging'"),
        ([{**BALL, "motion": "sliding", "slide_cm": [1, 9]}], "objects[0].slide_cm: it slides from its place, 0"),
        ([{"at": "on table"}], "objects[0].name: is missing; add it"),
        (["ball"], "objects[0]: "),
        ("ball", "scene.objects: 'ball' is not a list; write"),
        (
            [{"name": "m", "kind": "mobile", "above": "head", "tied_to": "nose"}],
            "objects[0].tied_to: 'nose' is not a choice",
        ),
        ([{"name": "m", "kind": "mobile", "above": "head", "figures": ["cat"]}], "figures"),
        ([{**BALL, "toy": "cup", "size_cm": 900}], "objects[0].size_cm: 900 is too large; give 0.5 to 100 cm"),
        ([{**BALL, "kind": "mobile", "size_cm": 900}], "objects[0].size_cm: 900 is too large; give 3 to 12 cm"),
        ([{**BALL, "shape": "box", "sides_cm": [1, 2]}], "sides_cm: expected 3 values, got 2; write [a, b, c]"),
    ],
)
def test_what_is_wrong_gets_one_line_at_its_key(objects, message):
    spec = spec_with()
    spec["scene"]["objects"] = objects
    with pytest.raises(SpecError) as refusal:
        mimoc.InfantSpec.model_validate(spec)
    (problem,) = refusal.value.problems
    assert message in f"{problem.key}: {problem.message}", str(problem)
    assert re.fullmatch(r"[^;]+; [^;]+", problem.message), problem.message
