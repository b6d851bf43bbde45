"""Where objects are: in the world, by the infant that starts, and by each other."""

import copy
import pickle
from contextlib import closing

import mujoco
import numpy as np
import pytest
from support.scenes_of_objects import TOUCH_M, built_with, deepest_m, drift_m, spec_with, started

import mimoc
from mimoc.base.errors import SpecError, UnknownNameError

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


OBJECTS = (
    {"name": "ball", "radius_cm": 4, "at": "within reach of right_hand"},
    {"name": "block", "shape": "box", "motion": "fixed", "at": {"x_cm": 60, "y_cm": 0}},
    {"name": "bead", "radius_cm": 2, "above": "chest", "height_cm": 25},
    {"name": "car", "toy": "car", "motion": "sliding", "at": {"x_cm": 60, "y_cm": 30}},
    {
        "name": "mobile",
        "kind": "mobile",
        "figures": ["ball", "ball"],
        "above": "head",
        "height_cm": 45,
        "tied_to": "left_foot",
    },
)
SPEC = {
    **spec_with(*OBJECTS),
    "actuation": {"model": "torque"},
    "senses": {"proprioception": {}, "touch": {"density": 0.3}},
}
ELSEWHERE = {
    "ball": "within reach of left_hand",
    "block": {"x_cm": 40, "y_cm": 40, "yaw_deg": 45},
    "bead": {"x_cm": -60, "y_cm": 0, "z_cm": 30},
    "car": {"x_cm": 70, "y_cm": -30},
    "mobile": {"x_cm": 0, "y_cm": 20, "z_cm": 60},
}


@pytest.fixture(scope="module")
def env():
    with closing(mimoc.make(mimoc.InfantSpec.model_validate(SPEC))) as made:
        yield made


def places(env) -> dict[str, list[float]]:
    """Return where the outermost body of each object is."""
    infant = env.unwrapped
    return {item.name: infant.data.body(item.body).xpos.round(6).tolist() for item in infant.manifest.objects}


def steps(env, count: int = 3):
    actions = np.random.default_rng(0).uniform(-1, 1, (count, *env.action_space.shape)).astype(np.float32)
    return [env.step(action)[0] for action in actions]


def test_a_reset_puts_objects_elsewhere_for_one_episode(env):
    env.reset(seed=0)
    built = places(env)
    env.reset(options={"objects": ELSEWHERE})
    moved, infant = places(env), env.unwrapped
    for name in ELSEWHERE:
        assert np.linalg.norm(np.subtract(moved[name], built[name])) > 0.05, name
    np.testing.assert_allclose(moved["block"], (0.4, 0.4, 0.03), atol=1e-6)
    assert infant.data.geom("object_bead").xpos[2] == pytest.approx(0.32)
    assert deepest_m(infant.bundle, infant.model, infant.data) < TOUCH_M
    hand_m = infant.data.body("left_hand").xpos
    assert np.linalg.norm(np.subtract(moved["ball"], hand_m)) < 0.2
    env.reset()
    assert places(env) == built


def test_a_moved_mobile_is_tied_again(env):
    infant = env.unwrapped
    for options in ({}, {"objects": ELSEWHERE}):
        env.reset(options=options)
        ribbon = infant.model.tendon("object_mobile_ribbon").id
        assert infant.model.tendon_range[ribbon, 1] - infant.data.ten_length[ribbon] == pytest.approx(0.005, abs=1e-6)


def test_moved_objects_are_part_of_a_state_of_a_copy_and_of_a_pickle(env):
    env.reset(seed=1, options={"objects": ELSEWHERE})
    state, moved = env.unwrapped.get_state(), places(env)
    seen = steps(env)
    for other in (copy.deepcopy(env), pickle.loads(pickle.dumps(env)), env):
        other.reset(seed=2)
        assert places(other)["block"] != moved["block"]
        other.unwrapped.set_state(state)
        assert places(other) == moved
        for mine, theirs in zip(seen, steps(other), strict=True):
            assert all(np.array_equal(mine[name], theirs[name]) for name in mine)


def test_growing_leaves_them_where_they_are(env):
    env.reset(seed=0)
    built = places(env)
    for options in ({}, {"objects": ELSEWHERE}):
        env.reset(seed=0, options={"age_months": 6, **options})
        before = places(env)
        env.unwrapped.grow(9)
        np.testing.assert_allclose([*places(env).values()], [*before.values()], atol=2e-3)
    env.reset(options={"age_months": 9})
    assert places(env)["bead"][2] > built["bead"][2]
    env.reset(options={"age_months": 6})
    assert places(env) == built


@pytest.mark.parametrize(
    ("moves", "error", "message"),
    [
        ({"ball": {"x_cm": 0, "y_cm": 0}}, ValueError, "object 'ball' would be inside of '"),
        ({"block": {"x_cm": 60, "y_cm": 30}}, ValueError, "object 'block' would be inside of 'object_car'"),
        (
            {"bal": {"x_cm": 0, "y_cm": 0}},
            UnknownNameError,
            "'bal' is not a named object of this scene; did you mean 'ball'",
        ),
        ({"ball": "somewhere"}, ValueError, "'somewhere' is not a place; write 'within reach of NAME'"),
        (
            {"ball": "beside chest"},
            ValueError,
            "object 'ball': it cannot be moved to 'beside chest'; write 'within reach",
        ),
        ({"ball": {"x_cm": "far", "y_cm": 0}}, ValueError, "object 'ball': x_cm: "),
        ({"ball": 7}, ValueError, "object 'ball': 7 is not a place; give {'x_cm': 20"),
        ({"ball": "on car"}, ValueError, "object 'ball': there is no object 'car' with a level top to lie on"),
        ({"ball": "within reach of left_foot"}, ValueError, "object 'ball': 'left_foot' is no hand of this infant"),
        ([1, 2], ValueError, "expected a dictionary of places by the name of the object"),
    ],
)
def test_wrong_places_are_refused_and_change_nothing(env, moves, error, message):
    env.reset(seed=3)
    state, before = env.unwrapped.get_state(), places(env)
    with pytest.raises(error) as refusal:
        env.reset(options={"objects": moves})
    assert message in str(refusal.value)
    assert places(env) == before
    np.testing.assert_array_equal(env.unwrapped.get_state()["physics"], state["physics"])


def test_without_objects_there_is_no_such_option():
    with closing(mimoc.make(mimoc.InfantSpec.model_validate(spec_with()))) as env:
        with pytest.raises(UnknownNameError, match="'objects' is not a reset option"):
            env.reset(options={"objects": {}})
        assert not any(field.size == 0 for field in env.unwrapped.get_state()["model"][1:])


def test_each_infant_of_a_batch_has_its_own_places_and_is_as_a_single_one():
    spec = mimoc.InfantSpec.model_validate(SPEC)
    moves = [ELSEWHERE, {"ball": {"x_cm": 60, "y_cm": 60}}]
    actions = np.random.default_rng(1).uniform(-1, 1, (4, 2, *mimoc.make(spec).action_space.shape)).astype(np.float32)
    with closing(mimoc.make_vec(spec, num_envs=2)) as batch:
        seen = [batch.reset(seed=5, options={"objects": moves})[0], *(batch.step(action)[0] for action in actions)]
    for index, move in enumerate(moves):
        with closing(mimoc.make(spec)) as env:
            single = [env.reset(seed=5 + index, options={"objects": move})[0]]
            single += [env.step(action[index])[0] for action in actions]
        for ours, theirs in zip(seen, single, strict=True):
            assert all(np.array_equal(ours[name][index], theirs[name]) for name in theirs)
