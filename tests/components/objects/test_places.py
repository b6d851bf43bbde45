"""Where objects are: in the world, by the infant that starts, and by each other."""

import mujoco
import numpy as np
import pytest
from support.scenes_of_objects import TOUCH_M, built_with, deepest_m, drift_m, spec_with, started

import mimoc
from mimoc.base.errors import SpecError

BALL = {"name": "ball", "radius_cm": 3}


def place_of(bundle, name="ball"):
    _model, data = started(bundle)
    return data.body(f"object_{name}").xpos


def test_coordinates_are_those_of_the_world_and_it_rests_on_the_floor():
    np.testing.assert_allclose(place_of(built_with({**BALL, "at": {"x_cm": 50, "y_cm": -20}})), (0.5, -0.2, 0.03))


def test_a_height_is_that_of_the_lowest_point():
    fixed = {**BALL, "motion": "fixed", "at": {"x_cm": 50, "y_cm": -20, "z_cm": 40}}
    np.testing.assert_allclose(place_of(built_with(fixed)), (0.5, -0.2, 0.43))


def test_above_is_above_the_highest_point_of_the_part_in_the_pose_of_the_start():
    for pose in ("supine", "sitting"):
        bundle = built_with({**BALL, "motion": "fixed", "above": "chest", "height_cm": 25}, pose=pose)
        model, data = started(bundle)
        chest = [geom for geom in range(model.ngeom) if model.body(model.geom_bodyid[geom]).name == "chest"]
        aabb = [model.geom_aabb[geom] for geom in chest]
        tops = [
            data.geom_xpos[geom][2] + np.abs(data.geom_xmat[geom].reshape(3, 3)[2]) @ box[3:]
            for geom, box in zip(chest, aabb, strict=True)
        ]
        lowest_m = data.body("object_ball").xpos[2] - 0.03
        assert lowest_m - max(tops) == pytest.approx(0.25, abs=0.012), pose  # Boxes around what is tilted are higher.
        assert np.linalg.norm(data.body("object_ball").xpos[:2] - data.body("chest").xpos[:2]) < 0.06


@pytest.mark.parametrize("pose", ["supine", "prone", "sitting"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_within_reach_is_near_the_hand_and_free(pose, side):
    bundle = built_with({**BALL, "at": f"within reach of {side}_hand"}, pose=pose)
    model, data = started(bundle)
    ball_m, hand_m = data.body("object_ball").xpos, data.body(f"{side}_hand").xpos
    other_m = data.body(f"{'left' if side == 'right' else 'right'}_hand").xpos
    assert np.linalg.norm(ball_m[:2] - hand_m[:2]) < 0.2
    assert np.linalg.norm(ball_m - hand_m) < np.linalg.norm(ball_m - other_m)
    assert ball_m[2] == pytest.approx(0.03)
    assert deepest_m(bundle, model, data) < TOUCH_M


def test_what_hangs_within_reach_is_as_far_from_the_shoulder_as_the_arm_reaches():
    bundle = built_with({**BALL, "motion": "hanging", "at": "within reach of right_hand"})
    _model, data = started(bundle)
    ball_m = data.geom("object_ball").xpos
    distance_m = np.linalg.norm(ball_m - data.body("right_upper_arm").xpos)
    along_m = np.linalg.norm(data.body("right_lower_arm").xpos - data.body("right_upper_arm").xpos)
    assert along_m < distance_m < 2.5 * along_m


def test_in_front_and_beside_are_where_words_say():
    bundle = built_with(
        {**BALL, "at": "in front of infant"},
        {**BALL, "name": "left", "at": "beside left_hand"},
        {**BALL, "name": "right", "at": "beside right_foot", "distance_cm": 20},
        pose="sitting",
    )
    _model, data = started(bundle)
    assert data.body("object_ball").xpos[0] > 0.1
    assert abs(data.body("object_ball").xpos[1]) < 1e-6
    assert data.body("object_left").xpos[1] > data.body("left_hand").xpos[1] + 0.05
    foot_m = data.body("right_foot").xpos[1]
    assert data.body("object_right").xpos[1] < foot_m - 0.2


def test_words_follow_the_infant_into_a_room():
    """A room puts the infant somewhere, turned about the vertical."""
    places = []
    for seed in range(3):
        bundle = built_with({**BALL, "at": "beside left_hand"}, kind="room", seed=seed)
        model, data = started(bundle)
        hip = data.body("hip")
        places.append(hip.xmat.reshape(3, 3)[:, 1] @ (data.body("object_ball").xpos - hip.xpos))
        assert deepest_m(bundle, model, data) < TOUCH_M
    assert min(places) > 0.1


def test_the_frame_of_the_infant_is_that_of_its_start():
    here = {**BALL, "at": {"x_cm": 40, "y_cm": 30, "frame": "infant"}}
    flat, room = built_with(here), built_with(here, kind="room", seed=1)
    local = []
    for bundle in (flat, room):
        _model, data = started(bundle)
        hip, ball_m = data.body("hip"), data.body("object_ball").xpos
        left = hip.xmat.reshape(3, 3)[:, 1]
        offset_m = ball_m - hip.xpos
        local.append((np.linalg.norm(offset_m[:2]), left @ offset_m))
    np.testing.assert_allclose(local[0], local[1], atol=2e-3)


def test_one_object_lies_on_another_and_stays_there():
    bundle = built_with(
        {"name": "block", "shape": "box", "sides_cm": [10, 10, 5], "at": {"x_cm": 60, "y_cm": 0}},
        {"name": "cup", "toy": "cup", "at": "on block"},
        {"name": "drop", "radius_cm": 1, "at": {"x_cm": 64.3, "y_cm": 4.3}},
    )
    model, data = started(bundle)
    assert data.body("object_drop").xpos[2] == pytest.approx(0.06)
    for _ in range(600):
        mujoco.mj_step(model, data)
    assert data.body("object_cup").xpos[2] > 0.07
    assert drift_m(bundle, model, data) < 1e-3


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({}, "[0].name: it has no place; add 'at' or 'above'"),
        ({"at": {"x_cm": 0, "y_cm": 0}}, "[0].at: it would start inside of '"),
        ({"at": "on shelf"}, "[0].at: there is no object 'shelf' before this one that it could be on"),
        ({"at": "in front of chest"}, "[0].at: what is in front of chest is above it as it starts; hang it or fix it"),
        ({"at": "within reach of right_foot"}, "[0].at: 'right_foot' is no hand of this infant"),
        ({"above": "belly"}, "[0].above: 'belly' is no part of this infant and no object before this one"),
        ({"at": {"x_cm": 50, "y_cm": 0}, "name": "chest"}, "[0].name: 'chest' is a part of the infant"),
    ],
)
def test_what_cannot_be_there_gets_one_clear_error(keys, message):
    with pytest.raises(SpecError) as refusal:
        mimoc.build(mimoc.InfantSpec.model_validate(spec_with({**BALL, **keys})))
    assert f"scene.objects{message}" in str(refusal.value)
    assert len(refusal.value.problems) == 1


def test_what_lies_needs_something_to_lie_on():
    with pytest.raises(SpecError, match="no floor that it could lie on; fix it or hang it, or give its height z_cm"):
        mimoc.build(mimoc.InfantSpec.model_validate(spec_with({**BALL, "at": {"x_cm": 50}}, kind="empty")))
    floating = built_with({**BALL, "motion": "hanging", "above": "chest"}, kind="empty")
    assert place_of(floating)[2] > 0.2


def test_objects_outside_of_a_room_are_refused():
    with pytest.raises(SpecError, match="it is outside of the floor"):
        mimoc.build(mimoc.InfantSpec.model_validate(spec_with({**BALL, "at": {"x_cm": 500}}, kind="room")))


def test_poses_in_which_an_object_would_be_inside_of_the_infant_are_left_out():
    """A ball between the legs of a sitting infant is inside of one that lies on its face."""
    assert "prone" in built_with().manifest.poses
    bundle = built_with({**BALL, "at": "in front of infant"}, pose="sitting")
    assert "sitting" in bundle.manifest.poses
    assert "prone" not in bundle.manifest.poses
    model, _ = started(bundle)
    assert [model.key(index).name for index in range(model.nkey)] == list(bundle.manifest.poses)
    for pose in bundle.manifest.poses:
        assert deepest_m(bundle, *started(bundle, pose)) < TOUCH_M


def test_toys_keep_clear_of_objects():
    bundle = built_with(
        {"name": "mat", "shape": "box", "sides_cm": [60, 60, 4], "at": {"x_cm": 70}}, toys={"count": [9, 9]}
    )
    _model, data = started(bundle)
    for toy in bundle.manifest.toys:
        assert np.abs(data.body(toy.body).xpos[:2] - (0.7, 0)).max() > 0.3
