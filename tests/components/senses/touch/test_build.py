"""Skin points cover all that is exposed of a body, evenly, and mirror each other."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.spatial import KDTree
from support.skin_bodies import (
    HANDS,
    MIRROR,
    SIDES,
    SPACING_M,
    average,
    child,
    children,
    neighbours,
    numbers,
    outside_all_m,
    outside_m,
    outside_parent_m,
    part,
    seen,
)

from mimoc.anatomy.anatomy import assemble
from mimoc.base.geometry.primitives import area
from mimoc.body.grow import grow_average, grow_tree
from mimoc.body.tree import Body, Geom
from mimoc.compiler.mjcf.sensor_sites import cameras
from mimoc.components.senses.touch.build import (
    MAX_STEPS,
    _moved,
    even_points,
    lay_out,
    move_with_geoms,
    place,
    skin_points,
)
from mimoc.fits import measure
from mimoc.schema.names import trunk_bodies

# Where the points are.


@pytest.mark.full
@given(children(), st.sampled_from((0.1, 1.0)))
@settings(max_examples=60)
def test_every_point_is_on_its_body_and_inside_none_of_its_geoms(tree, density):
    skin = skin_points(tree, density)
    for body in tree.bodies:
        assert np.abs(outside_all_m(body, skin.points_m[body.name])).max() < 1e-9, body.name


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 9, 18, 24])
def test_points_are_about_a_spacing_apart_at_every_age(hands, age_months):
    """A newborn's toes are so short that their round end comes out behind them, in the foot, with a single point."""
    tree = average(age_months, hands)
    skin = skin_points(tree, 1)
    for body in tree.bodies:
        if not body.name.endswith("_eye"):
            apart = neighbours(tree, skin, body.name)
            assert apart.min() > 0.4, body.name
            assert apart[outside_parent_m(tree, body, skin.points_m[body.name]) > 0].max() < 1.2, body.name
            assert 0.6 < np.median(apart) < 1.05, body.name


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_no_place_of_the_body_is_further_than_a_spacing_from_a_point(hands, age_months):
    """In squares of a spacing, the middles are .71 away."""
    tree = average(age_months, hands)
    skin = skin_points(tree, 1)
    for body in tree.bodies:
        if not body.name.endswith("_eye"):
            gaps_m, _ = KDTree(skin.points_m[body.name]).query(seen(body, 4000))
            assert gaps_m.max() / skin.spacing_m[body.name] < 1.0, body.name


@pytest.mark.parametrize("hands", HANDS)
def test_the_point_of_an_eye_is_on_its_pupil_where_its_camera_is(hands):
    for age_months in (0, 18):
        tree = average(age_months, hands)
        for name, (camera,) in cameras(tree, 60).items():
            assert skin_points(tree, 10).points_m[name] == pytest.approx(np.array([camera.pos_m]), abs=1e-12)


def test_bodies_are_in_the_order_of_the_model():
    for hands in HANDS:
        tree = average(9, hands)
        skin = skin_points(tree, 1)
        assert list(skin.points_m) == list(skin.spacing_m) == [body.name for body in tree.bodies]


# How many there are.


@given(children())
@settings(max_examples=20)
def test_every_infant_has_the_same_points(tree):
    assert numbers(skin_points(tree, 1)) == numbers(skin_points(grow_average(18, assemble(tree.hands, False)), 1))


def test_the_spacing_at_18_months_is_that_of_mimo():
    for hands in HANDS:
        for body, spacing_m in skin_points(average(18, hands), 1).spacing_m.items():
            assert body.endswith("_eye") or spacing_m == pytest.approx(SPACING_M[part(body)]), body


@pytest.mark.parametrize(("hands", "count"), [("mitten", 5964), ("five_finger", 3730)])
@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_the_whole_skin_has_as_many_points_at_every_age(hands, count, age_months):
    assert sum(numbers(skin_points(average(age_months, hands), 1)).values()) == count


@pytest.mark.parametrize("hands", HANDS)
def test_there_is_a_point_for_each_square_of_a_spacing(hands):
    """Here of single capsules and spheres, whose area is known."""
    tree = average(18, hands)
    found = numbers(skin_points(tree, 1))
    for body in tree.bodies:
        (geom, *others) = body.geoms
        if not others and not body.name.endswith("_eye"):
            radius_m, half_m = (*geom.size_m, 0.0)[:2]
            squares = 4 * np.pi * radius_m * (radius_m + half_m) / SPACING_M[part(body.name)] ** 2
            assert found[body.name] == pytest.approx(squares, rel=0.1), body.name


@pytest.mark.parametrize("density", [0.5, 2, 5, 10])
def test_density_multiplies_the_points(density):
    for hands in HANDS:
        usual, other = (sum(numbers(skin_points(average(18, hands), factor)).values()) for factor in (1, density))
        assert other / usual == pytest.approx(density, rel=0.05)


@pytest.mark.parametrize("density", [0.1, 10])
def test_no_body_is_without_points_and_none_are_crowded_whatever_the_density(density):
    tree = average(12, "five_finger")
    skin = skin_points(tree, density)
    assert min(numbers(skin).values()) > 0
    for name, count in numbers(skin).items():
        assert count == 1 or neighbours(tree, skin, name).min() > 0.3, name


def test_joints_of_the_chest_change_nothing():
    still, moving = (skin_points(child(chest_joint=joint), 1) for joint in (False, True))
    for body, points_m in still.points_m.items():
        assert np.array_equal(moving.points_m[body], points_m)


def test_absent_limbs_have_no_points_and_all_others_keep_theirs():
    whole, pruned = skin_points(child(), 1), skin_points(child(remove=["left_lower_arm", "right_eye"]), 1)
    gone = {"left_lower_arm", "left_hand", "left_fingers", "right_eye"}
    assert whole.points_m.keys() - pruned.points_m.keys() == gone
    for body, points_m in pruned.points_m.items():
        assert np.array_equal(whole.points_m[body], points_m)


# Left and right.


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 10.3, 24])
def test_left_mirrors_right_exactly(hands, age_months):
    skin = skin_points(average(age_months, hands), 1)
    for body, points_m in skin.points_m.items():
        if body.startswith("left_"):
            assert np.array_equal(points_m, skin.points_m[body.replace("left", "right")] * MIRROR)
            assert skin.spacing_m[body] == skin.spacing_m[body.replace("left", "right")]


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("density", [0.7, 1, 3])
def test_trunk_and_head_are_the_same_in_a_mirror(hands, density):
    skin = skin_points(average(4, hands), density)
    for body in trunk_bodies():
        points_m = skin.points_m[body]
        gaps_m, images = KDTree(points_m).query(points_m * MIRROR)
        assert gaps_m.max() < 1e-11
        assert sorted(images) == list(range(len(points_m)))


def test_one_side_can_differ_and_the_other_does_not_notice():
    shape = {"length": 1.3, "girth": 0.8}
    usual, left, right = (skin_points(child(parts=parts), 1) for parts in ({}, *({f"{s}_hand": shape} for s in SIDES)))
    assert np.array_equal(left.points_m["right_hand"], usual.points_m["right_hand"])
    assert np.array_equal(left.points_m["left_hand"], right.points_m["right_hand"] * MIRROR)
    assert not np.allclose(left.points_m["left_hand"], usual.points_m["left_hand"], atol=1e-3)


def test_only_parts_whose_spacing_is_given_have_points_so_far_apart():
    usual, given = skin_points(child(), 1), skin_points(child(), 1, None, {"left_hand": 0.0035, "head": 0.013})
    assert list(given.points_m) == [name for name in usual.points_m if name in ("left_hand", "head")]
    assert np.array_equal(given.points_m["head"], usual.points_m["head"])
    assert len(given.points_m["left_hand"]) == pytest.approx(4 * len(usual.points_m["left_hand"]), rel=0.1)
    assert given.spacing_m["left_hand"] == pytest.approx(0.5 * usual.spacing_m["left_hand"])


@pytest.mark.parametrize("development", ["maturing", "published"])
@given(st.floats(0, 24))
@settings(max_examples=10)
def test_points_of_the_head_grow_with_its_half_axes(development, age_months):
    """By the law `maturing`, a neck comes out of the head, whose own points these are not."""
    reference, tree = (grow_tree(measure(age), assemble("mitten", False, development)) for age in (18, age_months))
    before, after = (
        in_half_axes(each.geoms["head"], skin_points(each, 1).points_m["head"]) for each in (reference, tree)
    )
    own = np.isclose(np.linalg.norm(before, axis=1), 1)
    assert own.mean() > 0.9
    assert after[own] == pytest.approx(before[own], abs=1e-9)


def in_half_axes(head: Geom, points_m: np.ndarray) -> np.ndarray:
    """Return where points are from the middle of a ball or an ellipsoid."""
    return (points_m - np.array(head.pos_m)) / head.size_m


@given(children())
@settings(max_examples=10)
def test_the_spacing_of_a_body_grows_with_the_root_of_its_area(tree):
    skin, at_18 = skin_points(tree, 1), grow_average(18, assemble(tree.hands, False))
    usual_m2 = {body.name: area_m2(body) for body in at_18.bodies}
    for body in tree.bodies:
        if body.skin_spacing_m is not None:
            ratio = np.sqrt(area_m2(body) / usual_m2[body.name])
            assert skin.spacing_m[body.name] == pytest.approx(ratio * SPACING_M[part(body.name)]), body.name


def area_m2(body: Body) -> float:
    return sum(area(geom.type, geom.size_m) for geom in body.geoms)


def test_points_of_a_longer_arm_move_along_it():
    """Those of its round ends with the ends, those between in proportion."""
    before, after = child(), child(parts={"left_upper_arm": {"length": 1.4}})
    (short,), (long,) = (tree.geoms["left_uarm1"].size_m[1:] for tree in (before, after))
    middles = [tree.geoms["left_uarm1"].pos_m[2] for tree in (before, after)]
    old, new = (skin_points(tree, 1).points_m["left_upper_arm"] for tree in (before, after))
    heights = old[:, 2] - middles[0]
    expected = np.where(np.abs(heights) < short, heights * long / short, heights + np.sign(heights) * (long - short))
    assert np.array_equal(new[:, :2], old[:, :2])
    assert new[:, 2] - middles[1] == pytest.approx(expected, abs=1e-11)


@pytest.mark.full
@given(children())
@settings(max_examples=20)
def test_points_stay_where_they_are_on_their_geoms_or_move_to_the_nearest_place_outside(tree):
    """Also of bodies of several geoms; the nearest of some thousand places may be a little further than the nearest."""
    skin, at_18 = skin_points(tree, 1), grow_average(18, assemble(tree.hands, False))
    reference = {body.name: body for body in at_18.bodies}
    for body in tree.bodies:
        if len(body.geoms) > 1 and not body.name.startswith("left_"):
            layout = lay_out(reference[body.name].geoms, SPACING_M[part(body.name)])
            carried_m = np.concatenate([place(*each) for each in zip(body.geoms, layout, strict=True)])
            moved_m = np.linalg.norm(skin.points_m[body.name] - carried_m, axis=1)
            free = outside_all_m(body, carried_m) > -1e-10
            nearest, _ = KDTree(seen(body, 3000)).query(carried_m[~free])
            assert moved_m[free].max() < 1e-11
            assert np.all(moved_m[~free] < 1.5 * nearest + 1e-4), body.name


@given(children())
@settings(max_examples=5)
def test_points_that_are_inside_nothing_need_not_be_tried_again(tree):
    """All points, tried again and again as long as any moves, come to the same places."""
    reference = {body.name: body for body in grow_average(18, assemble(tree.hands, False)).bodies}
    for body in tree.bodies:
        if len(body.geoms) > 1 and not body.name.startswith("left_"):
            layout = lay_out(reference[body.name].geoms, SPACING_M[part(body.name)])
            plain_m = np.concatenate([place(*each) for each in zip(body.geoms, layout, strict=True)])
            for _ in range(MAX_STEPS):
                before_m, plain_m = plain_m, _moved(plain_m, body.geoms)
                if np.array_equal(plain_m, before_m):
                    break
            assert move_with_geoms(layout, body.geoms) == pytest.approx(plain_m, abs=1e-14), body.name


def ball(name: str, x_m: float) -> Geom:
    return Geom(name, "sphere", (0.03,), (x_m, 0, 0), (0, 0, 0), 1.0, (1, 0, 0), 1, 1, 3)


@pytest.mark.parametrize("overlap_m", [1e-6, 1e-5, 1e-4, 1e-3])
def test_points_between_solids_that_barely_overlap_leave_sideways(overlap_m):
    """Pushed out of the one, they are in the other, and so on."""
    angles = np.radians(np.linspace(0.01, 15, 400))
    multiples = np.column_stack((np.cos(angles), np.sin(angles), 0 * angles, 0 * angles))
    touching = (ball("one", 0), ball("other", 0.06 - overlap_m))
    points_m = move_with_geoms((multiples, multiples[:0]), touching)
    outside = np.min([outside_m(geom, points_m) for geom in touching], axis=0)
    moved_m = np.linalg.norm(points_m - 0.03 * multiples[:, :3], axis=1)
    assert np.abs(outside).max() < 1e-9
    assert 0 < moved_m.max() < 1.5 * np.sqrt(0.03 * overlap_m)


def test_the_skin_that_is_given_out_cannot_be_written_to():
    with pytest.raises(ValueError, match="read-only"):
        skin_points(average(9, "mitten"), 1).points_m["head"][0] = 0


HEAD = grow_average(18, assemble("mitten", False)).geoms["head"]
APART_M = 0.013


def test_points_on_an_ellipsoid_with_equal_half_axes_are_those_on_a_sphere():
    ball = replace(HEAD, type="sphere", size_m=(0.075,))
    round_one = replace(HEAD, size_m=(0.075, 0.075, 0.075))
    points_m, same_m = (place(geom, even_points(geom, APART_M)) for geom in (ball, round_one))
    assert points_m.shape == same_m.shape
    assert np.abs(points_m - same_m).max() < 1e-6
