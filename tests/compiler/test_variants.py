"""Infants and worlds of other ages, cast without being printed, are those that a whole build gives."""

import copy
import pickle
from typing import Any

import mujoco
import numpy as np
import pytest
from support.full import full_but
from support.worlds import ANNA, BEN, world, written

import mimoc
from mimoc.base.errors import SpecError, UnknownNameError
from mimoc.bundle.model import load_model
from mimoc.bundle.world import load_world_model
from mimoc.compiler.variants import SpecVariants, WorldBundleVariants, WorldVariants, at_age
from mimoc.compiler.worlds import plan_world
from mimoc.schema.infant import InfantSpec

SENSES = {"proprioception": {}, "vestibular": {}}
STATISTICS = ("meaninertia", "meanmass", "meansize", "extent", "center")
AGES_MONTHS = (17.25, 3.0, 9.0, 0.0)
INFANTS: dict[str, dict[str, Any]] = {
    "average": {},
    "five fingers": {"body": {"hands": "five_finger", "chest_joint": True}},
    "muscles": {"actuation": {"model": "muscle"}},
    "servos": {"actuation": {"model": "position"}},
    "published": {"development": "published", "actuation": {"model": "muscle"}},
    "percentiles": {"body": {"individual": {"sex": "female", "length_percentile": 80, "weight_percentile": 30}}},
    "one arm, stronger": {"body": {"remove": ["left_lower_arm"]}, "actuation": {"strength": {"legs": 1.5}}},
    "room with toys": {"scene": {"kind": "room", "toys": {"count": [3, 3]}, "pose": "sitting"}},
    "crib with toys": {"scene": {"kind": "crib", "toys": {"count": [2, 2]}}},
    "reaching": {"task": {"kind": "reach"}},
    "catching": {"task": {"kind": "catch"}},
    "held": {"scene": {"held": ["hip"], "pose": "sitting"}, "actuation": {"locked": ["neck"]}},
    "seeing and feeling": {"senses": {"vision": {"acuity": "age"}, "touch": {"density": 0.2}}},
}
DIFFERENT = ("five fingers", "published", "one arm, stronger", "crib with toys", "seeing and feeling")
"""Infants that have, between them, whatever a model is made of."""


def spec(**keys: Any) -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "infant", "age_months": 9, "senses": SENSES, **keys})


def differences(model: mujoco.MjModel, expected: mujoco.MjModel) -> list[str]:
    """Return the names of all that differs between two models, but for what they are called, in as many letters."""
    names = [name for name in dir(expected) if not name.startswith("_") and name != "names"]
    values = [(name, getattr(model, name), getattr(expected, name)) for name in names]
    plain = [(name, *pair) for name, *pair in values if isinstance(pair[0], (np.ndarray, int, float, bytes))]
    statistics = [(name, getattr(model.stat, name), getattr(expected.stat, name)) for name in STATISTICS]
    parts = ("names", model.names[model.name_bodyadr[0] :], expected.names[expected.name_bodyadr[0] :])
    return [name for name, found, wanted in (*plain, *statistics, parts) if not equal(found, wanted)]


def equal(found: Any, wanted: Any) -> bool:
    """Return whether two arrays or numbers are the same; MuJoCo 3.5 has no normals of degenerate faces of meshes."""
    return np.array_equal(found, wanted, equal_nan=np.asarray(wanted).dtype.kind == "f")


@pytest.mark.full
@pytest.mark.parametrize("infant", full_but(DIFFERENT, list(INFANTS)))
def test_a_variant_is_what_a_build_of_its_age_gives(infant):
    variants = SpecVariants(spec(**INFANTS[infant]))
    found = {age_months: variants(age_months, 0) for age_months in AGES_MONTHS}
    built = {age_months: mimoc.build(at_age(spec(**INFANTS[infant]), age_months)) for age_months in AGES_MONTHS}
    for age_months in AGES_MONTHS:
        ours, theirs = found[age_months].bundle, built[age_months]
        assert differences(found[age_months].model, load_model(theirs)) == [], age_months
        assert ours.manifest == theirs.manifest
        assert all(np.array_equal(ours.arrays[name], theirs.arrays[name]) for name in theirs.arrays)
    assert found[AGES_MONTHS[-1]].bundle.files == built[AGES_MONTHS[-1]].files


@pytest.mark.full
@pytest.mark.parametrize("infant", full_but(DIFFERENT, list(INFANTS)))
def test_an_infant_cast_from_another_is_what_a_build_of_it_gives(infant):
    first, own = SpecVariants(spec(**INFANTS[infant])), at_age(spec(**INFANTS[infant], name="second"), 17.25)
    second = SpecVariants(own)
    found, built = second.own_like(first), mimoc.build(own)
    assert differences(found.model, load_model(built)) == []
    assert found.bundle.manifest == built.manifest
    assert found.bundle.files == built.files
    younger, of_3_months = second(3.0, 0), mimoc.build(at_age(own, 3.0))
    assert differences(younger.model, load_model(of_3_months)) == []
    assert differences(first(9.0, 0).model, load_model(mimoc.build(spec(**INFANTS[infant])))) == []


def test_an_infant_of_other_parts_is_built_by_itself():
    five = spec(body={"hands": "five_finger"})
    found = SpecVariants(five).own_like(SpecVariants(spec()))
    assert differences(found.model, load_model(mimoc.build(five))) == []


@pytest.mark.parametrize("age_months", [9.0, 12.0])
def test_a_variant_has_other_scenes_too(age_months):
    variants = SpecVariants(spec(scene={"kind": "room", "toys": {"count": [2, 2]}}))
    variants(age_months, 0)
    room = spec(scene={"kind": "room", "toys": {"count": [2, 2]}, "seed": 4})
    built = mimoc.build(at_age(room, age_months))
    found = variants(age_months, 4)
    assert differences(found.model, load_model(built)) == []
    assert found.bundle.manifest == built.manifest


def test_models_of_one_age_belong_to_whoever_asked():
    variants = SpecVariants(spec())
    first = variants(12, 0).model
    first.body_mass[:] = 7.0
    assert not (variants(12, 0).model.body_mass == 7.0).any()


def test_measures_keep_their_z_scores_and_their_ratios():
    child = spec(body={"individual": {"sex": "male", "length_cm": 73.0}, "measurements": {"hand_breadth_cm": 4.2}})
    older = at_age(child, 18)
    assert older.age_months == 18
    assert older.body.individual
    assert older.body.individual.length_cm == pytest.approx(83.8, abs=0.5)
    assert 4.2 < older.body.measurements["hand_breadth_cm"] < 5.2
    again = at_age(older, 9).body.individual
    assert again
    assert again.length_cm == pytest.approx(73.0)
    assert at_age(child, 9) is child


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
