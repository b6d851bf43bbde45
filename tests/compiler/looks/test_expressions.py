"""Expressions move the skin of a face: what moves, how far, and that nothing else does."""

from contextlib import closing
from functools import cache

import mujoco
import numpy as np
import pytest
from support.skin_bodies import child

import mimoc
from mimoc.base.errors import SpecError
from mimoc.base.geometry.meshes import STEP_M
from mimoc.bundle.variants import MOVING, array_of
from mimoc.compiler.looks.head import deform_head
from mimoc.compiler.looks.sculpture import template_mesh
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema.body import ADULT_EXPRESSIONS, EXPRESSIONS

AGES_MONTHS = (0, 3, 6, 12, 24)
MOVED = EXPRESSIONS[1:]


@cache
def face(age_months: float, expression: str) -> np.ndarray:
    """Return the vertices of a head in half axes of its solid, in the frame of that."""
    tree = child(age_months)
    head = tree.geoms["head"]
    return (deform_head(template_mesh("mitten").head, tree, expression) - head.pos_m) / np.array(head.size_m)


def lip_edges(age_months: float) -> np.ndarray:
    """Return the vertices of the edges of the lips: where two are in one place, in the middle of the lower face."""
    verts = face(age_months, "neutral")
    inside = (verts[:, 0] > 0.8) & (np.abs(verts[:, 1]) < 0.26) & (verts[:, 2] < -0.45) & (verts[:, 2] > -0.75)
    near = np.flatnonzero(inside)
    far = np.linalg.norm(verts[near, None] - verts[None, near], axis=2) + 2 * np.eye(len(near))
    return near[far.min(axis=1) < 1e-6]


def corner_rise(age_months: float, expression: str) -> float:
    """Return how much an expression raises the corners of the mouth above its middle."""
    neutral, edges = face(age_months, "neutral"), lip_edges(age_months)
    aside = np.abs(neutral[edges, 1])
    moved = face(age_months, expression)[edges, 2] - neutral[edges, 2]
    return float(moved[aside > 0.9 * aside.max()].mean())


def mouth_opening(age_months: float, expression: str) -> float:
    edges = lip_edges(age_months)
    middle = edges[np.abs(face(age_months, "neutral")[edges, 1]) < 0.04]
    return float(np.ptp(face(age_months, expression)[middle, 2]))


def lids_apart(age_months: float, expression: str, side: float) -> float:
    """Return how far the lids of an eye are apart in its middle, by the radius of the eyeball; 0 if they are closed."""
    reference, tree = template_mesh("mitten").head, child(age_months)
    neutral = reference.at_ages_m[2]
    middle = reference.eye_m * (1, side, 1)
    from_eye = neutral - middle
    near = np.linalg.norm(from_eye, axis=1) < 1.14 * reference.eye_radius_m
    rim = near & (np.abs(from_eye[:, 1]) < 0.0025) & (from_eye[:, 0] > 0)
    verts = deform_head(reference, tree, expression)[rim, 2]
    upper = from_eye[rim, 2] > 0
    return max(0.0, float(verts[upper].min() - verts[~upper].max())) / tree.geoms["left_eye1"].size_m[0]


@pytest.mark.parametrize("age_months", AGES_MONTHS)
def test_corners_of_the_mouth_go_up_when_happy_and_down_when_sad(age_months):
    assert corner_rise(age_months, "happy") > 0.03
    assert corner_rise(age_months, "sad") < -0.03


@pytest.mark.parametrize("age_months", AGES_MONTHS)
def test_mouths_open_for_crying_surprise_and_a_smile(age_months):
    assert mouth_opening(age_months, "neutral") < 0.015
    assert mouth_opening(age_months, "crying") > 0.14
    assert mouth_opening(age_months, "surprised") > 0.12
    assert 0.05 < mouth_opening(age_months, "happy") < mouth_opening(age_months, "crying")


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("age_months", AGES_MONTHS)
def test_lids_are_half_closed_when_sleepy_closed_when_crying_and_wide_when_surprised(age_months, side):
    usual = lids_apart(age_months, "neutral", side)
    assert lids_apart(age_months, "crying", side) == 0
    assert lids_apart(age_months, "sleepy", side) < 0.75 * usual
    assert lids_apart(age_months, "happy", side) < usual < lids_apart(age_months, "surprised", side)


def test_cheeks_rise_with_a_smile_and_brows_with_surprise_and_sink_with_anger():
    neutral = face(6, "neutral")
    cheek = np.linalg.norm(neutral - (0.85, 0.48, -0.38), axis=1).argmin()
    brow = np.linalg.norm(neutral - (0.95, 0.2, 0.13), axis=1).argmin()
    assert face(6, "happy")[cheek, 2] > neutral[cheek, 2] + 0.01
    assert face(6, "surprised")[brow, 2] > neutral[brow, 2] + 0.02
    assert face(6, "angry")[brow, 2] < neutral[brow, 2] - 0.02


def test_the_back_of_the_head_never_moves():
    neutral = face(9, "neutral")
    behind = neutral[:, 0] < 0
    assert all(np.array_equal(face(9, name)[behind], neutral[behind]) for name in MOVED)


def spec(**keys) -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "infant", "age_months": 9, **keys})


def head_verts(model: mujoco.MjModel) -> np.ndarray:
    head = model.skin("head").id
    first = model.skin_vertadr[head]
    return model.skin_vert[first : first + model.skin_vertnum[head]].copy()


def test_arrays_of_a_face_are_small_and_say_what_moves():
    bundle = mimoc.build(spec())
    moving = bundle.arrays[MOVING]
    steps = [bundle.arrays[array_of(name)] for name in MOVED]
    assert all(array.shape == (len(moving), 3) and array.dtype == np.int16 for array in steps)
    assert sum(array.nbytes for array in (*steps, moving)) < 70_000
    assert max(np.abs(array).max() for array in steps) * STEP_M < 0.02


def test_setting_an_expression_moves_the_skin_and_setting_it_back_undoes_it():
    with mimoc.make(spec()) as env:
        env.reset(seed=0)
        infant = env.unwrapped
        built = head_verts(infant.model)
        for name in MOVED:
            infant.set_expression(name)
            assert np.abs(head_verts(infant.model) - built).max() > 0.001
        infant.set_expression("neutral")
        assert np.array_equal(head_verts(infant.model), built)


@pytest.mark.parametrize("begin", ["happy", "crying"])
def test_the_expression_of_the_spec_is_that_which_is_set_later(begin):
    with mimoc.make(spec(body={"expression": begin})) as built, mimoc.make(spec()) as env:
        built.reset(seed=0), env.reset(seed=0)
        env.unwrapped.set_expression(begin)
        assert np.array_equal(head_verts(built.unwrapped.model), head_verts(env.unwrapped.model))
        built.unwrapped.set_expression("neutral"), env.unwrapped.set_expression("neutral")
        assert np.array_equal(head_verts(built.unwrapped.model), head_verts(env.unwrapped.model))


def test_a_state_holds_the_expression():
    with mimoc.make(spec()) as env:
        env.reset(seed=0)
        infant = env.unwrapped
        infant.set_expression("happy")
        state, happy = infant.get_state(), head_verts(infant.model)
        infant.set_expression("sad")
        infant.set_state(state)
        assert np.array_equal(head_verts(infant.model), happy)


def test_an_infant_that_grows_keeps_its_expression():
    with mimoc.make(spec()) as env, mimoc.make(spec(age_months=12, body={"expression": "crying"})) as older:
        env.reset(seed=0), older.reset(seed=0)
        env.unwrapped.set_expression("crying")
        env.unwrapped.grow(to=12)
        assert np.array_equal(head_verts(env.unwrapped.model), head_verts(older.unwrapped.model))


def test_expressions_leave_physics_untouched():
    with mimoc.make(spec()) as still, mimoc.make(spec()) as moody:
        still.reset(seed=0), moody.reset(seed=0)
        command = still.action_space.high
        for name in EXPRESSIONS:
            moody.unwrapped.set_expression(name)
            still.step(command), moody.step(command)
        assert np.array_equal(still.unwrapped.data.qpos, moody.unwrapped.data.qpos)


def test_infants_that_share_a_world_have_faces_of_their_own():
    world = mimoc.build_world(
        {"anna": spec(name="anna", body={"skin": True}), "ben": spec(name="ben", body={"skin": True})}
    )
    with closing(WorldEnv(world)) as shared:
        shared.reset(seed=0)
        anna, ben = shared.infants["anna"], shared.infants["ben"]
        model = anna.model
        slices = {}
        for name in ("anna", "ben"):
            head = model.skin(f"{name}_head").id
            slices[name] = slice(model.skin_vertadr[head], model.skin_vertadr[head] + model.skin_vertnum[head])
        before = model.skin_vert.copy()
        anna.set_expression("happy")
        assert np.abs(model.skin_vert[slices["anna"]] - before[slices["anna"]]).max() > 0.001
        assert np.array_equal(model.skin_vert[slices["ben"]], before[slices["ben"]])
        assert ben.manifest.face.shapes == MOVED


def test_solids_have_nine_faces_and_no_arrays():
    bundle = mimoc.build(spec(body={"skin": False, "expression": "sleepy"}))
    assert not bundle.manifest.face.shapes
    assert not any(name.startswith("face/") for name in bundle.arrays)
    with mimoc.make(bundle) as env:
        env.reset(seed=0)
        env.unwrapped.set_expression("crying")


def test_an_adult_cries_not_and_is_not_sleepy():
    assert set(EXPRESSIONS) - set(ADULT_EXPRESSIONS) == {"sleepy", "crying"}
    with pytest.raises(SpecError, match="expression"):
        mimoc.build(spec(scene={"caregiver": {"expression": "crying"}}))
