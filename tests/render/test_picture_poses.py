"""Poses for pictures, and how portraits are framed in each pose, at each age."""

from contextlib import closing
from dataclasses import replace

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.base.errors import RenderingError, UnknownNameError
from mimoc.bundle.model import in_subtrees, load_model, load_posed
from mimoc.components.senses.vision.eyes import Eyes
from mimoc.render.camera import FILLED, FILLED_BY_HEAD, lowest_m
from mimoc.render.picture_poses import PICTURE_POSES, load_in_pose, poses_in_pictures, state_in_pose
from mimoc.render.portrait import Framing, lineup, portrait, portraits

AGES, HANDS = (0, 6, 24), ("mitten", "five_finger")
ALONE = Framing(transparent=True)


def infant(**keys):
    return mimoc.build(mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "infant", "age_months": 9, **keys}))


@pytest.fixture(scope="module", params=[(age, hands) for age in AGES for hands in HANDS], ids=str)
def subject(request):
    age, hands = request.param
    return infant(age_months=age, body={"hands": hands})


def test_start_poses_come_first_and_the_names_of_both_differ(bundle_at):
    names = poses_in_pictures(bundle_at(9).manifest)
    assert names == ("supine", "prone", "sitting", "standing", "crawling", "playing", "looking", "kicking")


@pytest.mark.full
def test_every_portrait_fills_its_picture_and_nothing_is_cut_off(subject):
    """What is drawn takes its share of the height or the width, and has a margin on all sides."""
    poses = poses_in_pictures(subject.manifest)
    for pose, picture in zip(poses, portraits(subject, poses, 120, 120, framing=ALONE), strict=True):
        rows, columns = (np.flatnonzero((picture[..., 3] > 128).any(axis=axis)) for axis in (1, 0))
        assert max(np.ptp(rows), np.ptp(columns)) / 120 == pytest.approx(FILLED, abs=0.06), pose
        assert min(rows[0], columns[0], 119 - rows[-1], 119 - columns[-1]) >= 8, pose


def test_a_head_alone_fills_its_picture(bundle_at):
    """Its top, and its left or its right, are a margin away from the edges."""
    for pose in ("sitting", "supine", "crawling"):
        framing = Framing(transparent=True, crop="head")
        opaque = portrait(bundle_at(9), pose, 120, 120, framing=framing)[..., 3] > 128
        top = np.flatnonzero(opaque.any(axis=1))[0]
        assert top / 120 == pytest.approx((1 - FILLED_BY_HEAD) / 2, abs=0.08), pose
        assert opaque[50:70, 50:70].mean() > 0.9, pose


def test_an_infant_without_a_head_has_none_to_draw(bundle_at):
    bundle = bundle_at(9)
    anatomy = bundle.manifest.anatomy.model_copy(update={"head": None})
    manifest = bundle.manifest.model_copy(update={"anatomy": anatomy})
    with pytest.raises(RenderingError, match="'infant' has no head to draw; leave out --crop head"):
        portrait(replace(bundle, manifest=manifest), framing=Framing(crop="head"))


@pytest.mark.parametrize("pose", PICTURE_POSES)
def test_poses_for_pictures_rest_on_the_floor(pose, subject):
    """Their lowest solid is on it, on all fours that of the arms, too, and no joint is past its limit."""
    model, data = load_in_pose(subject, pose)
    touching = (model.geom_contype > 0) & (model.geom_bodyid > 0)
    assert lowest_m(model, data, touching) == pytest.approx(0, abs=2e-3)
    if PICTURE_POSES[pose].on_hands:
        arms = in_subtrees(model, [model.body(arm.root).id for arm in subject.manifest.anatomy.arms])
        assert lowest_m(model, data, touching & arms[model.geom_bodyid]) == pytest.approx(0, abs=2e-3)
    for number in np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE):
        low, high = model.jnt_range[number]
        assert low - 1e-6 <= data.qpos[model.jnt_qposadr[number]] <= high + 1e-6, model.joint(number).name


def test_no_pose_for_pictures_is_another(bundle_at):
    bundle = bundle_at(9)
    model = load_model(bundle)
    states = [state_in_pose(bundle, model, pose).qpos for pose in poses_in_pictures(bundle.manifest)]
    assert len({state.round(3).tobytes() for state in states}) == len(states)


def test_episodes_start_in_none_of_them(bundle_at):
    model = load_model(bundle_at(9))
    assert not {model.key(number).name for number in range(model.nkey)} & set(PICTURE_POSES)


def test_a_row_takes_them_too(bundle_at):
    picture = lineup([bundle_at(0), bundle_at(9)], "crawling", 160, 80, framing=ALONE)
    assert 0.1 < (picture[..., 3] > 128).mean() < 0.7


def test_several_pictures_of_one_infant_are_those_of_one_each(bundle_at):
    poses = ["sitting", "crawling"]
    for pose, picture in zip(poses, portraits(bundle_at(9), poses, 64, 64), strict=True):
        assert np.array_equal(picture, portrait(bundle_at(9), pose, 64, 64))


def test_an_infant_that_is_held_has_the_poses_that_it_can_take():
    held = infant(scene={"pose": "sitting", "held": ["hip"]})
    assert poses_in_pictures(held.manifest) == ("sitting",)
    with pytest.raises(UnknownNameError):
        portrait(held, "crawling", 16, 16)


SIZE = {"width": 96, "height": 72}
OWN = ("head", "left_eye", "right_eye")


@pytest.fixture(scope="module")
def both(built):
    return tuple(built(body={"skin": skin}, scene={"pose": "sitting"}) for skin in (True, False))


def test_solids_under_a_skin_look_as_they_do_without(both):
    clothed, bare = both
    under, solids, skin = portrait(clothed, **SIZE, shown="solids"), portrait(bare, **SIZE), portrait(clothed, **SIZE)
    assert np.array_equal(under, solids)
    assert (np.abs(skin.astype(int) - solids).max(axis=2) > 20).mean() > 0.02


def test_infants_in_a_row_are_drawn_either_way(both):
    skins, solids = (lineup([both[0]] * 2, **SIZE, shown=shown) for shown in ("skin", "solids"))
    assert not np.array_equal(skins, solids)


EYES = ("eye_left", "eye_right")


def drawn(bundle, shown: str, cameras=EYES) -> np.ndarray:
    model, data = load_posed(bundle, "sitting")
    data.qpos[model.joint("robot:head_tilt").qposadr] = model.joint("robot:head_tilt").range[1]
    mujoco.mj_forward(model, data)
    eyes = Eyes(model, cameras, 48, 48, OWN, shown)
    try:
        return eyes(data).astype(int)
    finally:
        eyes.close()


def test_eyes_see_solids_or_skin(both):
    clothed, bare = both
    assert np.array_equal(drawn(clothed, "solids"), drawn(bare, "solids"))
    assert (np.abs(drawn(clothed, "skin") - drawn(clothed, "solids")).max(axis=-1) > 20).mean() > 0.01


def test_both_eyes_draw_from_one_scene_what_each_draws_alone(both):
    """But for rounding: MuJoCo centres a floor without end by the first of them."""
    together = drawn(both[0], "skin")
    assert not np.array_equal(*together)
    for picture, camera in zip(together, EYES, strict=True):
        assert np.abs(picture - drawn(both[0], "skin", (camera,))[0]).max() <= 2


def test_without_a_choice_infants_see_skins_alone_and_in_batches():
    """Batches and single infants see the same."""
    keys = {"mimoc": 1, "name": "infant", "age_months": 9, "scene": {"pose": "sitting"}}
    sharp = {"width_px": 48, "height_px": 48, "acuity": "off", "fovy_deg": 150}

    def seen(**vision):
        spec = mimoc.InfantSpec.model_validate({**keys, "senses": {"vision": {**sharp, **vision}}})
        with mimoc.make(spec) as env, closing(mimoc.make_vec(spec, num_envs=2, threads=1)) as envs:
            alone, of_many = env.reset(seed=0)[0]["eye_left"], envs.reset(seed=0)[0]["eye_left"][0]
        assert np.array_equal(alone, of_many)
        return alone

    assert np.array_equal(seen(), seen(body="skin"))
    assert not np.array_equal(seen(), seen(body="solids"))
