import gc

import mujoco
import numpy as np
import pytest

from mimoc.base.errors import RenderingError
from mimoc.components.senses.vision import eyes as home
from mimoc.components.senses.vision.eyes import Eyes
from mimoc.render import renderer
from mimoc.render.opengl import open_context

SCENE = """
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <asset>
    <texture name="paper" type="cube" builtin="flat" rgb1="1 0 1" width="16" height="16"/>
    <material name="paper" texture="paper"/>
  </asset>
  <worldbody>
    <camera name="level" pos="0 0 1" xyaxes="0 -1 0 0 0 1" fovy="40"/>
    <camera name="aside" pos="0 0 1" xyaxes="-1 0 0 0 0 1" fovy="40"/>
    <geom name="ball" size=".05" pos="2 0 1" rgba="1 0 0 1"/>
    <body name="nose"><geom name="near" size=".3" pos=".5 0 1" rgba="0 1 0 1"/></body>
    <geom name="wall" type="box" size=".01 2 2" pos="4 0 1" {wall}/>
  </worldbody>
</mujoco>
"""
RED = (255, 0, 0)


def posed(wall='rgba="0 0 1 1"'):
    """Return a scene and its state: a red ball straight ahead, before a wall, and a green one that hides both."""
    model = mujoco.MjModel.from_xml_string(SCENE.format(wall=wall))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


@pytest.fixture
def open_eyes():
    """Return what opens eyes that are closed after the test."""
    opened = []

    def open_some(model, cameras=("level",), width_px=64, height_px=64, unseen=("nose",)):
        opened.append(Eyes(model, cameras, width_px, height_px, unseen))
        return opened[-1]

    yield open_some
    for eyes in opened:
        eyes.close()


@pytest.fixture
def contexts(monkeypatch):
    """Return the OpenGL contexts that eyes open; `freed` counts how often each was."""
    found = []

    def noted(width, height):
        context = open_context(width, height)
        context.freed, context.size, free = 0, (width, height), context.free

        def freed():
            context.freed += 1
            free()

        context.free = freed
        found.append(context)
        return context

    monkeypatch.setattr(renderer, "open_context", noted)
    return found


def middle_of(picture, colour):
    """Return the row and column in the middle of what has a colour, or None."""
    where = np.argwhere((np.abs(picture.astype(int) - colour) < 60).all(axis=-1))
    return where.mean(axis=0) + 0.5 if len(where) else None


@pytest.mark.parametrize(("y", "z"), [(0, 1), (0.4, 1.3), (-0.5, 0.6), (0.3, 1)])
@pytest.mark.parametrize(("width_px", "height_px"), [(64, 64), (120, 60)])
def test_a_thing_is_where_a_pinhole_camera_shows_it(open_eyes, y, z, width_px, height_px):
    """Upright, left of the camera on the left, of the camera's field of view, with square pixels."""
    model, _ = posed()
    model.geom("ball").pos = 2, y, z
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    (picture,) = open_eyes(model, width_px=width_px, height_px=height_px)(data)
    focal_px = height_px / 2 / np.tan(np.radians(20))
    wanted = height_px / 2 - focal_px * (z - 1) / 2, width_px / 2 - focal_px * y / 2
    assert middle_of(picture, RED) == pytest.approx(wanted, abs=0.7)


def test_several_cameras_see_what_each_sees_alone(open_eyes):
    """Also the light that goes with a camera."""
    model, data = posed()
    model.vis.headlight.diffuse = 1
    together = open_eyes(model, ("level", "aside"))(data)
    for camera, picture in zip(("level", "aside"), together, strict=True):
        assert np.array_equal(open_eyes(model, (camera,))(data)[0], picture)


def test_bodies_that_are_not_to_be_seen_hide_nothing(open_eyes):
    """And for everyone else they are what they were."""
    model, data = posed()
    assert middle_of(open_eyes(model)(data)[0], RED) is not None
    assert not model.geom_group.any()
    assert middle_of(open_eyes(model, unseen=())(data)[0], RED) is None


def test_pictures_are_arrays_of_their_own(open_eyes):
    model, data = posed()
    eyes = open_eyes(model)
    first, second = eyes(data), eyes(data)
    assert np.array_equal(first, second)
    first[:] = 0
    assert not np.array_equal(first, second)


def test_what_changes_in_model_and_state_is_seen(open_eyes):
    model, data = posed()
    eyes = open_eyes(model)
    eyes(data)
    model.geom("ball").rgba = 1, 1, 0, 1
    assert middle_of(eyes(data)[0], (255, 255, 0)) == pytest.approx([32, 32], abs=0.5)
    data.geom("ball").xpos[1] = 0.4
    assert middle_of(eyes(data)[0], (255, 255, 0))[1] < 20


def test_the_models_own_quality_is_left_alone(open_eyes):
    model, data = posed()
    before = [str(part) for part in (model.vis.global_, model.vis.quality, model.vis.map)]
    open_eyes(model, width_px=32)(data)
    assert [str(part) for part in (model.vis.global_, model.vis.quality, model.vis.map)] == before


def test_the_buffer_is_as_large_as_the_pictures(open_eyes, contexts):
    model, _ = posed()
    eyes = open_eyes(model, ("level", "aside"), 40, 24)
    drawn_with = eyes._renderer.context
    assert contexts[0].size == (drawn_with.offWidth, drawn_with.offHeight) == (40, 48)
    assert (drawn_with.offSamples, drawn_with.shadowSize) == (0, 0)


def test_other_eyes_neither_show_in_a_picture_nor_blacken_it_when_they_close(open_eyes):
    """Their textures have the same names; each keeps its own."""
    (model, data), (grey, grey_data) = posed('material="paper"'), posed('material="paper"')
    grey.tex_data[:] = 128
    eyes, others = open_eyes(model), open_eyes(grey, ("aside", "level"), 32, 48)
    purple, seen_by_others = eyes(data), others(grey_data)
    assert (purple[0, 0] == (255, 0, 255)).all()
    assert (seen_by_others[1, 0] == 128).all()
    assert np.array_equal(eyes(data), purple)
    eyes.close()
    assert np.array_equal(others(grey_data), seen_by_others)
    assert np.array_equal(open_eyes(model)(data), purple)


def test_closing_frees_once(open_eyes, contexts):
    model, data = posed()
    eyes = open_eyes(model)
    eyes(data)
    eyes.close()
    eyes.close()
    assert [context.freed for context in contexts] == [1]


@pytest.mark.full
def test_eyes_that_nobody_has_any_more_are_freed(contexts):
    model, data = posed()
    Eyes(model, ("level",), 16, 16)(data)
    gc.collect()
    assert [context.freed for context in contexts] == [1]


def test_pictures_that_opengl_has_no_room_for_are_refused(contexts):
    model, _ = posed()
    with pytest.raises(RenderingError, match="OpenGL") as refusal:
        Eyes(model, ("level",), 100_000, 100_000)
    if contexts:  # OSMesa fails before that.
        assert "cannot draw 100000 x 100000 pixels here" in str(refusal.value)
        assert [context.freed for context in contexts] == [1]


@pytest.mark.parametrize("height_px", [16, 64, 512])
def test_coarser_limbs_hardly_change_the_picture(height_px, open_eyes, monkeypatch):
    """A ball as wide as half the picture, whose outline stays within a pixel of a round one."""
    model, data = posed()
    model.geom("ball").size = 2 * np.tan(np.radians(20)) / 2 / 1.03
    coarse = open_eyes(model, width_px=height_px, height_px=height_px)(data).astype(int)
    monkeypatch.setattr(home, "SLICES_PER_ROOT_PX", 100.0)
    model.vis.quality.numslices = model.vis.quality.numstacks = 100
    fine = open_eyes(model, width_px=height_px, height_px=height_px)(data).astype(int)
    differing = np.abs(coarse - fine).max(axis=-1) > 20
    outline_px = np.pi * height_px / 2
    assert differing.sum() < outline_px * 0.6
    assert (fine[0, height_px // 2, height_px // 2] == coarse[0, height_px // 2, height_px // 2]).all()


def test_eyes_that_turn_to_another_scene_see_what_new_ones_see(open_eyes):
    """And leave nothing behind: the context is closed as that of the first scene would be."""
    first, data = posed()
    other, other_data = posed(wall='rgba="1 1 0 1"')
    eyes = open_eyes(first)
    before = eyes(data)
    eyes.use_model(other)
    assert np.array_equal(eyes(other_data), open_eyes(other)(other_data))
    eyes.use_model(first)
    assert np.array_equal(eyes(data), before)
    eyes.close()
    eyes.close()
