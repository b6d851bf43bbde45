"""The model of another age, cast without being printed, is the one that a whole build gives."""

from typing import Any

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.bundle.model import load_model
from mimoc.compiler.variants import SpecVariants, at_age

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
