"""The skin: one mesh for each kind of hands, carried to every child by its solids."""

import io
import json
import warnings
import zipfile
from dataclasses import replace
from functools import cache

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from support.posed_skins import edges_of, lengths, posed
from support.skin_bodies import child, children

from mimoc.base.arrays import read_arrays, together
from mimoc.base.errors import DataError, GeometryError
from mimoc.body.kinematics import frames_in_world, pose
from mimoc.body.poses import POSES, poses_of, resting_state
from mimoc.body.tree import head_radius
from mimoc.compiler.looks.sculpture import BARE, FOLDER, assembled, template_mesh
from mimoc.compiler.looks.skin import layers_of, skin_of, surface_distance
from mimoc.compiler.mjcf.scene import NAME_BYTES, SkinLayer, encode_skn, single

HANDS = ("mitten", "five_finger")
BELOW_FLOOR_M = 0.002  # How far skin may be below the floor that the solids rest on, or above it where it rests.
TURNED_M = 0.0012
"""How much farther trousers may be on the back: the skin was made for legs that lie straight, and tone and relaxed hips
turn thighs outwards by 25 to 44 degrees."""
BELLY_M = 0.0035  # How much farther a round belly may be that an infant lies on: it would give way.
HAIR_M = 0.009  # How much farther hair may be, which is soft.
CHEEK_M = 0.003
"""How much farther a cheek and an ear may be that an infant lies on: they are rounder than the solid of its head."""


@cache
def layers(age_months: float, hands: str) -> tuple[SkinLayer, ...]:
    return skin_of(dressed(child(age_months, hands))).layers


def dressed(tree):
    return replace(tree, clothes="shirt_and_trousers")


@pytest.mark.parametrize("hands", HANDS)
def test_all_ages_have_the_same_faces_textures_and_weights(hands):
    for young, old in zip(layers(0, hands), layers(24, hands), strict=True):
        assert (young.name, young.bones) == (old.name, old.bones)
        for array in ("faces", "texcoords", "weights")[:: 2 if young.name == "hair" else 1]:
            assert np.array_equal(getattr(young, array), getattr(old, array))
        assert young.verts_m.shape == old.verts_m.shape


@pytest.mark.parametrize("hands", HANDS)
def test_weights_of_a_vertex_sum_to_one_and_are_of_at_most_four_bodies(hands):
    for layer in layers(9, hands):
        assert np.allclose(layer.weights.sum(axis=1), 1, atol=1e-12)
        assert (layer.weights >= 0).all()
        assert (layer.weights > 0).sum(axis=1).max() <= 4


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 6, 9, 18, 24])
def test_skin_rests_on_the_floor_where_solids_do(age_months, hands):
    tree = child(age_months, hands)
    for name in POSES:
        placed = frames_in_world(tree, resting_state(tree, poses_of(tree)[name]))
        lowest_m = {layer.name: posed(layer, placed)[:, 2].min() for layer in layers(age_months, hands)}
        assert min(lowest_m.values()) < BELOW_FLOOR_M, name
        assert lowest_m.pop("head") > -BELOW_FLOOR_M - CHEEK_M, name
        assert lowest_m.pop("hair") > -BELOW_FLOOR_M - HAIR_M, name
        trousers_m = lowest_m.pop("trousers") + (TURNED_M if name == "supine" else 0.0)
        shirt_m = lowest_m.pop("shirt") + (BELLY_M if name == "prone" else 0.0)
        assert min(*lowest_m.values(), shirt_m, trousers_m) > -BELOW_FLOOR_M, name


def heights_off_m(tree, sculpted) -> float:
    """Return how far vertices are, on average, from their sculpted heights above the child's own solids."""
    verts_m = layers_of(replace(tree, clothes=BARE), replace(sculpted, fullness_m=0 * sculpted.fullness_m))[0].verts_m
    mesh, placed = sculpted.mesh, pose(tree, sculpted.angles_rad)
    height_m, _ = surface_distance(placed, sculpted.solids, mesh.near, mesh.blend_m, verts_m)
    size = head_radius(tree.geoms["head"]) / sculpted.head_radius_m
    return np.abs(height_m - size * mesh.offsets_m).mean()


@pytest.mark.parametrize("hands", HANDS)
def test_solids_of_the_skin_are_those_of_the_child_that_it_was_sculpted_on(hands):
    reference = child(9, hands)
    assert template_mesh(hands).solids == (*reference.geoms,)
    assert heights_off_m(reference, template_mesh(hands)) < 1e-6


@pytest.mark.parametrize(
    ("age_months", "individual"),
    [
        (24, {"length_percentile": 50}),
        (9, {"length_percentile": 99, "weight_percentile": 1}),
        (9, {"length_percentile": 1, "weight_percentile": 99}),
    ],
)
def test_skin_follows_the_solids_of_each_child(age_months, individual, monkeypatch):
    tree, sculpted = child(age_months, individual={"sex": "female", **individual}), template_mesh("mitten")
    fitted_m = heights_off_m(tree, sculpted)
    monkeypatch.setattr("mimoc.compiler.looks.skin.ROUNDS", 0)
    assert fitted_m < 0.7 * heights_off_m(tree, sculpted)


def test_skin_of_which_no_solid_is_the_childs_is_an_error():
    other = replace(template_mesh("mitten"), solids=tuple(f"no_{name}" for name in template_mesh("mitten").solids))
    with pytest.raises(GeometryError, match="no solid that is called as one of the skin's, such as 'no_lb'"):
        layers_of(child(), other)


def test_skin_whose_vertices_lie_on_solids_without_names_is_an_error():
    arrays, head = (read_arrays(FOLDER / f"{name}.npz") for name in ("mitten", "head"))
    with pytest.raises(DataError, match="'near' refers to"):
        assembled(arrays | {"solids": arrays["solids"][:9]}, head)
    with pytest.raises(DataError, match="'solids' is no list of different names"):
        assembled(arrays | {"solids": arrays["near"]}, head)


def test_two_arrays_of_one_name_are_an_error(tmp_path):
    """NumPy reads the last of the two, without a word."""
    with zipfile.ZipFile(tmp_path / "twice.npz", "w") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # The archive itself is what is tested.
        for number in range(2):
            archive.writestr("solids.npy", encoded(np.full(3, number)))
    with pytest.raises(DataError, match=r"twice.npz: more than one array is called 'solids'"):
        read_arrays(tmp_path / "twice.npz")
    with pytest.raises(DataError, match="more than one array is called 'solids'"):
        together({"solids": np.zeros(1)}, {"verts": np.zeros(1)}, {"solids": np.zeros(1)})


def encoded(array: np.ndarray) -> bytes:
    content = io.BytesIO()
    np.save(content, array)
    return content.getvalue()


@settings(max_examples=8)
@given(tree=children())
def test_every_child_has_a_skin_that_is_near_its_solids(tree):
    """However long, stout or one-sided: each vertex is as near to them as on the reference child, and a bit."""
    average = {layer.name: layer for layer in layers(9, tree.hands)}
    for layer in skin_of(dressed(tree)).layers:
        assert np.isfinite(layer.verts_m).all()
        ratio = lengths(layer.verts_m, edges_of(layer)) / np.maximum(
            lengths(average[layer.name].verts_m, edges_of(layer)), 1e-4
        )
        assert np.quantile(ratio, 0.999) < 4


@pytest.mark.parametrize("hands", HANDS)
def test_who_misses_a_limb_has_a_closed_stump(hands):
    whole, stump = (
        layers(9, hands),
        skin_of(dressed(child(hands=hands, remove=["left_upper_arm", "right_lower_leg"]))).layers,
    )
    for one, other in zip(whole, stump, strict=True):
        assert not [bone for bone in other.bones if bone.startswith(("left_upper_arm", "left_lower_arm", "left_hand"))]
        assert len(other.faces) <= len(one.faces)
        assert np.isfinite(other.verts_m).all()
        assert np.allclose(other.weights.sum(axis=1), 1)
    body, trunk = stump[0], {bone: index for index, bone in enumerate(stump[0].bones)}
    left = body.verts_m[body.weights[:, trunk["right_upper_leg"]] > 0.5]
    assert len(left)


@pytest.mark.matrix
@pytest.mark.parametrize("hands", HANDS)
def test_mujoco_reads_what_is_written(built, hands):
    from mimoc.bundle.model import load_model

    bundle = built(body={"hands": hands})
    model = load_model(bundle)
    assert [model.skin(index).name for index in range(model.nskin)] == ["body", "shirt", "trousers", "head", "hair"]
    for layer in layers(9, hands):
        index = model.skin(layer.name).id
        first, count = model.skin_vertadr[index], model.skin_vertnum[index]
        assert np.array_equal(model.skin_vert[first : first + count], single(layer.verts_m))
        assert model.skin_facenum[index] == len(layer.faces)
        assert len(encode_skn(layer)) == len(bundle.files[layer.file])


def test_names_of_bodies_fit_into_the_file():
    assert max(len(bone) for hands in HANDS for layer in layers(9, hands) for bone in layer.bones) < NAME_BYTES


def test_skin_changes_neither_names_nor_physics(built):
    """Four hundred steps under random commands are equal to the bit."""
    from mimoc.bundle.model import load_model

    models = [load_model(built(body={"skin": skin}, scene={"pose": "sitting"})) for skin in (True, False)]
    datas = [mujoco.MjData(model) for model in models]
    for model, data in zip(models, datas, strict=True):
        mujoco.mj_resetDataKeyframe(model, data, model.key("sitting").id)
    for kind in ("body", "jnt", "geom", "site", "cam", "actuator", "sensor", "key"):
        names = [
            [model.names[address : address + 40].split(b"\0")[0] for address in getattr(model, f"name_{kind}adr")]
            for model in models
        ]
        assert names[0] == names[1]
    random = np.random.default_rng(1)
    for _ in range(400):
        command = random.uniform(-1, 1, models[0].nu)
        for model, data in zip(models, datas, strict=True):
            data.ctrl[:] = command
            mujoco.mj_step(model, data)
    assert np.array_equal(datas[0].qpos, datas[1].qpos)
    assert np.array_equal(datas[0].sensordata, datas[1].sensordata)


@pytest.mark.parametrize("hands", HANDS)
def test_skin_adds_less_than_a_megabyte_to_a_bundle(built, hands):
    with_skin, without = (built(body={"hands": hands, "skin": skin}).files for skin in (True, False))
    assert sum(map(len, with_skin.values())) - sum(map(len, without.values())) < 1_000_000
    assert json.loads(with_skin["manifest.json"])["face"]["skin"] == "head"
    assert json.loads(without["manifest.json"])["face"]["skin"] is None
