"""A kind of scene is one record: what mimoc knows of its own, it knows of one that others add."""

import json

import mujoco
import pytest
from pydantic import Field
from support.registering import registered

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler.explain import entries_of, explain
from mimoc.compiler.mjcf.furniture import Furniture, WorldGeom, WorldMaterial
from mimoc.compiler.mjcf.world import Ground, World
from mimoc.compiler.scenes import SUN, BuiltScene
from mimoc.schema.base import Model
from mimoc.schema.kinds import SceneKind

SPEC = {"mimoc": 1, "name": "x", "age_months": 9, "senses": {"proprioception": {}}}


class StepSpec(Model):
    """A step on the floor."""

    height_m: float = Field(default=0.1, gt=0, le=1)
    """Of its top."""


def build_step(spec, occupant, wallpapers) -> BuiltScene:
    """Return a floor with a step two metres ahead; nothing of it depends on the infant."""
    assert len(occupant.discs) == 0 or spec.toys
    half = spec.step.height_m / 2
    step = WorldGeom("step", "box", (0.2, 0.5, half), (2.0, 0.0, half), (0.0, 0.0, 0.0), "step")
    furniture = Furniture((step,), (WorldMaterial("step", (0.5, 0.4, 0.3, 1.0)),))
    origins = {
        "step.height": {
            "value": spec.step.height_m,
            "unit": "m",
            "rule": "given by the spec",
            "from": ["spec.scene.step.height_m"],
        }
    }
    world = World(grounds=(Ground("floor", 0.0),), lights=(SUN,), furniture=furniture)
    return BuiltScene(world, half_size_m=(1.7, 1.7), origins=origins)


STEP = SceneKind(
    name="step",
    about="A floor with a step.",
    build=build_step,
    spec=StepSpec,
    needs_footprint=False,
    varies=False,
)


@pytest.fixture(scope="module", autouse=True)
def _step():
    with registered(STEP):
        yield


@pytest.fixture(scope="module")
def bundle() -> mimoc.Bundle:
    scene = {"kind": "step", "step": {"height_m": 0.2}, "toys": {"count": [2, 2]}}
    return mimoc.build(mimoc.InfantSpec.model_validate({**SPEC, "scene": scene}))


def test_it_is_built_with_toys_on_its_floor(bundle):
    model = mujoco.MjModel.from_xml_string(bundle.files["scene.xml"].decode(), assets=dict(bundle.files))
    assert model.geom("step").size.tolist() == [0.2, 0.5, 0.1]
    assert len(bundle.manifest.toys) == 2


def test_without_toys_no_footprint_is_computed():
    mimoc.build(mimoc.InfantSpec.model_validate({**SPEC, "scene": {"kind": "step"}}))


def test_an_environment_opens_in_it(bundle):
    env = mimoc.make(bundle)
    env.reset(seed=0)
    assert env.step(env.action_space.sample())[4] is not None
    env.close()


def test_its_numbers_can_be_explained(bundle):
    said = explain(bundle, "step.height")
    assert said.lines[0].startswith("0.2 m")
    assert [source.key for source in said.sources] == ["spec.scene.step.height_m"]


def test_the_bundle_says_that_it_is_not_mimocs_own(bundle):
    assert bundle.manifest.plugins == {"scenes.step": ""}
    assert json.loads(bundle.files["manifest.json"])["plugins"] == {"scenes.step": ""}
    assert "- 'scenes.step' is a plug-in that a script registered" in bundle.files["README.md"].decode()
    assert explain(bundle, "plugins.scenes.step").lines


def test_the_spec_language_has_its_keys_and_checks_them(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("mimoc: 1\nname: x\nage_months: 9\nscene: {kind: step, step: {height_m: 3}}\n")
    with pytest.raises(SpecError, match=r"scene\.step\.height_m: 3 is too large"):
        mimoc.load_spec(path)
    path.write_text("mimoc: 1\nname: x\nage_months: 9\nscene: {kind: stepp}\n")
    with pytest.raises(SpecError, match="did you mean 'step'"):
        mimoc.load_spec(path)


def test_a_bundle_of_mimocs_own_kinds_names_no_plug_ins():
    bundle = mimoc.build(mimoc.InfantSpec.model_validate({**SPEC, "scene": {"kind": "crib"}}))
    assert bundle.manifest.plugins == {}
    assert not any(key.startswith("plugins.") for key in entries_of(bundle))
