import math
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import ndimage

from mimoc.bundle.model import load_model, load_posed
from mimoc.render.camera import (
    CLEARANCE_M,
    FROM_THE_FRONT,
    FROM_THE_SIDE,
    WIDEST_DEG,
    Planes,
    Shot,
    Spheres,
    camera_axes,
    fit_shot,
    planes_of,
    shows,
    unobstructed_view,
    view_of_body,
)
from mimoc.render.picture_files import COLOUR, bar_length_cm
from mimoc.render.portrait import GAP_M, Framing, lineup, portrait, row_of

OUTDOORS = Planes(np.empty((0, 3)), np.empty((0, 3)))
coordinates = st.floats(-2, 2)
spheres = st.lists(st.tuples(coordinates, coordinates, coordinates, st.floats(0.01, 0.5)), min_size=1, max_size=12).map(
    lambda rows: Spheres(np.array(rows)[:, :3], np.array(rows)[:, 3])
)
views = st.tuples(st.floats(-360, 360), st.floats(-85, 85))
aspects = st.floats(0.3, 3)


def box_room(size_m) -> Planes:
    depth, width, height = size_m
    points = [(0, 0, 0), (0, 0, height), (depth / 2, 0, 0), (-depth / 2, 0, 0), (0, width / 2, 0), (0, -width / 2, 0)]
    normals = [(0, 0, 1), (0, 0, -1), (-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0)]
    return Planes(np.array(points, float), np.array(normals, float))


@given(spheres=spheres, view=views, aspect=aspects, fovy_deg=st.floats(2, WIDEST_DEG))
def test_a_shot_shows_all_of_what_it_is_to_show(spheres, view, aspect, fovy_deg):
    assert shows(fit_shot(spheres, OUTDOORS, view, aspect, fovy_deg), spheres, aspect)


@given(spheres=spheres, view=views, aspect=aspects, fovy_deg=st.floats(2, WIDEST_DEG))
def test_a_shot_is_no_further_away_than_it_must_be(spheres, view, aspect, fovy_deg):
    """A little nearer, and something is cut off."""
    shot = fit_shot(spheres, OUTDOORS, view, aspect, fovy_deg, margin=1)
    nearer = Shot(shot.position_m + 0.001 * camera_axes(view)[0], shot.depth_m, view, fovy_deg)
    assert not shows(nearer, spheres, aspect)


@given(
    size_m=st.tuples(st.floats(2.5, 5), st.floats(2.5, 5), st.floats(2.2, 3)),
    place=st.tuples(st.floats(-1, 1), st.floats(-1, 1)),
    azimuth=st.floats(-180, 180),
    aspect=st.floats(0.75, 1.8),
)
def test_an_infant_anywhere_in_a_room_is_seen_from_within_it(size_m, place, azimuth, aspect):
    """Half a metre of infant, 40 cm from the walls or more."""
    middle = np.array([*(share * (side / 2 - 0.75) for share, side in zip(place, size_m, strict=False)), 0.3])
    infant, walls = Spheres(middle[None] + [[0, 0, 0], [0.2, 0, -0.1]], np.array([0.25, 0.15])), box_room(size_m)
    shot = fit_shot(infant, walls, unobstructed_view(infant, walls, (azimuth, -12.0), aspect), aspect)
    assert walls.clearance_m(shot.position_m) >= CLEARANCE_M
    assert shows(shot, infant, aspect)


def test_where_a_wall_is_near_the_field_of_view_gets_wider_and_no_more_than_it_must():
    infant = Spheres(np.array([[0.0, 0.0, 0.3]]), np.array([0.3]))
    outside, inside = (fit_shot(infant, walls, FROM_THE_FRONT, 4 / 3) for walls in (OUTDOORS, box_room((3, 3, 2.5))))
    assert outside.fovy_deg < inside.fovy_deg < WIDEST_DEG
    assert box_room((3, 3, 2.5)).clearance_m(outside.position_m) < 0
    assert box_room((3, 3, 2.5)).clearance_m(inside.position_m) == pytest.approx(CLEARANCE_M, abs=0.01)


def test_where_there_is_space_the_view_stays_as_it_is():
    infant = Spheres(np.array([[0.0, 0.0, 0.3]]), np.array([0.3]))
    assert unobstructed_view(infant, box_room((20, 20, 5)), FROM_THE_SIDE, 4 / 3) == FROM_THE_SIDE


@pytest.mark.parametrize(
    ("place", "before_m"), [((0, 0, 1), 1), ((1.9, 0, 1), 0.1), ((2.5, 0, 1), -0.5), ((0, 0, -0.3), -0.3)]
)
def test_a_place_is_as_far_before_walls_as_before_the_nearest(place, before_m):
    """Of a floor and a wall that looks backwards, two metres ahead."""
    planes = '<geom type="plane" size="2 2 1"/><geom type="plane" size="2 2 1" pos="2 0 0" euler="0 -90 0"/>'
    model = mujoco.MjModel.from_xml_string(f'<mujoco><worldbody>{planes}<geom size=".1"/></worldbody></mujoco>')
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert planes_of(model, data).clearance_m(np.array(place)) == pytest.approx(before_m)


def body_turned(axis: str, degrees: float) -> mujoco.MjData:
    euler = {"y": f"0 {degrees} 0", "z": f"0 0 {degrees}"}[axis]
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><body name="hip" euler="{euler}"><geom size=".1"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data


def test_a_view_turns_with_an_infant_and_is_from_above_if_it_lies():
    azimuth, elevation = FROM_THE_SIDE
    assert view_of_body(FROM_THE_SIDE, body_turned("z", 40), "hip") == pytest.approx((azimuth + 40, elevation))
    for pitch_deg in (-90, 90):
        assert view_of_body(FROM_THE_SIDE, body_turned("y", pitch_deg), "hip")[1] < -50


SIZE = {"width": 160, "height": 120}
POSES = ("supine", "prone", "sitting", "standing")
ALONE = Framing(transparent=True)


def widths(picture):
    rows, columns = (np.flatnonzero(np.any(picture[..., 3] > 128, axis=axis)) for axis in (1, 0))
    return np.ptp(columns) + 1, np.ptp(rows) + 1


def bar_px(picture):
    lines = np.all(picture[5 * len(picture) // 6 :, :, :3] == COLOUR[:3], axis=2).astype(int)
    return max(np.diff(np.flatnonzero(np.diff([0, *line, 0])))[::2].max(initial=0) for line in lines)


def ends_of(model, data, root, axis):
    geoms = np.flatnonzero(model.body_rootid[model.geom_bodyid] == model.body(root).id)
    along = data.geom_xmat[geoms].reshape(-1, 3, 3)[:, axis]
    middles_m = data.geom_xpos[geoms, axis] + (along * model.geom_aabb[geoms, :3]).sum(axis=1)
    reach_m = (np.abs(along) * model.geom_aabb[geoms, 3:]).sum(axis=1)
    return (middles_m - reach_m).min(), (middles_m + reach_m).max()


def surroundings(model):
    """Return what pictures take from a model's floor and sky, whose light and colours are their own."""
    vis, mat = model.vis, model.material("mat").id
    fields = [field for field in dir(model) if field.startswith("mat_") and field != "mat_texid"]
    values = {field: getattr(model, field)[mat] for field in fields} | {"extent": model.stat.extent}
    values |= {"floor": model.geom("floor").size, "sky": model.texture("sky").width}
    values |= {name: getattr(vis.map, name) for name in ("znear", "zfar")}
    values |= {name: getattr(vis.quality, name) for name in ("shadowsize", "numslices", "numstacks")}
    texture = model.texture("mat")
    start, size = int(texture.adr[0]), int(np.prod([texture.width[0], texture.height[0], texture.nchannel[0]]))
    return values | {"mat": model.tex_data[start : start + size]}


@pytest.fixture(scope="module")
def posed(built):
    return {pose: built(scene={"pose": pose}) for pose in ("supine", "sitting")}


def test_infants_in_a_row_are_in_the_poses_of_their_specs(posed):
    """Four poses were byte-identical pictures."""
    supine, sitting = (posed[pose] for pose in ("supine", "sitting"))
    pictures = [lineup(pair, **SIZE) for pair in ((supine, supine), (supine, sitting), (sitting, sitting))]
    assert not np.array_equal(pictures[0], pictures[1])
    assert not np.array_equal(pictures[1], pictures[2])
    assert np.array_equal(lineup([supine] * 2, "sitting", **SIZE), pictures[2])


def test_each_pose_that_is_asked_for_is_another_picture(posed):
    pictures = {pose: lineup([posed["sitting"]] * 2, pose, **SIZE, framing=ALONE) for pose in POSES}
    assert len({picture.tobytes() for picture in pictures.values()}) == len(POSES)
    widths_px, heights_px = np.transpose([widths(pictures[pose]) for pose in POSES])
    assert POSES[np.argmax(heights_px / widths_px)] == "standing"


@pytest.mark.full
@pytest.mark.parametrize("kind", ["room", "crib"])
def test_a_row_is_the_same_wherever_its_infants_live(kind, built, posed):
    """In a room, an infant has a place and a direction of its own, which tore the row apart."""
    at_home = built(scene={"kind": kind, "seed": 3, "pose": "sitting"})
    flat = posed["sitting"]
    usual, *others = (lineup(pair, **SIZE) for pair in ((flat, flat), (at_home, flat), (flat, at_home)))
    for other in others:
        assert np.abs(usual.astype(int) - other).mean() < 1


@pytest.mark.matrix
@pytest.mark.parametrize("pose", POSES)
def test_infants_in_a_row_face_forward_and_keep_their_distance(pose, built, posed):
    """The feet of those that sat, and the hands of those that lay, went through each other."""
    older = built(age_months=20, scene={"kind": "room", "seed": 5})
    row = row_of([older, posed["supine"], older], pose)
    data = row.data
    for root in row.roots:
        assert data.body(root).xpos[0] == pytest.approx(0, abs=1e-9)
        assert data.body(root).xmat.reshape(3, 3)[:2, 1] == pytest.approx([0, 1], abs=0.02)
    ends_m = [ends_of(data.model, data, root, axis=1) for root in row.roots]
    (_, first), (second, third), (fourth, _) = ends_m
    assert (second - first, fourth - third) == pytest.approx((GAP_M, GAP_M))


def test_the_floor_of_a_row_is_that_of_flat_scenes(posed):
    row, flat = surroundings(row_of([posed["sitting"]], None).data.model), surroundings(load_model(posed["sitting"]))
    for name, value in flat.items():
        assert np.array_equal(row[name], value), name


@pytest.mark.parametrize("draw", [portrait, lambda bundle, **how: lineup([bundle] * 2, **how)], ids=["one", "two"])
def test_azimuth_and_elevation_turn_the_camera(draw, posed):
    """From its left and its right, an infant is its own mirror image, about; from the front it is another."""
    front, left, right, above = (
        draw(posed["sitting"], **SIZE, framing=Framing(azimuth, elevation, 3.0, transparent=True))[..., 3] / 255
        for azimuth, elevation in ((0, 0), (90, 0), (-90, 0), (0, 80))
    )
    assert np.abs(left - right[:, ::-1]).mean() < 0.25 * np.abs(left - front).mean()
    assert np.abs(above - front).mean() > 0.01


def test_what_is_twice_as_far_is_half_as_large(posed):
    near, far = (
        portrait(posed["sitting"], **SIZE, framing=Framing(0, 0, distance_m, transparent=True))
        for distance_m in (3.0, 6.0)
    )
    assert np.divide(widths(near), widths(far)) == pytest.approx(2, rel=0.15)


def test_a_transparent_picture_shows_the_infant_alone(posed):
    """Its edges are smooth, and of its own colours."""
    usual, alone = (portrait(posed["sitting"], **SIZE, framing=framing) for framing in (Framing(), ALONE))
    assert alone.shape == (120, 160, 4)
    opacity = alone[..., 3]
    assert opacity[0, 0] == opacity[-1, -1] == 0
    assert 0.05 < (opacity == 255).mean() < 0.6
    assert ((opacity > 0) & (opacity < 255)).any()
    _, parts = ndimage.label(opacity > 0)
    assert parts == 1
    inside: Any = ndimage.binary_erosion(opacity == 255, iterations=2)
    assert np.abs(usual[inside].astype(int) - alone[inside, :3]).mean() < 8


@pytest.mark.parametrize("transparent", [False, True])
@pytest.mark.parametrize("draw", [portrait, lambda bundle, **how: lineup([bundle] * 2, **how)], ids=["one", "two"])
def test_a_scale_bar_is_as_long_as_it_says(draw, transparent, posed):
    """From 2 m, a camera with a field of view of 24 (10) degrees sees 2 * 2 tan(12) (tan 5) metres."""
    framing = Framing(0, 0, 2.0, transparent, scale_bar=True)
    picture = draw(posed["sitting"], width=640, height=480, framing=framing)
    fovy_deg, length_m = (24, 0.2) if draw is portrait else (10, 0.1)
    assert bar_px(picture) == pytest.approx(length_m * 480 / (4 * math.tan(math.radians(fovy_deg / 2))), abs=1)


def test_an_infant_is_as_high_as_its_bar_says(posed):
    """From so far away that its nose is no larger than its ears, but for a hundredth."""
    bundle = posed["sitting"]
    picture = portrait(bundle, "standing", 900, 1200, shown="solids", framing=Framing(0, 0, 10.0, True, scale_bar=True))
    height_m = np.ptp(ends_of(*load_posed(bundle, "standing"), bundle.manifest.root_body, axis=2))
    _, height_px = widths(picture[:1000])
    bar_m = bar_length_cm(900, height_px / height_m) / 100
    assert height_px * bar_m / bar_px(picture) == pytest.approx(height_m, rel=0.015)
