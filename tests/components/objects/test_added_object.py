"""A kind of object is one record: what mimoc knows of its own, it knows of one that others add."""

from typing import Annotated, Literal

import mujoco
import numpy as np
import pytest
from pydantic import Field
from support.registered import registered
from support.scenes_of_objects import drift_m, spec_with, started

import mimoc
from mimoc.base.errors import KindError, SpecError
from mimoc.compiler.explain import explain
from mimoc.compiler.mjcf.furniture import WorldMaterial
from mimoc.compiler.mjcf.world import ObjectBody
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.compiler.objects.pieces import solid
from mimoc.schema.components.objects import OBJECTS
from mimoc.schema.json_schema import json_schema
from mimoc.schema.kinds import ObjectKind
from mimoc.schema.object_base import ObjectSpec
from mimoc.schema.quantities import Centimetres


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
