"""Worlds whose infants have other ages, or in the scene of another seed."""

import copy
import pickle

import mujoco
import numpy as np
import pytest
from support.worlds import ANNA, BEN, world, written

import mimoc
from mimoc.base.errors import SpecError, UnknownNameError
from mimoc.bundle.world import load_world_model
from mimoc.compiler.world_variants import WorldBundleVariants, WorldVariants
from mimoc.compiler.worlds import plan_world
from mimoc.schema.infant import InfantSpec

AGES = {"anna": 12.0, "ben": 4.5}


@pytest.fixture(scope="module")
def variants():
    infants = {"anna": InfantSpec.model_validate(ANNA), "ben": InfantSpec.model_validate(BEN)}
    return WorldVariants(plan_world(infants, scene={"kind": "room", "toys": {"count": [2, 2]}}))


def test_a_world_at_its_own_ages_has_the_bytes_of_its_build(variants):
    same = variants({}, scene_seed=0).bundle
    assert dict(same.files) == dict(variants.original.files)
    assert same.manifest == variants.original.manifest
    assert same.infants["ben"].manifest == variants.original.infants["ben"].manifest


def test_each_infant_has_its_age_and_the_model_is_that_of_the_files(variants):
    older = variants(AGES, scene_seed=0)
    assert {name: infant.manifest.child.age_months for name, infant in older.bundle.infants.items()} == AGES
    again = load_world_model(older.bundle)
    assert np.array_equal(again.body_mass, older.model.body_mass)
    assert np.array_equal(again.key_qpos, older.model.key_qpos)
    assert {*older.bundle.infants["ben"].files} == {*variants.original.infants["ben"].files}


def test_infants_keep_their_places_and_parts(variants):
    own, older = variants.original, variants(AGES, scene_seed=0)
    model = load_world_model(own)
    assert older.model.nq == model.nq
    assert own.infants["anna"].manifest.keypoints == older.bundle.infants["anna"].manifest.keypoints
    apart = [_place(one, "ben") - _place(one, "anna") for one in (model, older.model)]
    assert apart[0] == pytest.approx(apart[1])


def _place(model: mujoco.MjModel, name: str) -> np.ndarray:
    address = model.joint(f"{name}_mimo_location").qposadr[0]
    return model.key("start").qpos[address : address + 2]


def test_another_seed_is_another_scene_around_the_same_infants(variants):
    other = variants({}, scene_seed=7)
    assert other.bundle.manifest.seed == other.bundle.infants["anna"].manifest.seed == 7
    assert other.bundle.manifest.toys != variants.original.manifest.toys


def test_whoever_asks_gets_a_model_of_its_own(variants):
    first, second = variants(AGES, 0), variants(AGES, 0)
    assert first.bundle is second.bundle
    first.model.body_mass[:] = 0
    assert second.model.body_mass.any()


def test_a_bundle_holds_the_specs_of_its_infants(tmp_path):
    bundle = mimoc.read_world_bundle(mimoc.write_bundle(world(anna=ANNA, ben=BEN), tmp_path / "two"))
    from_bundle = copy.deepcopy(WorldBundleVariants(bundle))
    from_specs = pickle.loads(
        pickle.dumps(
            WorldVariants(plan_world({k: InfantSpec.model_validate(v) for k, v in zip(AGES, (ANNA, BEN), strict=True)}))
        )
    )
    one, other = from_bundle(AGES, 0), from_specs(AGES, 0)
    assert not from_bundle.has_other_scenes
    assert one.bundle.infants["anna"].manifest == other.bundle.infants["anna"].manifest
    assert one.bundle.manifest.notes == ()
    assert np.array_equal(one.model.key_qpos, other.model.key_qpos)


def test_an_error_says_which_infant_at_which_age(tmp_path):
    early = {**BEN, "impairments": {"gestation_weeks": 30}}
    variants = WorldVariants(plan_world(written(tmp_path, "infants: [anna.yaml, ben.yaml]\n", anna=ANNA, ben=early)))
    with pytest.raises(SpecError, match=r"ben\.yaml.*'ben' at 1 months: .* not at term"):
        variants({"ben": 1.0}, 0)
    with pytest.raises(UnknownNameError, match="bem"):
        variants({"bem": 3.0}, 0)
