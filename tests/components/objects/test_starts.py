"""An infant starts on, in and at furniture: nothing is in anything, and it rests."""

import numpy as np
import pytest
from support.full import full_but
from support.furnished import furnished, spec_with

import mimoc
from mimoc.base.errors import SpecError
from mimoc.bundle.model import load_model

SEAT = {"name": "chair", "kind": "seat"}
MAT = {"name": "mat", "kind": "mat"}
RAIL, TABLE = {"name": "rail", "kind": "rail"}, {"name": "table", "kind": "table"}
TOUCHING_M = 2e-4
"""Twice the depth in which resting bodies begin."""


@pytest.mark.parametrize("pose", ["supine", "prone", "sitting"])
@pytest.mark.parametrize("age_months", full_but([1, 12], [0, 6, 24]))
def test_an_infant_on_a_mat_stays_where_it_is(age_months, pose):
    """It sinks in; sitting, trunk and legs must be strong enough."""
    scene = furnished([MAT], age_months, pose=pose, start_at="mat")
    assert scene.deepest_m() < TOUCHING_M
    if pose != "sitting":
        assert scene.moved_m(2, "hip", "head", "left_hand", "right_foot") < 0.02


def test_an_infant_on_a_mat_lies_at_its_height():
    on_mat, on_floor = furnished([{**MAT, "thickness_cm": 7}], start_at="mat"), furnished([])
    assert on_mat.place("hip") - on_floor.place("hip") == pytest.approx(np.array([[0, 0, 0.07]]), abs=1e-9)
    assert on_mat.bundle.manifest.poses == on_floor.bundle.manifest.poses


@pytest.mark.parametrize("recline_deg", [15, 30, 60])
@pytest.mark.parametrize("age_months", full_but([0, 9], [3, 6, 18, 24]))
@pytest.mark.parametrize("hands", full_but(["mitten"], ["five_finger"]))
def test_an_infant_rests_in_a_seat_that_fits_it(age_months, recline_deg, hands):
    """The head of the youngest rolls aside, and forearms come to lie on the sides."""
    seat = {**SEAT, "recline_deg": recline_deg}
    scene = furnished([seat], age_months, pose="sitting", start_at="chair", body={"hands": hands})
    assert scene.bundle.manifest.poses == ("sitting",)
    assert scene.deepest_m() < TOUCHING_M
    touched = {scene.model.geom(geom).name for geom in scene.data.contact.geom.ravel()}
    assert {"object_chair_back", "object_chair_bottom"} <= touched
    before = scene.place("hip", "chest", "head")
    scene.run(2)
    moved_m = np.linalg.norm(scene.place("hip", "chest", "head") - before, axis=1)
    assert (moved_m < (0.005, 0.03, 0.03)).all(), moved_m


def test_children_of_other_proportions_fit_into_their_seats():
    for percentile in (1, 99):
        individual = {"sex": "female", "length_percentile": percentile, "weight_percentile": 100 - percentile}
        scene = furnished([SEAT], pose="sitting", start_at="chair", body={"individual": individual})
        assert scene.deepest_m() < TOUCHING_M
        assert scene.moved_m(2, "hip") < 0.005


def test_the_published_body_fits_into_its_seat():
    scene = furnished([SEAT], 18, pose="sitting", start_at="chair", development="published")
    assert scene.deepest_m() < TOUCHING_M
    assert scene.moved_m(2, "hip") < 0.01


@pytest.mark.parametrize("removed", [["left_lower_leg", "right_upper_arm"], ["left_upper_leg", "right_upper_leg"]])
def test_an_infant_without_some_limbs_begins_in_a_seat_too(removed):
    scene = furnished([SEAT], pose="sitting", start_at="chair", body={"remove": removed})
    assert scene.deepest_m() < TOUCHING_M
    assert scene.moved_m(0.2, "hip") < 0.01


def test_a_seat_is_as_high_as_it_says():
    scene = furnished([{**SEAT, "seat_cm": 50, "recline_deg": 25}], pose="sitting", start_at="chair")
    bottom = scene.data.geom("object_chair_bottom")
    half, turn = scene.model.geom("object_chair_bottom").size, bottom.xmat.reshape(3, 3)
    edge = bottom.xpos + turn @ (half[0], 0, half[2])
    assert edge[2] == pytest.approx(0.5)
    assert np.degrees(np.arctan2(turn[2, 0], turn[0, 0])) == pytest.approx(12.5)


def test_a_belt_holds_a_part_where_it_starts():
    scene = furnished([{**SEAT, "belt": "chest"}], 1, pose="sitting", start_at="chair")
    (weld,) = scene.bundle.manifest.constraints.welds
    assert weld.body == "chest"
    assert scene.moved_m(2, "chest") < 0.002


@pytest.mark.parametrize("age_months", [6, 12, 24])
def test_an_infant_at_a_rail_has_its_hands_around_it_and_hangs_on(age_months):
    scene = furnished([RAIL], age_months, pose="standing", start_at="rail")
    assert scene.deepest_m() < TOUCHING_M
    bar = scene.data.geom("object_rail_bar").xpos
    for side in ("left", "right"):
        hand = scene.data.geom(f"{side}_hand1").xpos
        assert np.hypot(*(hand - bar)[[0, 2]]) < 0.03
    hands = scene.place("left_hand", "right_hand")
    scene.run(2)
    assert np.linalg.norm(scene.place("left_hand", "right_hand") - hands, axis=1).max() < 0.05
    assert scene.data.body("head").xpos[2] > 0.2


def test_a_rail_that_is_only_touched_holds_nothing():
    scene = furnished([{**RAIL, "grip": False}], pose="standing", start_at="rail")
    assert not scene.bundle.manifest.constraints.welds


@pytest.mark.parametrize("top_cm", [10, 30, 45, 90])
@pytest.mark.parametrize("age_months", [9, 18])
def test_an_infant_stands_close_before_a_table_of_any_height(age_months, top_cm):
    scene = furnished([{**TABLE, "top_cm": top_cm}], age_months, pose="standing", start_at="table")
    touched = {scene.model.geom(geom).name for geom in scene.data.contact.geom.ravel()}
    assert not any(name.startswith("object_table") for name in touched)
    assert scene.deepest_m() < TOUCHING_M
    table = scene.model.geom("object_table_top")
    edge_m = scene.data.geom("object_table_top").xpos[0] - table.size[0]
    assert 0 < edge_m < 0.35


def test_an_infant_on_a_slope_stays_there():
    slope = {"name": "slope", "kind": "slope", "angle_deg": 20}
    scene = furnished([slope], start_at="slope")
    assert scene.bundle.manifest.poses == ("supine", "prone")
    assert scene.deepest_m() < TOUCHING_M
    assert scene.moved_m(2, "hip") < 0.01


def test_furniture_with_coordinates_takes_the_infant_there():
    at = {"x_cm": -50, "y_cm": 80}
    room = {"kind": "room", "room": {"size_m": [[4, 4], [4, 4], [2.5, 2.5]]}, "pose": "sitting", "start_at": "chair"}
    scene = furnished([{**SEAT, "at": at, "yaw_deg": 90}], **room)
    assert scene.data.body("hip").xpos[:2] == pytest.approx([-0.5, 0.8], abs=1e-6)
    assert scene.data.body("hip").xmat.reshape(3, 3)[:, 1] == pytest.approx([-1, 0, 0], abs=1e-6)
    assert scene.moved_m(2, "hip") < 0.005


def test_furniture_without_a_place_comes_to_the_infant():
    room = {"kind": "room", "room": {"size_m": [[4, 4], [4, 4], [2.5, 2.5]]}, "seed": 3}
    in_room = furnished([TABLE], pose="standing", start_at="table", **room)
    on_floor = furnished([TABLE], pose="standing", start_at="table")
    ahead = []
    for scene in (in_room, on_floor):
        hip, table = scene.data.body("hip"), scene.data.body("object_table")
        ahead.append(hip.xmat.reshape(3, 3).T @ (table.xpos - hip.xpos))
    assert ahead[0] == pytest.approx(ahead[1], abs=1e-6)
    assert in_room.data.body("hip").xpos[0] != pytest.approx(on_floor.data.body("hip").xpos[0], abs=0.1)


def test_a_seat_grows_with_its_infant():
    spec = spec_with([SEAT], pose="sitting", start_at="chair", senses={"proprioception": {}})
    env = mimoc.make(spec)
    env.reset(seed=0)
    env.unwrapped.grow(to=15)
    older = load_model(mimoc.build(spec.with_(age_months=15)))
    half = env.unwrapped.model.geom("object_chair_back").size
    assert half == pytest.approx(older.geom("object_chair_back").size, rel=1e-6)
    env.step(np.zeros(env.action_space.shape, np.float32))
    env.close()


BAD = [
    ([], {"start_at": "chair"}, "scene.start_at: there is no object 'chair'"),
    ([{"name": "ball"}], {"start_at": "ball"}, "scene.start_at: 'ball' is a shape; an infant starts at a mat or seat"),
    ([SEAT], {"start_at": "chair"}, "scene.pose: at a seat, an infant starts sitting; change it"),
    (
        [{**SEAT, "at": "in front of chest"}],
        {"start_at": "chair", "pose": "sitting"},
        "scene.objects[0].at: the infant starts at this; give only x_cm and y_cm in the world, or leave it out",
    ),
    (
        [{**RAIL, "bar_cm": 95}],
        {"start_at": "rail", "pose": "standing"},
        "scene.start_at: it starts with the hands at a rail; the left hand does not reach it",
    ),
    (
        [RAIL],
        {"start_at": "rail", "pose": "standing", "body": {"remove": ["left_hand"]}},
        "scene.start_at: an infant starts at a rail with both hands on it, and this one lacks one",
    ),
    (
        [{**SEAT, "belt": "left_hand"}],
        {"start_at": "chair", "pose": "sitting", "body": {"remove": ["left_hand"]}},
        "scene.start_at: this infant has no 'left_hand' to hold",
    ),
    (
        [SEAT],
        {"start_at": "chair", "pose": "sitting", "task": {"kind": "reach"}},
        "task 'reach' has a start of its own",
    ),
]


@pytest.mark.parametrize(("objects", "others", "message"), BAD, ids=[message for _, _, message in BAD])
def test_what_cannot_be_is_one_line_with_its_key(objects, others, message):
    with pytest.raises(SpecError) as caught:
        mimoc.build(spec_with(objects, **others))
    assert [message in str(problem) for problem in caught.value.problems] == [True], str(caught.value)
