"""How the page of an infant draws in Chromium: skin as MuJoCo moves it, and no more pictures than are needed."""

import mujoco
import numpy as np
from support.pages import wait_for

import mimoc
from mimoc.bundle.model import load_model
from mimoc.viewer.appearance import rows_of
from mimoc.viewer.growth import own_parts

HEAD = "[...mimoc.infant.skin.layers.find(({ layer }) => layer.name === 'head').bound.attributes.position.array]"
AT_REST = "mimoc.stage.renderer.getPixelRatio() === mimoc.stage.sharpness.resting && !mimoc.stage.waiting"


def test_its_skin_is_where_mujoco_has_it(shown, infant):
    """To two millimetres at the age of the spec, as vertices follow four bodies with weights of one byte."""
    model = load_model(infant)
    data, scene = mujoco.MjData(model), mujoco.MjvScene(model, 1000)
    own = own_parts(model, infant.manifest)
    low, high = model.jnt_range[own.joints].T
    data.qpos[own.qpos] = np.concatenate([[0.1, 0.2, 0.5, 0.6, 0.0, 0.8, 0.0], low + 0.4 * (high - low)])
    mujoco.mj_forward(model, data)
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, mujoco.MjvCamera(), mujoco.mjtCatBit.mjCAT_ALL, scene)
    shown.evaluate("mimoc.enter('pose'); mimoc.setAge(9)")
    shown.evaluate("(state) => mimoc.show(Float32Array.from(state))", data.qpos[own.qpos].tolist())
    for name, array in (("position", scene.skinvert), ("normal", scene.skinnormal)):
        found = shown.evaluate(
            "(name) => mimoc.infant.skin.layers.flatMap(({ mesh }) => [...mesh.geometry.attributes[name].array])", name
        )
        theirs, ours = np.asarray(array).reshape(-1, 3), np.reshape(found, (-1, 3))
        if name == "position":
            assert np.abs(ours - theirs).max() < 2e-3
        else:
            ours /= np.linalg.norm(ours, axis=1, keepdims=True)
            assert np.median((ours * theirs).sum(axis=1)) > 0.99


def test_nothing_is_drawn_while_nothing_moves(shown):
    shown.evaluate("mimoc.enter('pose'); mimoc.stage.draw()")
    wait_for(shown, AT_REST)
    before = shown.evaluate("mimoc.stage.frames")
    shown.evaluate("new Promise((next) => setTimeout(next, 500))")
    assert shown.evaluate("mimoc.stage.frames") == before


def test_pictures_are_coarser_while_they_come_slowly_and_sharp_at_rest(shown):
    coarse = shown.evaluate(
        """() => {
            for (let i = 0; i < 10; i += 1) mimoc.stage.sharpness.tell(200);
            return mimoc.stage.sharpness.moving;
        }"""
    )
    assert coarse == 0.5
    shown.evaluate("mimoc.stage.turn(0.1, 0)")
    wait_for(shown, "mimoc.stage.renderer.getPixelRatio() === 0.5")
    wait_for(shown, AT_REST)
    finer = shown.evaluate(
        """() => {
            for (let i = 0; i < 100; i += 1) mimoc.stage.sharpness.tell(5);
            return mimoc.stage.sharpness.moving;
        }"""
    )
    assert finer == 1


def test_a_face_goes_to_an_expression_in_a_moment_as_mujoco_has_it_then(shown, infant):
    """To a tenth of a millimetre, and back again."""
    env = mimoc.InfantEnv(infant)
    env.set_expression("crying")
    theirs = np.array(env.model.skin_vert[rows_of(env.model, "skin_vert", env.model.skin("head").id)])
    env.close()
    shown.evaluate("mimoc.enter('pose'); mimoc.setAge(9); mimoc.setExpression('neutral')")
    wait_for(shown, "!mimoc.expressing")
    before = np.reshape(shown.evaluate(HEAD), (-1, 3))
    assert np.abs(before - theirs).max() > 3e-3
    shown.evaluate("mimoc.setExpression('crying')")
    assert shown.evaluate("mimoc.infant.expressing.shares.size") == 2, "it is on its way"
    wait_for(shown, "!mimoc.expressing")
    assert np.abs(np.reshape(shown.evaluate(HEAD), (-1, 3)) - theirs).max() < 1e-4
    shown.evaluate("mimoc.setExpression('neutral')")
    wait_for(shown, "!mimoc.expressing")
    assert np.abs(np.reshape(shown.evaluate(HEAD), (-1, 3)) - before).max() < 1e-6


def test_vertices_at_one_place_have_one_normal(shown):
    """No seam shows where layers of the skin meet, or a layer its own other side."""
    shown.evaluate("mimoc.enter('pose'); mimoc.setAge(9)")
    turned = shown.evaluate(
        """() => {
            const { seams, layers } = mimoc.infant.skin;
            const all = layers.map(({ bound }) => bound.attributes.normal.array);
            const normal = ([layer, vertex]) => [...all[layer].slice(3 * vertex, 3 * vertex + 3)];
            return seams.map((there) => there.map(normal));
        }"""
    )
    assert len(turned) > 50
    for normals in turned:
        alike = [row for row in normals if np.dot(row, normals[0]) > 0]
        assert np.ptp(alike, axis=0).max() < 1e-5


def test_parts_of_the_body_darken_each_other_and_the_floor(shown):
    """Armpits get less of the sky than the crown of the head, and the floor less below the infant than beside it."""
    shown.evaluate("mimoc.enter('pose'); mimoc.setAge(9); mimoc.setPose('sitting')")
    light = np.reshape(
        shown.evaluate("mimoc.infant.skin.layers.map(({ mesh }) => [...mesh.geometry.attributes.color.array])")[0],
        (-1, 3),
    )
    assert light.max() > 0.97
    assert light.min() < 0.7
    floor = np.reshape(shown.evaluate("[...mimoc.stage.light.floor.hidden]"), (96, 96, 4))[..., 1]
    assert floor[40:56, 40:56].max() > 80
    assert floor[0].max() == 0
