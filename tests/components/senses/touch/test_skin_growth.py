"""Skin points move with the geoms that they are on as a body grows."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.spatial import KDTree
from support.skin_bodies import SPACING_M, average, child, children, outside_all_m, outside_m, part, seen

from mimoc.anatomy.anatomy import assemble
from mimoc.base.geometry.primitives import area
from mimoc.body.grow import grow_average, grow_tree
from mimoc.body.tree import Body, Geom
from mimoc.components.senses.touch.build_skin_points import (
    MAX_STEPS,
    _moved,
    lay_out,
    move_with_geoms,
    place,
    skin_points,
)
from mimoc.fits import measure

MITTEN = assemble("mitten", False)


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
