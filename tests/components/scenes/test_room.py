import dataclasses
import io
import math
from functools import cache

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from PIL import Image

from mimoc.base.random_streams import stream
from mimoc.compiler.looks.wallpaper import FLOORS, PICTURES, WALLS, Wallpapers
from mimoc.compiler.mjcf.elements import WorldGeom
from mimoc.compiler.scenes import HEADLIGHT
from mimoc.components.scenes.room import CLEARANCE_M, Room, draw_room, place_infant

USUAL = ((2.5, 5.0), (2.5, 5.0), (2.2, 3.0))
SEEDS = range(1000)
SIDES = ("floor", "ceiling", "wall_front", "wall_back", "wall_left", "wall_right")
SIZES = st.tuples(*[st.floats(1, 20).map(lambda side: (side, side))] * 3)


@cache
def rooms() -> list[Room]:
    return [draw_room(USUAL, seed) for seed in SEEDS]


def geom(room: Room, name: str) -> WorldGeom:
    return next(each for each in room.furniture.geoms if each.name == name)


def pictures(room: Room) -> list[WorldGeom]:
    return [each for each in room.furniture.geoms if each.name.startswith("picture")]


def axes(each: WorldGeom) -> np.ndarray:
    """Return the geom's own axes, in columns."""
    x, y, z = each.euler_rad
    turns = [
        np.array([[1, 0, 0], [0, math.cos(x), -math.sin(x)], [0, math.sin(x), math.cos(x)]]),
        np.array([[math.cos(y), 0, math.sin(y)], [0, 1, 0], [-math.sin(y), 0, math.cos(y)]]),
        np.array([[math.cos(z), -math.sin(z), 0], [math.sin(z), math.cos(z), 0], [0, 0, 1]]),
    ]
    return turns[0] @ turns[1] @ turns[2]


def corners(each: WorldGeom) -> np.ndarray:
    """Return the corners of a plane, or of a box around a lamp, shape (n, 3)."""
    half = (*each.size_m[:2], 0.0) if each.type == "plane" else (each.size_m[0], each.size_m[0], each.size_m[1])
    signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
    return np.asarray(each.pos_m) + signs * half @ axes(each).T


def material(room: Room, name: str):
    return next(each for each in room.furniture.materials if each.name == name)


def test_sizes_are_drawn_evenly_from_their_ranges():
    sizes = np.array([room.size_m for room in rooms()])
    shares = (sizes - [low for low, _ in USUAL]) / [high - low for low, high in USUAL]
    assert 0 <= shares.min() < 0.01 < 0.99 < shares.max() <= 1
    for share in shares.T:
        assert np.histogram(share, 5, (0, 1))[0].min() > 150
    assert np.abs(np.corrcoef(shares.T) - np.eye(3)).max() < 0.1


def test_a_range_of_one_size_is_that_size():
    assert draw_room(((3, 3), (4, 4), (2.5, 2.5)), 5).size_m == (3, 4, 2.5)


@given(SIZES, st.integers(0, 2**53))
def test_everything_is_inside_the_room(size, seed):
    room = draw_room(size, seed)
    half = np.array([room.size_m[0] / 2, room.size_m[1] / 2, room.size_m[2] / 2])
    for each in room.furniture.geoms:
        assert (np.abs(corners(each) - [0, 0, half[2]]) <= half + 1e-9).all(), each.name
    for light in room.furniture.lights:
        assert (np.abs(np.array(light.pos_m) - [0, 0, half[2]]) < half).all()


@given(SIZES)
def test_six_planes_face_inwards_and_close_the_room(size):
    room = draw_room(size, 3)
    middle = np.array([0, 0, room.size_m[2] / 2])
    for name in SIDES:
        side = geom(room, name)
        inwards = axes(side)[:, 2]
        distance = inwards @ (middle - side.pos_m)
        assert distance == pytest.approx(np.abs(inwards) @ room.size_m / 2)
        is_floor = side.name == "floor"
        assert (side.contype, side.conaffinity, side.barrier, side.type) == (is_floor, is_floor, not is_floor, "plane")
        assert sorted(np.abs(corners(side) - middle).max(axis=0)) == pytest.approx(sorted(np.array(room.size_m) / 2))


@pytest.mark.parametrize("name", SIDES[2:])
def test_wallpaper_stands_upright_and_is_not_mirrored(name):
    """A plane shows its picture as MuJoCo's x to the right and y upwards to one who looks against its z."""
    right, up, inwards = axes(geom(rooms()[0], name)).T
    assert up == pytest.approx([0, 0, 1])
    assert np.cross(right, up) == pytest.approx(inwards)


@pytest.mark.parametrize("seed", range(20))
def test_textures_have_their_real_size(seed):
    room, papers = rooms()[seed], {paper.name: paper for paper in [*FLOORS.values(), *WALLS.values()]}
    for name in ("floor", *SIDES[2:]):
        side, worn = geom(room, name), material(room, name)
        for half, repeat, tile in zip(side.size_m, worn.texrepeat, papers[worn.texture].tile_m, strict=False):
            assert repeat == (pytest.approx(2 * half / tile) if math.isfinite(tile) else 1)


def test_two_to_four_pictures_hang_at_eye_height_each_on_a_wall_of_its_own():
    counts = [len(pictures(room)) for room in rooms()]
    assert np.bincount(counts)[2:].min() > 270
    assert set(counts) == {2, 3, 4}
    for room in rooms():
        hung = pictures(room)
        assert len({picture.euler_rad for picture in hung}) == len(hung)
        assert all(1.2 <= picture.pos_m[2] <= 1.6 for picture in hung)
        assert len({material(room, picture.material).texture for picture in hung}) == len(hung)


@given(SIZES, st.integers(0, 2**53))
def test_pictures_are_flat_before_their_wall_and_touch_nothing(size, seed):
    room = draw_room(size, seed)
    for picture in pictures(room):
        wall = next(geom(room, side) for side in SIDES[2:] if geom(room, side).euler_rad == picture.euler_rad)
        offset = axes(wall).T @ np.subtract(picture.pos_m, wall.pos_m)
        assert offset[2] == pytest.approx(0.012)
        assert (np.abs(offset[:2]) + picture.size_m[:2] <= np.array(wall.size_m[:2]) - 0.1 + 1e-9).all()
        assert picture.contype == picture.conaffinity == 0


def test_a_user_may_hang_nothing_or_a_picture_of_any_size():
    assert pictures(draw_room(USUAL, 1, Wallpapers(pictures=()))) == []
    endless = dataclasses.replace(PICTURES["cat"], tile_m=(30.0, 1.0))
    for picture in pictures(draw_room(USUAL, 1, Wallpapers(pictures=(endless,)))):
        assert picture.size_m[0] / picture.size_m[1] == pytest.approx(30)


def test_every_texture_has_its_turn():
    wallpapers = Wallpapers()
    for name, choice in {
        "floor": wallpapers.floors,
        "ceiling": wallpapers.ceilings,
        **dict.fromkeys(SIDES[2:], wallpapers.walls),
    }.items():
        counts = [[material(room, name).texture for room in rooms()].count(paper.name) for paper in choice]
        assert min(counts) > 0.7 * 1000 / len(choice)
        assert sum(counts) == 1000


def test_walls_are_papered_apart_from_each_other():
    papers = [[material(room, name).texture for name in SIDES[2:]] for room in rooms()]
    alike = np.mean([first == second for first, second, *_ in papers])
    assert alike == pytest.approx(1 / len(WALLS), abs=0.04)


def test_the_same_seed_gives_the_same_room():
    assert draw_room(USUAL, 11) == draw_room(USUAL, 11)
    assert draw_room(USUAL, 11) != draw_room(USUAL, 12)


def test_changing_one_aspect_changes_no_other():
    """Other floors to choose from leave the walls alone, another size leaves all textures."""
    for seed in range(50):
        room = draw_room(USUAL, seed)
        refloored = draw_room(USUAL, seed, Wallpapers(floors=(FLOORS["cork"],)))
        larger = draw_room(((6, 9), (3, 4), (3, 3)), seed)
        bare = draw_room(USUAL, seed, Wallpapers(pictures=()))
        others = [name for name in SIDES if name != "floor"]
        assert refloored.furniture.geoms == room.furniture.geoms
        assert refloored.furniture.lights == room.furniture.lights == bare.furniture.lights
        assert [material(refloored, name) for name in others] == [material(room, name) for name in others]
        assert [material(bare, name) for name in SIDES] == [material(room, name) for name in SIDES]
        assert larger.furniture.textures == room.furniture.textures


def test_lamps_are_one_or_two_and_shed_the_same_light_together():
    counts = np.bincount([len(room.furniture.lights) for room in rooms()])
    assert counts[1:].min() > 400
    for room in rooms():
        total = np.sum([light.diffuse for light in room.furniture.lights], axis=0)
        assert 0.2 < total.min() <= total.max() <= 0.34
        assert sum(light.castshadow for light in room.furniture.lights) == 1, "shadows cost a drawing each"


def test_white_is_not_burnt_out():
    for room in rooms():
        lamps = np.sum([light.diffuse for light in room.furniture.lights], axis=0)
        assert (lamps + HEADLIGHT.ambient + HEADLIGHT.diffuse).max() < 1.1


def test_names_are_unique_and_every_reference_is_kept():
    for room in rooms()[:100]:
        furniture = room.furniture
        for things in (furniture.geoms, furniture.materials, furniture.textures, furniture.lights):
            assert len({thing.name for thing in things}) == len(things)
        assert {each.material for each in furniture.geoms} == {each.name for each in furniture.materials}
        textures = {each.name for each in furniture.textures}
        assert {each.texture for each in furniture.textured_materials} == textures
        assert len(furniture.textured_materials) + len(furniture.plain_materials) == len(furniture.materials)


def test_decoded_textures_take_little_memory():
    """16 MB is what a whole scene may have; an infant's faces take one."""
    for room in rooms()[:50]:
        sizes = [Image.open(io.BytesIO(texture.content)).size for texture in room.furniture.textures]
        assert sum(3 * width * height for width, height in sizes) < 2_500_000


def test_an_infant_is_clear_of_the_walls_and_anywhere_else():
    places = []
    for seed, room in enumerate(rooms()):
        place = place_infant(room.size_m, 0.45, stream(seed, "infant"))
        free = np.array(room.size_m[:2]) / 2 - 0.45 - CLEARANCE_M
        assert (np.abs([place.x_m, place.y_m]) <= free).all()
        places.append([*([place.x_m, place.y_m] / free), place.yaw_rad / math.pi - 1])
    for shares in np.array(places).T:
        assert np.histogram(shares, 5, (-1, 1))[0].min() > 150


@given(st.floats(1, 20), st.floats(1, 20), st.floats(0, 1), st.integers(0, 2**53))
def test_an_infant_is_in_the_middle_of_a_room_too_narrow(depth, width, radius, seed):
    place = place_infant((depth, width, 2.5), radius, stream(seed, "infant"))
    for side, along in ((depth, place.x_m), (width, place.y_m)):
        assert abs(along) <= max(side / 2 - radius - CLEARANCE_M, 0)
    assert 0 <= place.yaw_rad <= 2 * math.pi


def test_mujoco_closes_the_room_for_what_is_thrown_in_it():
    room = draw_room(((2, 2), (3, 3), (2.2, 2.2)), 0)
    planes = "".join(
        f'<geom type="plane" size="{" ".join(map(str, side.size_m))}" pos="{" ".join(map(str, side.pos_m))}" '
        f'euler="{" ".join(map(str, side.euler_rad))}"/>'
        for side in (geom(room, name) for name in SIDES)
    )
    balls = "".join(f'<body pos="0 {y} 1"><freejoint/><geom size=".05"/></body>' for y in (-0.4, -0.2, 0, 0.2, 0.4))
    compiler = '<compiler angle="radian" eulerseq="xyz"/>'
    model = mujoco.MjModel.from_xml_string(f"<mujoco>{compiler}<worldbody>{planes}{balls}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    data.qvel[:] = np.random.default_rng(0).uniform(-4, 4, model.nv)
    for _ in range(300):
        mujoco.mj_step(model, data, nstep=5)
        assert (np.abs(data.xpos[1:] - [0, 0, 1.1]) < np.array(room.size_m) / 2).all()
