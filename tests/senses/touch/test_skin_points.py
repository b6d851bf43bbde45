"""The skin covers all that a body shows, evenly, and grows with it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from mimoc.body import Body, BodyTree, Geom, assemble, grow, grow_child, grow_reference, measure_child
from mimoc.errors import GeometryError
from mimoc.fits import measure
from mimoc.mjcf.sensor_sites import cameras
from mimoc.schema import InfantSpec
from mimoc.schema.names import LIMB_BODIES, MEASUREMENT_KEYS, SIDED_MEASUREMENT_KEYS, TRUNK_BODIES
from mimoc.senses.touch.exposed import lay_out, move_with_geoms
from mimoc.senses.touch.skin_points import SkinPoints, skin_points
from mimoc.senses.touch.surface import area_m2, place

HANDS = ("mitten", "five_finger")
SIDES = ("left", "right")
MIRROR = np.array([1, -1, 1])
SPACING_M = {
    "head": 0.013, "hip": 0.025, "lower_body": 0.025, "upper_body": 0.030, "chest": 0.030,
    "upper_arm": 0.024, "lower_arm": 0.024, "hand": 0.007, "fingers": 0.002, "lfmetacarpal": 0.007,
    "ffdistal": 0.002, "mfdistal": 0.002, "rfdistal": 0.002, "lfdistal": 0.002, "thdistal": 0.002,
    "ffmiddle": 0.004, "mfmiddle": 0.004, "rfmiddle": 0.004, "lfmiddle": 0.004, "thhub": 0.004,
    "ffknuckle": 0.004, "mfknuckle": 0.004, "rfknuckle": 0.004, "lfknuckle": 0.004, "thbase": 0.004,
    "upper_leg": 0.027, "lower_leg": 0.038, "foot": 0.015, "toes": 0.010, "big_toe": 0.010,
}  # fmt: skip
"""Of MIMo, at 18 months (senses.md, section 4)."""


@cache
def average(age_months: float, hands: str) -> BodyTree:
    return grow(measure(age_months), assemble(hands, False))


def child(age_months: float = 9, hands: str = "mitten", **body) -> BodyTree:
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "body": {"hands": hands, **body}}
    read, anatomy = InfantSpec.model_validate(spec), assemble(hands, body.get("chest_joint", False))
    return grow_child(read, measure_child(read, anatomy), anatomy)


@st.composite
def children(draw) -> BodyTree:
    """Children of any age, with parts and measurements that a spec changes at will."""
    hands, age_months = draw(st.sampled_from(HANDS)), draw(st.floats(0, 24))
    parts = st.sampled_from((*TRUNK_BODIES, *LIMB_BODIES[hands]))
    factors = st.fixed_dictionaries({"length": st.floats(0.5, 2), "girth": st.floats(0.5, 2)})
    changes = draw(st.dictionaries(st.sampled_from((*MEASUREMENT_KEYS, *SIDED_MEASUREMENT_KEYS)), st.floats(0.8, 1.3)))
    base = measure(age_months).base
    given_cm = {key: 100 * base[_measurement(key)].value_m * factor for key, factor in changes.items()}
    try:
        return child(age_months, hands, parts=draw(st.dictionaries(parts, factors, max_size=4)), measurements=given_cm)
    except GeometryError:
        assume(False)
        raise


def _measurement(key: str) -> str:
    return key.removesuffix("_cm").removeprefix("left_").removeprefix("right_")


def part(name: str) -> str:
    return name.removeprefix("left_").removeprefix("right_")


def local_of(geom: Geom, points_m: np.ndarray) -> np.ndarray:
    return Rotation.from_euler("XYZ", geom.euler_deg, degrees=True).inv().apply(points_m - np.array(geom.pos_m))


def to_body(geom: Geom, local: np.ndarray) -> np.ndarray:
    return Rotation.from_euler("XYZ", geom.euler_deg, degrees=True).apply(local) + geom.pos_m


def nearest_m(geom: Geom, local: np.ndarray) -> np.ndarray:
    """Return the nearest points of a solid; those inside stay where they are."""
    if geom.type == "box":
        return np.clip(local, -np.array(geom.size_m), geom.size_m)
    radius_m, half_m = (*geom.size_m, 0.0)[:2]
    flat = local * (1, 1, geom.type != "cylinder")
    axis = np.clip(local * (0, 0, 1), -half_m, half_m) * (geom.type != "sphere")
    out = flat - axis * (geom.type == "capsule")
    return axis + out * np.minimum(1, radius_m / np.maximum(np.linalg.norm(out, axis=1), 1e-12))[:, None]


def outside_m(geom: Geom, points_m: np.ndarray) -> np.ndarray:
    """Return how far points are from a geom; inside it is negative."""
    local = local_of(geom, points_m)
    if geom.type == "box":
        return _beyond(np.abs(local) - geom.size_m)
    if geom.type == "cylinder":
        return _beyond(np.column_stack((np.hypot(*local[:, :2].T), np.abs(local[:, 2]))) - geom.size_m)
    half_m = geom.size_m[1] if geom.type == "capsule" else 0.0
    return np.linalg.norm(local - np.clip(local, -half_m, half_m) * (0, 0, 1), axis=1) - geom.size_m[0]


def _beyond(gaps_m: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.maximum(gaps_m, 0), axis=1) + np.minimum(gaps_m.max(axis=1), 0)


def outside_all_m(body: Body, points_m: np.ndarray) -> np.ndarray:
    return np.min([outside_m(geom, points_m) for geom in body.geoms], axis=0)


def seen(body: Body, count: int) -> np.ndarray:
    """Return that many places on each geom of a body, less those that another one covers."""
    shell = np.random.default_rng(0).uniform(-1, 1, (count, 3))
    shell /= np.abs(shell).max(axis=1, keepdims=True)
    found = []
    for geom in body.geoms:
        far_m = shell * (np.array(geom.size_m) if geom.type == "box" else sum(geom.size_m)) * 1.2
        places_m = nearest_m(geom, far_m)
        above_m = places_m + 1e-4 * (far_m - places_m)
        is_seen = outside_all_m(body, to_body(geom, above_m)) > 0
        found.append(to_body(geom, places_m[is_seen]))
    return np.concatenate(found)


def neighbours(tree: BodyTree, skin: SkinPoints, name: str) -> np.ndarray:
    """Return how far the nearest neighbour of each point of a body is, in spacings."""
    points_m = skin.points_m[name]
    return KDTree(points_m).query(points_m, k=2)[0][:, 1] / skin.spacing_m[name]


def numbers(skin: SkinPoints) -> dict[str, int]:
    return {body: len(points_m) for body, points_m in skin.points_m.items()}


# Where the points are.


@given(children(), st.sampled_from((0.1, 1.0)))
@settings(max_examples=60)
def test_every_point_is_on_its_body_and_inside_none_of_its_geoms(tree, density):
    skin = skin_points(tree, density)
    for body in tree.bodies:
        assert np.abs(outside_all_m(body, skin.points_m[body.name])).max() < 1e-9, body.name


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 9, 18, 24])
def test_points_are_about_a_spacing_apart_at_every_age(hands, age_months):
    tree = average(age_months, hands)
    skin = skin_points(tree, 1)
    for body in tree.bodies:
        if not body.name.endswith("_eye"):
            apart = neighbours(tree, skin, body.name)
            assert apart.min() > 0.4, body.name
            assert apart.max() < 1.2, body.name
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
    assert numbers(skin_points(tree, 1)) == numbers(skin_points(grow_reference(tree.hands), 1))


def test_the_spacing_at_18_months_is_that_of_mimo():
    for hands in HANDS:
        for body, spacing_m in skin_points(average(18, hands), 1).spacing_m.items():
            assert body.endswith("_eye") or spacing_m == pytest.approx(SPACING_M[part(body)]), body


@pytest.mark.parametrize(("hands", "count"), [("mitten", 5854), ("five_finger", 3588)])
def test_the_whole_skin_has_as_many_points_as_ever(hands, count):
    assert sum(numbers(skin_points(average(9, hands), 1)).values()) == count


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
    for body in TRUNK_BODIES:
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


# Growth.


@given(st.floats(0, 24))
@settings(max_examples=20)
def test_points_of_the_head_grow_with_its_radius(age_months):
    reference, tree = average(18, "mitten"), average(age_months, "mitten")
    before, after = (skin_points(each, 1) for each in (reference, tree))
    ratio = tree.geoms["head"].size_m[0] / reference.geoms["head"].size_m[0]
    centres_m = [np.array(each.geoms["head"].pos_m) for each in (reference, tree)]
    assert after.points_m["head"] - centres_m[1] == pytest.approx((before.points_m["head"] - centres_m[0]) * ratio)
    assert after.spacing_m["head"] == pytest.approx(before.spacing_m["head"] * ratio)


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


@given(children())
@settings(max_examples=20)
def test_points_stay_where_they_are_on_their_geoms_or_move_to_the_nearest_place_outside(tree):
    """Also of bodies of several geoms; the nearest of some thousand places may be a little further than the nearest."""
    skin, reference = skin_points(tree, 1), {body.name: body for body in grow_reference(tree.hands).bodies}
    for body in tree.bodies:
        if len(body.geoms) > 1 and not body.name.startswith("left_"):
            layout = lay_out(reference[body.name].geoms, SPACING_M[part(body.name)])
            carried_m = np.concatenate([place(*each) for each in zip(body.geoms, layout, strict=True)])
            moved_m = np.linalg.norm(skin.points_m[body.name] - carried_m, axis=1)
            free = outside_all_m(body, carried_m) > -1e-10
            nearest, _ = KDTree(seen(body, 3000)).query(carried_m[~free])
            assert moved_m[free].max() < 1e-11
            assert np.all(moved_m[~free] < 1.5 * nearest + 1e-4), body.name


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


@pytest.mark.parametrize(
    ("kind", "size_m", "area"),
    [
        ("box", (0.5, 0.5, 1.0), 10),
        ("sphere", (1.0,), 4 * np.pi),
        ("cylinder", (1.0, 0.5), 4 * np.pi),
        ("capsule", (1.0, 0.5), 6 * np.pi),
    ],
)
def test_the_area_of_a_geom_is_that_of_its_surface(kind, size_m, area):
    assert area_m2(replace(ball("any", 0), type=kind, size_m=size_m)) == pytest.approx(area)


def test_the_skin_that_is_given_out_cannot_be_written_to():
    with pytest.raises(ValueError, match="read-only"):
        skin_points(average(9, "mitten"), 1).points_m["head"][0] = 0
