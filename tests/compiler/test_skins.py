"""Who has a skin, and what it is at other ages."""

import copy
import pickle

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.bundle.model import load_model
from mimoc.compiler.building import builder, sees_skin
from mimoc.compiler.looks import skin as carrying
from mimoc.compiler.looks.skin import layers_of
from mimoc.compiler.mjcf.scene import single
from mimoc.compiler.variants import SpecVariants, skin_at

LAYERS = ["body", "shirt", "trousers", "head", "hair"]
SPEC = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"proprioception": {}}}
VISION = {"width_px": 16, "height_px": 16}
SEES_SOLIDS = {**VISION, "body": "solids"}


def spec(**keys) -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate({**SPEC, **keys})


def skins(model: mujoco.MjModel) -> list[str]:
    return [model.skin(index).name for index in range(model.nskin)]


def test_a_single_infant_has_a_skin_unless_its_spec_says_no(built):
    assert skins(load_model(built())) == LAYERS
    assert skins(load_model(built(body={"skin": False}))) == []


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({}, []),
        ({"body": {"skin": True}}, LAYERS),
        ({"senses": {"vision": VISION}}, LAYERS),
        ({"senses": {"vision": SEES_SOLIDS}}, []),
    ],
)
def test_infants_in_a_batch_have_one_only_if_asked_or_seen(keys, expected):
    infants = mimoc.make_vec(spec(**keys), num_envs=2, threads=1)
    try:
        assert [skins(infant.model) for infant in infants.infants] == [expected] * 2
    finally:
        infants.close()


def test_eyes_see_skins_unless_the_spec_says_solids_or_the_law_is_the_published_one():
    assert sees_skin(spec(senses={"vision": VISION}))
    assert not sees_skin(spec(senses={"vision": SEES_SOLIDS}))
    assert not sees_skin(spec(senses={"vision": VISION}, development="published"))
    assert sees_skin(spec(senses={"vision": {**VISION, "body": "skin"}}, development="published"))
    assert not sees_skin(spec())


@pytest.mark.parametrize(("development", "expected"), [("maturing", None), ("published", "solids")])
def test_a_bundle_says_what_eyes_see(development, expected):
    bundle = builder(spec(senses={"vision": VISION}, development=development), skin=False)(0, check=False)
    assert bundle.manifest.senses.vision.body == expected


def test_code_written_for_mimo_is_given_solids():
    model = load_model(builder(spec(), "mimo")(0))
    assert skins(model) == []


def test_a_bundle_without_a_skin_grows_without_one():
    bundle = builder(spec(), skin=False)(0)
    with mimoc.make(bundle) as env:
        env.reset(seed=0)
        env.unwrapped.grow(to=9.5)
        assert skins(env.unwrapped.model) == []


def test_the_skin_of_a_growing_infant_grows():
    with mimoc.make(spec()) as env:
        env.reset(seed=0)
        before = np.ptp(env.unwrapped.model.skin_vert, axis=0)
        env.unwrapped.grow(to=18)
        model = env.unwrapped.model
        assert (np.ptp(model.skin_vert, axis=0) > 1.05 * before).all()
        for layer in skin_at(spec(), 18):
            first = model.skin_vertadr[model.skin(layer.name).id]
            assert np.array_equal(model.skin_vert[first : first + len(layer.verts_m)], single(layer.verts_m))


def test_copies_of_what_builds_an_infant_keep_whether_it_has_a_skin():
    variants = pickle.loads(pickle.dumps(SpecVariants(spec(), skin=False)))
    assert skins(variants(8.0, 0).model) == []
    assert not pickle.loads(pickle.dumps(builder(spec(), skin=False))).has_skin


def test_an_expression_changes_the_material_of_the_head(built):
    env = mimoc.InfantEnv(built(), render_mode=None)
    try:
        env.reset(seed=0)
        env.set_expression("sad")
        head, material = env.model.skin("head"), env.model.material("head_sad")
        assert env.model.skin_matid[head.id] == material.id
        assert env.model.mat_texid[material.id].max() == env.model.tex("tex_head_sad").id
    finally:
        env.close()


def test_infants_that_differ_in_their_scenes_alone_share_a_skin(monkeypatch):
    carried = []
    monkeypatch.setattr(carrying, "layers_of", lambda *args: carried.append(args) or layers_of(*args))
    carrying.skin_of.cache_clear()
    for seed in (1, 2):
        mimoc.build(spec(scene={"kind": "room", "seed": seed}))
    assert len(carried) == 1
    mimoc.build(spec(age_months=10))
    assert len(carried) == 2


def test_a_skin_of_a_bundle_is_that_of_its_spec(built):
    for ours, theirs in zip(skin_at(built()), skin_at(spec()), strict=True):
        assert np.array_equal(ours.verts_m, theirs.verts_m)


@pytest.mark.parametrize(
    ("keys", "options", "expected"),
    [
        ({}, {}, 0),
        ({"senses": {"vision": SEES_SOLIDS}}, {}, 0),
        ({"senses": {"vision": VISION}}, {}, 1),
        ({}, {"render_mode": "rgb_array"}, 1),
    ],
)
def test_skin_is_carried_to_another_age_only_for_what_draws_it(keys, options, expected, monkeypatch):
    carried = []
    monkeypatch.setattr(carrying, "layers_of", lambda *args: carried.append(args) or layers_of(*args))
    carrying.skin_of.cache_clear()
    with mimoc.make(spec(**keys), **options) as env:
        env.reset(seed=0)
        carried.clear()
        env.unwrapped.grow(to=10)
        for _ in range(2):
            env.step(env.action_space.sample())
        assert len(carried) == expected
        assert env.unwrapped.model.skin_vert.size
        assert len(carried) == 1


@pytest.mark.parametrize("again", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_copies_of_a_grown_infant_have_its_skin(again):
    with mimoc.make(spec()) as env:
        env.reset(seed=0)
        env.unwrapped.grow(to=18)
        twin = again(env.unwrapped)
        assert np.array_equal(twin.model.skin_vert, env.unwrapped.model.skin_vert)
        twin.close()
