"""A page moves skins as MuJoCo does."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
from support.pages import places_of

import mimoc
from mimoc.base.geometry.meshes import STEP_M
from mimoc.bundle.model import load_model
from mimoc.bundle.variants import Variant
from mimoc.viewer.appearance import coloured_faces, describe_face, describe_skins, rows_of, skin_of
from mimoc.viewer.encoding import FINE_M, EncodedArrays, steps_of
from mimoc.viewer.growth import own_parts

SKIN = """<deformable><skin name="sleeve" vertex="{vertex}" face="0 1 2 1 3 2 2 3 4">
<bone body="left_upper_arm" bindpos="0.1 0.2 0.3" bindquat="0.8 0.6 0 0" vertid="0 1 2 3" vertweight="1 0.5 0.7 0.2"/>
<bone body="left_lower_arm" bindpos="0.1 0.2 0.2" bindquat="0.6 0.8 0 0" vertid="1 2 3 4" vertweight="0.5 0.3 0.8 1"/>
</skin></deformable>"""
VERTICES_M = np.array([[0.1, 0.2, 0.3], [0.12, 0.2, 0.26], [0.1, 0.24, 0.25], [0.13, 0.2, 0.22], [0.1, 0.22, 0.18]])


def with_skin(bundle: mimoc.Bundle) -> Variant:
    """Return an infant with a skin of five vertices on its left arm, and no other."""
    skin = SKIN.format(vertex=" ".join(map(str, VERTICES_M.ravel())))
    scene = bundle.files["scene.xml"].decode().replace("</mujoco>", skin + "</mujoco>")
    changed = mimoc.Bundle({**bundle.files, "scene.xml": scene.encode()}, bundle.manifest, None)
    return Variant(changed, load_model(changed))


def test_vertices_go_where_mujoco_moves_them(bundle_at):
    """By the formula of the page, to half a millimetre, as weights are bytes."""
    variant = with_skin(bundle_at(9))
    model, data = variant.model, mujoco.MjData(variant.model)
    packed = EncodedArrays()
    described = packed.put(describe_skins([variant, variant], [0, 24]))
    layer = described["layers"][-1]

    def array(name):
        return packed.arrays[layer[name]["array"]]

    data.qpos[7:] = np.random.default_rng(0).uniform(-0.5, 0.5, model.nq - 7)
    mujoco.mj_forward(model, data)
    scene = mujoco.MjvScene(model, 200)
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, mujoco.MjvCamera(), mujoco.mjtCatBit.mjCAT_ALL, scene)
    bodies = own_parts(model, variant.bundle.manifest).bodies[array("bones")]
    found = np.zeros_like(VERTICES_M)
    for vertex, (movers, weights) in enumerate(zip(array("moved_by"), array("weights") / 255, strict=True)):
        for bone, weight in zip(movers, weights, strict=True):
            if weight:
                found[vertex] += weight * moved(
                    model,
                    data,
                    bodies[bone],
                    array("bind_pos")[0, bone],
                    array("bind_quat")[0, bone],
                    places_of(array("verts"))[0, vertex],
                )
    assert np.abs(found - np.asarray(scene.skinvert).reshape(-1, 3)[-5:]).max() < 5e-4  # Weights are bytes.
    assert np.ptp(found, axis=0).max() > 0.05


def moved(model, data, body, bind_pos, bind_quat, vertex_m) -> np.ndarray:
    bind = np.zeros(9)
    mujoco.mju_quat2Mat(bind, bind_quat.astype(float))
    return data.xpos[body] + data.xmat[body].reshape(3, 3) @ bind.reshape(3, 3).T @ (vertex_m - bind_pos)


def test_an_infant_without_skins_has_none(bundle_at):
    bundle = bundle_at(9)
    model = load_model(bundle)
    assert model.nskin or describe_skins([Variant(bundle, model)], [9]) is None


def test_without_textures_a_skin_has_every_face_once_in_colours_near_those_of_its_picture():
    model = load_model(mimoc.build(Path(__file__).parents[2] / "configs" / "nine_months.yaml"))
    for index in range(model.nskin):
        parts = list(coloured_faces(model, index, 6))
        assert 1 <= len(parts) <= 6
        together = np.concatenate([faces for _, faces in parts])
        theirs = model.skin_face[rows_of(model, "skin_face", index)]
        assert np.array_equal(np.unique(together, axis=0), np.unique(theirs, axis=0))
        assert len(together) == len(theirs)
        assert np.allclose(skin_of(model, index).weights.sum(axis=1), 1)
    shirt = [model.skin(index).name for index in range(model.nskin)].index("shirt")
    shades = np.array([colour for colour, _ in coloured_faces(model, shirt, 6)])
    assert np.ptp(shades[:, 2]) > 40  # Yellow and white stripes.


def test_places_of_pages_are_kept_to_a_hundredth_of_a_millimetre():
    places_m = np.random.default_rng(0).uniform(-0.6, 0.6, (3, 50, 3))
    assert np.abs(places_of(steps_of(places_m)) - places_m).max() <= FINE_M / 2 + 1e-12
    with pytest.raises(OverflowError, match=r"0\.70 m away"):
        steps_of(np.full((1, 1, 3), 0.7))


def test_a_page_knows_how_expressions_move_the_head_at_each_age(bundle_at):
    variants = [Variant(bundle, load_model(bundle)) for bundle in map(bundle_at, (6, 9))]
    face = describe_face(variants, [6, 9])
    if variants[0].bundle.manifest.face.skin is None:
        assert face is None
        return
    assert (face["layer"], face["begins"]) == ("head", "neutral")
    for age, variant in enumerate(variants):
        bundle = variant.bundle
        rows = np.searchsorted(face["moving"], bundle.arrays["face/moving"])
        theirs = STEP_M * bundle.arrays["face/happy"]
        assert np.array_equal(face["moves"]["happy"].places_m[age, rows], theirs)


def test_hair_is_painted_by_age_and_all_else_as_ever():
    variants = [Variant(bundle, load_model(bundle)) for bundle in (mimoc.build(dressed(age)) for age in (9, 24))]
    shapes = {layer["name"]: layer["texcoords"].ndim for layer in describe_skins(variants, [9, 24])["layers"]}
    assert shapes == {"body": 2, "shirt": 2, "trousers": 2, "head": 2, "hair": 3}


def dressed(age_months: float) -> mimoc.InfantSpec:
    return mimoc.InfantSpec(mimoc=1, name="dressed", age_months=age_months)
