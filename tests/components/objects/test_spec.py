"""The language of objects: documented fields with units, one kind by default, and errors that say what to do."""

import re
from typing import Annotated, Literal

import mujoco
import numpy as np
import pytest
from pydantic import Field
from support.registering import registered
from support.scenes_of_objects import drift_m, spec_with, started

import mimoc
from mimoc.base.errors import KindError, SpecError
from mimoc.compiler.explain import explain
from mimoc.compiler.mjcf.furniture import WorldMaterial
from mimoc.compiler.mjcf.world import ObjectBody
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name, solid
from mimoc.schema.infant import to_data
from mimoc.schema.json_schema import json_schema
from mimoc.schema.kinds import OBJECTS, ObjectKind
from mimoc.schema.objects import ObjectSpec, PointSpec, in_words
from mimoc.schema.quantities import Centimetres

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


@pytest.mark.parametrize("kind", OBJECTS)
def test_every_kind_is_an_object_with_a_name_and_a_place(kind):
    assert issubclass(OBJECTS[kind].spec, ObjectSpec)
    assert OBJECTS[kind].spec.model_fields.keys() > {"kind", "name", "at", "above", "height_cm", "yaw_deg"}


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


class StoolSpec(ObjectSpec):
    """A stool."""

    kind: Literal["stool"]
    """Kind of object."""
    stool_cm: Annotated[Centimetres, Field(ge=5, le=60)] = 20.0
    """Height of its seat."""


def build_stool(spec: StoolSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a block to sit on, as broad as the infant is long."""
    assert surroundings.tree.bodies
    name, half_m = object_name(spec.name), spec.stool_cm / 200
    geom = solid(name, name, "box", (0.1, 0.1, half_m), (0.0, 0.0, 0.0), 1.0)
    return BuiltObject(
        root=ObjectBody(name, pos_m=(0.0, 0.0, half_m), geoms=(geom,)),
        materials=(WorldMaterial(name, (0.5, 0.4, 0.3, 1.0)),),
        motion="fixed",
        material="wood",
        radius_m=0.15,
        height_m=2 * half_m,
        size_m=0.2,
        mass_kg=1.0,
        surface_m=(0.1, 0.1),
        origins={"seat": {"value": 2 * half_m, "unit": "m", "rule": "given", "from": ["spec.scene.objects"]}},
    )


STOOL = ObjectKind("stool", "A stool.", StoolSpec, build_stool)
SPEC = spec_with(
    {"name": "stool", "kind": "stool", "stool_cm": 12, "at": {"x_cm": 60}},
    {"name": "cup", "toy": "cup", "at": "on stool"},
)


@pytest.fixture
def stool():
    with registered(STOOL):
        yield


def test_an_added_kind_is_built_placed_explained_and_in_the_schema(stool):
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(SPEC))
    entry, cup = bundle.manifest.objects
    assert (entry.kind, entry.motion, entry.joint) == ("stool", "fixed", None)
    assert bundle.manifest.plugins == {"objects.stool": ""}
    model, data = started(bundle)
    np.testing.assert_allclose(data.body(entry.body).xpos, (0.6, 0.0, 0.06))
    assert data.body(cup.body).xpos[2] - cup.origin_m == pytest.approx(0.12)
    for _ in range(300):
        mujoco.mj_step(model, data)
    assert drift_m(bundle, model, data) < 1e-3
    assert "0.12" in str(explain(bundle, "object.stool.seat"))
    assert "StoolSpec" in json_schema()["$defs"]


def test_what_it_refuses_is_said_at_its_key(stool):
    with pytest.raises(SpecError, match=r"scene.objects\[0\].stool_cm: 2 is too small; give 5 to 60 cm"):
        mimoc.InfantSpec.model_validate(
            spec_with({"name": "stool", "kind": "stool", "stool_cm": 2, "at": {"x_cm": 60}})
        )


def test_without_it_the_kind_is_unknown():
    with pytest.raises(SpecError, match=r"objects\[0\].kind: 'stool' is not a choice"):
        mimoc.InfantSpec.model_validate(SPEC)
    assert "stool" not in OBJECTS


def test_its_name_must_be_free():
    with (
        pytest.raises(KindError, match="there is a kind of object 'shape' already, from mimoc"),
        registered(ObjectKind("shape", "Another.", StoolSpec, build_stool)),
    ):
        pass
