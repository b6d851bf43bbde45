"""How the page of an infant draws in Chromium: skin as MuJoCo moves it, and no more pictures than are needed."""

import mujoco
import numpy as np
from support.browser import wait_for

from mimoc.bundle.model import load_model
from mimoc.viewer.growth import own_parts

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
