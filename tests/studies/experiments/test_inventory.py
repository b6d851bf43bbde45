import math
from pathlib import Path

import mujoco
import pytest

import mimoc
from mimoc.bundle.model import load_model
from mimoc.compiler import building
from mimoc.studies.experiments.rooms import SPEC, take_inventory

SEED = 7
PLAYROOM = Path(__file__).parents[3] / "configs" / "playroom.yaml"


@pytest.fixture(scope="module")
def builder():
    return building.builder(mimoc.InfantSpec.model_validate(SPEC))


@pytest.fixture(scope="module")
def room(builder):
    return take_inventory(builder, SEED)


@pytest.fixture(scope="module")
def bundle(builder):
    return builder(SEED, check=False)


@pytest.fixture(scope="module")
def started(bundle):
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(bundle.manifest.pose).id)
    mujoco.mj_forward(model, data)
    return model, data


def test_the_playroom_is_that_of_the_config():
    spec, config = mimoc.InfantSpec.model_validate(SPEC), mimoc.load_spec(PLAYROOM)
    assert (spec.age_months, spec.body) == (config.age_months, config.body)
    assert spec.scene.model_copy(update={"seed": config.scene.seed}) == config.scene


def test_its_toys_are_those_of_the_bundle(room, bundle):
    listed = [(toy.object, toy.category) for toy in bundle.manifest.toys]
    assert [(toy.name, toy.category) for toy in room.toys] == listed
    for toy, entry in zip(room.toys, bundle.manifest.toys, strict=True):
        assert (toy.size_m, toy.mass_kg) == pytest.approx((entry.size_m, entry.mass_kg))


def test_its_size_and_place_are_those_of_the_model(room, started):
    model, data = started
    assert room.size_m[:2] == pytest.approx(2 * model.geom("floor").size[:2])
    assert room.size_m[2] == pytest.approx(2 * model.geom("wall_front").size[1])
    assert room.place_m == pytest.approx(data.body("hip").xpos[:2], abs=1e-6)


def test_places_are_counted_from_where_the_infant_looks(room, bundle, started):
    """The middle between the shoulders is where `PositionTask` says; ahead is where the hip's x axis points."""
    _, data = started
    ahead = data.body("hip").xmat.reshape(3, 3)[:2, 0]
    ahead = ahead / math.hypot(*ahead)
    left = (-ahead[1], ahead[0])
    for toy, entry in zip(room.toys, bundle.manifest.toys, strict=True):
        offset = data.body(entry.body).xpos[:2] - room.reach.centre_m
        assert (toy.ahead_m, toy.left_m) == pytest.approx((offset @ ahead, offset @ left), abs=1e-5)
        assert toy.within_reach == (toy.distance_m <= room.reach.radius_m)


def test_a_room_has_six_papers_and_some_pictures_and_lamps(room):
    assert len(room.textures) == 6
    assert room.floor.startswith("floor_")
    assert (2 <= room.pictures <= 4, 1 <= room.lamps <= 2) == (True, True)


def test_another_seed_is_another_room(builder, room):
    assert take_inventory(builder, SEED) == room
    assert take_inventory(builder, SEED + 1) != room
