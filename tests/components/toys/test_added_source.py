"""A source of toys is one record: what mimoc knows of its own, it knows of one that others add."""

import pytest
import trimesh
from pydantic import Field
from support.registering import registered

import mimoc
from mimoc.base.errors import SpecError, UnknownToysError, suggestion
from mimoc.compiler.explain import explain
from mimoc.compiler.toys.placing import Toybox
from mimoc.compiler.toys.shape import Mesh, Solid, assemble
from mimoc.schema.base import Model
from mimoc.schema.kinds import ToySource

SPEC = {"mimoc": 1, "name": "x", "age_months": 9, "senses": {"proprioception": {}}}


class BricksSpec(Model):
    """Toy bricks."""

    density_kg_m3: float = Field(default=600.0, gt=0, le=5000)
    """Of their wood."""


def build_bricks(spec, folder) -> Toybox:
    """Return bricks of two lengths."""
    lengths = {"brick": 2.0, "plank": 5.0}
    unknown = [name for name in spec.subset if name not in lengths]
    if unknown:
        raise UnknownToysError({name: f"'{name}' is no brick; {suggestion(name, lengths)}" for name in unknown})

    def load(name):
        brick = trimesh.creation.box((lengths[name], 1.0, 1.0))
        looks = {"main": [Mesh(brick.vertices, brick.faces)]}
        return assemble(name, looks, [Solid("box", (lengths[name] / 2, 0.5, 0.5))], spec.bricks.density_kg_m3)

    return Toybox(tuple(sorted(spec.subset or lengths)), load, ("the bricks are made of wood",))


BRICKS = ToySource(name="bricks", about="Toy bricks.", build=build_bricks, spec=BricksSpec)


@pytest.fixture(scope="module", autouse=True)
def _bricks():
    with registered(BRICKS):
        yield


@pytest.fixture(scope="module")
def bundle() -> mimoc.Bundle:
    toys = {"source": "bricks", "count": [3, 3], "size_cm": [10, 10], "bricks": {"density_kg_m3": 500}}
    return mimoc.build(mimoc.InfantSpec.model_validate({**SPEC, "scene": {"kind": "flat", "toys": toys}}))


def test_its_toys_are_built_as_heavy_as_its_keys_say(bundle):
    masses_kg = {"brick": 500 * 0.1 * 0.05**2, "plank": 500 * 0.1 * 0.02**2}
    assert len(bundle.manifest.toys) == 3
    for toy in bundle.manifest.toys:
        assert toy.mass_kg == pytest.approx(masses_kg[toy.object])


def test_an_environment_opens_with_them(bundle):
    env = mimoc.make(bundle)
    env.reset(seed=0)
    assert env.step(env.action_space.sample())[4] is not None
    env.close()


def test_their_numbers_can_be_explained(bundle):
    toy = bundle.manifest.toys[0]
    assert explain(bundle, f"toy.{toy.body}.mass").lines
    assert explain(bundle, "spec.scene.toys.bricks.density_kg_m3").lines[0].startswith("500")


def test_the_bundle_says_where_they_come_from_and_what_the_source_notes(bundle):
    assert bundle.manifest.plugins == {"toys.bricks": ""}
    readme = bundle.files["README.md"].decode()
    assert "- 'toys.bricks' is a plug-in that a script registered" in readme
    assert "- the bricks are made of wood" in readme


def test_an_unknown_toy_is_pointed_at(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("mimoc: 1\nname: x\nage_months: 9\nscene:\n  toys: {source: bricks, subset: [brick, plunk]}\n")
    with pytest.raises(SpecError, match=r":5:42: scene\.toys\.subset\[1\]: 'plunk' is no brick; did you mean 'plank'"):
        mimoc.build(path)
