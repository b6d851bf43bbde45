import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st

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

OUTDOORS = Planes(np.empty((0, 3)), np.empty((0, 3)))
coordinates = st.floats(-2, 2)
spheres = st.lists(st.tuples(coordinates, coordinates, coordinates, st.floats(0.01, 0.5)), min_size=1, max_size=12).map(
    lambda rows: Spheres(np.array(rows)[:, :3], np.array(rows)[:, 3])
)
views = st.tuples(st.floats(-360, 360), st.floats(-85, 85))
aspects = st.floats(0.3, 3)


def box_room(size_m) -> Planes:
    """Return the six planes of a room whose floor is at z = 0."""
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
    """Return a body that looks along x and is turned about an axis."""
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
