"""Skin points cover all that is exposed of a body, evenly, and mirror each other."""

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
    outside_parent_m,
    part,
    seen,
)

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_average
from mimoc.compiler.mjcf.sensor_sites import cameras
from mimoc.components.senses.touch.build_skin_points import skin_points
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
