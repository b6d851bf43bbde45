"""Furniture has the sizes that it says, bears what stands on it, and shows its pictures."""

import io
from contextlib import closing

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from PIL import Image
from support.devices import DEVICE
from support.furnished import furnished, spec_with

import mimoc
from mimoc.base.errors import SpecError
from mimoc.bundle.model import load_model
from mimoc.render.renderer import Renderer

FAR = {"x_cm": 120, "y_cm": 0}
"""A place that the infant, which lies at the origin, does not reach."""
BALL = {"name": "ball", "shape": "sphere", "radius_cm": 4}
CUP = {"name": "cup", "shape": "cylinder", "radius_cm": 3, "length_cm": 8}


def corners_of(scene, geom: str) -> np.ndarray:
    """Return the corners of a box in the world, shape (8, 3), [m]."""
    half, place = scene.model.geom(geom).size, scene.data.geom(geom)
    signs = np.array(np.meshgrid(*3 * [[-1, 1]])).reshape(3, -1).T
    return signs * half @ place.xmat.reshape(3, 3).T + place.xpos


@pytest.mark.parametrize("sink_cm", [0.1, 0.5, 2.0])
def test_what_rests_on_one_point_of_a_mat_sinks_in_as_far_as_it_says(sink_cm):
    mat = {"name": "mat", "kind": "mat", "thickness_cm": 5, "sink_cm": sink_cm, "at": FAR}
    scene = furnished([mat, {**BALL, "at": "on mat"}])
    scene.run(3)
    depth_cm = 100 * (0.05 + 0.04 - scene.data.body("object_ball").xpos[2])
    assert depth_cm == pytest.approx(sink_cm, rel=0.05)


@pytest.mark.parametrize(
    "thing", [BALL, CUP, {"name": "brick", "shape": "box"}, {"name": "cup", "toy": "cup"}], ids=str
)
@pytest.mark.parametrize("support", [{"kind": "table"}, {"kind": "mat", "sink_cm": 0.1}], ids=str)
def test_what_stands_on_furniture_stands_still(thing, support):
    scene = furnished([{"name": "support", "at": FAR, **support}, {**thing, "at": "on support"}])
    scene.run(1)
    body, joint = f"object_{thing['name']}", f"object_{thing['name']}_free"
    assert scene.moved_m(1, body) < 1e-4
    assert np.abs(scene.data.joint(joint).qvel).max() < 0.02


def test_a_table_is_as_high_and_as_large_as_it_says():
    table = {"name": "table", "kind": "table", "top_cm": 37, "sides_cm": [40, 70], "at": FAR}
    scene = furnished([table, {**BALL, "at": "on table"}])
    top = corners_of(scene, "object_table_top")
    assert top.max(axis=0) == pytest.approx([1.4, 0.35, 0.37])
    assert top.min(axis=0)[:2] == pytest.approx([1.0, -0.35])
    assert scene.data.body("object_ball").xpos == pytest.approx([1.2, 0.0, 0.41])
    legs = [
        corners_of(scene, f"object_table_leg_{end}_{side}") for end in ("far", "near") for side in ("left", "right")
    ]
    assert min(leg[:, 2].min() for leg in legs) == pytest.approx(0.0, abs=1e-9)


def test_stairs_rise_step_by_step():
    stairs = {"name": "stairs", "kind": "stairs", "steps": 4, "rise_cm": 12, "run_cm": 25, "at": FAR}
    scene = furnished([stairs])
    tops = [corners_of(scene, f"object_stairs_{number}").max(axis=0) for number in range(1, 5)]
    assert [top[2] for top in tops] == pytest.approx([0.12, 0.24, 0.36, 0.48])
    assert [top[0] for top in tops] == pytest.approx([0.95, 1.2, 1.45, 1.7])


def test_a_slope_rises_from_the_floor_by_its_angle_and_a_ball_rolls_down_as_on_an_inclined_plane():
    """A solid ball rolls with 5/7 g sin a, less what resists rolling."""
    slope = {"name": "slope", "kind": "slope", "angle_deg": 20, "length_cm": 200, "at": {"x_cm": 300}}
    up = np.array([np.cos(np.radians(20)), 0.0, np.sin(np.radians(20))])
    normal = np.array([-up[2], 0.0, up[0]])
    scene = furnished([slope, {**BALL, "at": {"x_cm": 300, "z_cm": 300}}])
    top = corners_of(scene, "object_slope_top")
    assert (top @ normal).max() == pytest.approx((3.0 - np.cos(np.radians(20)), 0, 0) @ normal, abs=1e-6)
    middle = np.array([3.0, 0.0, np.sin(np.radians(20))]) + 0.0399 * normal
    scene.data.joint("object_ball_free").qpos[:3] = middle
    scene.run(0.4)
    rolled_m = (middle - scene.data.body("object_ball").xpos) @ up
    assert rolled_m == pytest.approx(5 / 7 * 9.81 * np.sin(np.radians(20)) * 0.4**2 / 2, rel=0.05)


def test_a_rail_is_by_default_as_high_as_that_of_the_childs_crib():
    scene = furnished([{"name": "rail", "kind": "rail", "at": FAR}])
    crib = furnished([], kind="crib")
    assert scene.data.geom("object_rail_bar").xpos[2] == pytest.approx(crib.data.geom("crib_rail_front").xpos[2])


def test_furniture_is_turned_by_its_yaw():
    scene = furnished([{"name": "table", "kind": "table", "sides_cm": [40, 80], "at": FAR, "yaw_deg": 90}])
    top = corners_of(scene, "object_table_top")
    assert top.max(axis=0)[:2] == pytest.approx([1.6, 0.2])


GRATING = {"cpd": 0.5, "contrast": 0.6, "from_cm": 80}


def seen(scene, from_m: float, middle_m: float) -> np.ndarray:
    """Return the middle row of what a camera before a screen at x = 1.2 m sees, 60 degrees high, 0 to 255."""
    camera = mujoco.MjvCamera()
    camera.lookat[:], camera.distance, camera.azimuth, camera.elevation = (1.2 - 0.01, 0, middle_m), from_m, 0, 0
    scene.model.vis.global_.fovy = 60
    return drawn(scene.model, scene.data, camera, 400)[200].astype(float).mean(axis=1)


def drawn(model: mujoco.MjModel, data: mujoco.MjData, camera: mujoco.MjvCamera, size_px: int) -> np.ndarray:
    """Return what a camera sees, shape (size_px, size_px, 3)."""
    with closing(Renderer(model, size_px, size_px)) as renderer, renderer.in_use():
        renderer.compose(data, camera)
        renderer.draw()
        return renderer.read()[::-1]


def test_a_grating_has_its_spatial_frequency_and_contrast_before_the_eye():
    scene = furnished([{"name": "screen", "kind": "screen", "width_cm": 60, "grating": GRATING, "at": FAR}])
    row = seen(scene, 0.8, 0.5)
    panel = row[90:310]  # 37 of the 41 degrees that the screen has.
    low, high = np.percentile(panel, (1, 99))
    assert (high - low) / (high + low) == pytest.approx(0.6, abs=0.02)
    assert (high + low) / 2 == pytest.approx(127.5, abs=2)
    offsets = np.tan(np.radians(np.arange(-16, 16.1, 4))) * 0.8 * np.radians(1) / np.tan(np.radians(1))
    assert len(offsets) == 9
    columns = 200 + 200 / np.tan(np.radians(30)) * np.tan(np.radians(2 * np.arange(-3, 4)))
    bright = [row[round(column) - 2 : round(column) + 2].mean() for column in columns]
    assert min(bright) > high - 15, "a cycle each two degrees, bright in the middle"


def test_what_a_screen_shows_does_not_depend_on_the_light():
    grey = {"name": "screen", "kind": "screen", "grating": {"contrast": 0}, "at": FAR}
    for world in ({"kind": "flat"}, {"kind": "room", "room": {"size_m": [[4, 4], [4, 4], [2.5, 2.5]]}}):
        scene = furnished([grey], **world)
        assert seen(scene, 0.3, 0.5) == pytest.approx(127.5, abs=1)


def test_a_picture_of_the_users_is_seen_upright(tmp_path):
    colours = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
    Image.fromarray(colours.repeat(40, 0).repeat(40, 1)).save(tmp_path / "four.png")
    path = tmp_path / "x.yaml"
    screen = "{name: screen, kind: screen, width_cm: 40, tall_cm: 40, picture: four.png, at: {x_cm: 120}}"
    path.write_text(f"mimoc: 1\nname: x\nage_months: 9\nbody: {{skin: false}}\nscene: {{objects: [{screen}]}}\n")
    bundle = mimoc.build(mimoc.load_spec(path))
    stored = np.asarray(Image.open(io.BytesIO(bundle.files["assets/object_screen_picture.png"])))
    assert stored.shape == (80, 80, 3)
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    camera = mujoco.MjvCamera()
    camera.lookat[:], camera.distance, camera.azimuth, camera.elevation = (1.2, 0, 0.5), 0.8, 0, 0
    image = drawn(model, data, camera, 200)
    assert image[80, 80].tolist() == [255, 0, 0]
    assert image[80, 120].tolist() == [0, 255, 0]
    assert image[120, 80].tolist() == [0, 0, 255]


BAD = [
    ({"kind": "mat", "above": "chest"}, "objects[0].above: furniture stands on the floor"),
    ({"kind": "screen", "middle_cm": 10, "at": FAR}, "objects[0].middle_cm: its lower half reaches below the floor"),
    ({"kind": "seat", "recline_deg": 5, "at": FAR}, "objects[0].recline_deg: 5 is too small; give 15 to 60 degrees"),
    ({"kind": "wall", "grating": {"cpd": 50}, "at": FAR}, "objects[0].grating.cpd: 200 cm of it have more than 512"),
    ({"kind": "wall", "picture": "no.png", "at": FAR}, "objects[0].picture: no.png: cannot be read (No such file"),
    (
        {"kind": "wall", "picture": "a.png", "grating": {}, "at": FAR},
        "objects[0].grating: it shows a picture already; leave out one of them",
    ),
]


@pytest.mark.parametrize(("item", "message"), BAD, ids=[message for _, message in BAD])
def test_what_cannot_be_is_one_line_with_its_key(item, message):
    with pytest.raises(SpecError) as caught:
        mimoc.build(spec_with([{"name": "thing", **item}]))
    assert [message in str(problem) for problem in caught.value.problems] == [True], str(caught.value)


def test_what_is_within_reach_of_an_infant_on_a_mat_lies_on_the_mat():
    scene = furnished([{"name": "mat", "kind": "mat"}, {**BALL, "at": "within reach of right_hand"}], start_at="mat")
    x, y, z = scene.data.body("object_ball").xpos
    assert z == pytest.approx(0.07)
    assert np.hypot(x, y) < 0.5


def test_toys_lie_beside_furniture():
    """A screen covers a strip of the floor, not the disc around it."""
    scene = {"kind": "flat", "objects": [{"name": "wall", "kind": "wall", "width_cm": 300, "at": {"x_cm": 60}}]}
    toys = {"toys": {"count": [12, 12], "size_cm": [6, 6]}}
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "body": {"skin": False}, "scene": {**scene, **toys}}
    model = load_model(mimoc.build(mimoc.InfantSpec.model_validate(spec)))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert data.contact.dist.min(initial=0.0) > -1e-3
    places = np.array([data.body(index).xpos for index in range(model.nbody) if model.body(index).name[:3] == "toy"])
    assert len(places) == 12
    assert (np.hypot(*(places[:, :2] - (0.6, 0)).T) < 1.5).any()


PLACES = [{"x_cm": 600, "y_cm": 0}, {"x_cm": -600, "y_cm": 0}, {"x_cm": 0, "y_cm": 600}, {"x_cm": 0, "y_cm": -600}]
"""So far apart that no two pieces of furniture touch."""

lengths = st.floats(10, 200)
sides = st.tuples(lengths, lengths)
looks = st.fixed_dictionaries({"yaw_deg": st.floats(-180, 180)})
gratings = st.fixed_dictionaries({"cpd": st.floats(0.1, 1), "contrast": st.floats(0, 1)})
FURNITURE = {
    "mat": {"sides_cm": sides, "thickness_cm": st.floats(0.5, 50), "sink_cm": st.floats(0.05, 3)},
    "table": {"sides_cm": sides, "top_cm": st.floats(5, 120)},
    "rail": {"width_cm": lengths, "bar_cm": st.floats(5, 100)},
    "stairs": {
        "steps": st.integers(1, 20),
        "rise_cm": st.floats(1, 30),
        "run_cm": st.floats(5, 25),
        "width_cm": lengths,
    },
    "slope": {"angle_deg": st.floats(0, 40), "length_cm": lengths, "width_cm": lengths},
    "wall": {"width_cm": lengths, "tall_cm": lengths, "thickness_cm": st.floats(1, 50), "grating": gratings},
    "screen": {
        "width_cm": lengths,
        "tall_cm": st.floats(10, 100),
        "middle_cm": st.floats(50, 200),
        "grating": gratings,
    },
    "seat": {"recline_deg": st.floats(15, 60), "seat_cm": st.floats(50, 100)},
}
"""Sizes of each kind that a spec can ask for, up to what fits between the others."""
BEARS = ("mat", "table")
THINGS = [
    {"shape": "sphere", "radius_cm": 3},
    {"shape": "box", "sides_cm": [5, 4, 3]},
    {"shape": "cylinder", "radius_cm": 3, "length_cm": 6},
    {"toy": "cup", "size_cm": 7},
]


@st.composite
def rooms(draw):
    """Return the objects of a scene, and where its infant starts."""
    kinds = draw(st.lists(st.sampled_from(sorted(FURNITURE)), min_size=1, max_size=4))
    objects = []
    for number, (kind, place) in enumerate(zip(kinds, PLACES, strict=False)):
        item = {"name": f"{kind}{number}", "kind": kind, "at": place}
        objects.append(item | draw(looks) | {key: draw(value) for key, value in FURNITURE[kind].items()})
        if kind in BEARS:
            objects.append({"name": f"thing{number}", "at": f"on {item['name']}", **draw(st.sampled_from(THINGS))})
    starts = {
        "floor": ([], {"pose": draw(st.sampled_from(["supine", "prone"]))}),
        "mat": ([{"name": "start", "kind": "mat", "thickness_cm": draw(st.floats(1, 30))}], {"start_at": "start"}),
        "slope": ([{"name": "start", "kind": "slope", "angle_deg": draw(st.floats(0, 20))}], {"start_at": "start"}),
        "seat": (
            [{"name": "start", "kind": "seat", "recline_deg": draw(st.floats(25, 60))}],
            {"start_at": "start", "pose": "sitting"},
        ),
    }
    first, scene = starts[draw(st.sampled_from(sorted(starts)))]
    return [*first, *objects], scene


@pytest.mark.full
@settings(max_examples=30)
@given(rooms(), st.sampled_from([0, 4, 9, 16, 24]))
def test_random_furniture_is_stood_on_and_rests(room, age_months):
    objects, scene = room
    start = furnished(objects, age_months, **scene)
    assert start.deepest_m() < 2e-4
    things = [item["name"] for item in objects if item["name"].startswith("thing")]
    before = start.place("hip", *(f"object_{name}" for name in things))
    start.run(2)
    assert np.linalg.norm(start.place("hip") - before[:1]) < 0.03, "it sinks in by 5 mm, the youngest roll a little"
    for name in things:
        speed = np.abs(start.data.joint(f"object_{name}_free").qvel)
        assert speed[:3].max() < 0.02, name
        assert speed[3:].max() < 0.1, "what is slender sways on a soft mat for some seconds"
    moved_m = np.linalg.norm((start.place("hip", *(f"object_{name}" for name in things)) - before)[1:], axis=1)
    assert (moved_m < 0.031).all(), "nothing but foam gives way"


LAB = [
    {"name": "chair", "kind": "seat"},
    {"name": "table", "kind": "table", "sides_cm": [35, 60], "top_cm": 45, "at": {"x_cm": 32, "y_cm": 0}},
    {"name": "cup", "shape": "cylinder", "radius_cm": 3, "length_cm": 6, "at": "on table"},
    {"name": "mat", "kind": "mat", "at": {"x_cm": 0, "y_cm": 120}},
    {"name": "ball", "shape": "sphere", "at": "on mat"},
]
SENSES = {"proprioception": {"include": ["velocity"]}, "vestibular": {}}


def bundle(age_months: float) -> mimoc.Bundle:
    return mimoc.build(spec_with(LAB, age_months, pose="sitting", start_at="chair", senses=SENSES))


@pytest.mark.extras
@pytest.mark.slow
@pytest.mark.usefixtures("kernels_compiled_quickly")
def test_on_a_device_furniture_bears_what_it_does_on_the_cpu():
    bundles = [bundle(6), bundle(12)]
    ours, theirs = mimoc.make_vec(bundles, 2, device=DEVICE), mimoc.make_vec(bundles, 2, threads=1)
    for env in (ours, theirs):
        env.reset(seed=0)
    still = np.zeros(theirs.action_space.shape, np.float32)
    for _ in range(10):
        ours.step(still), theirs.step(still)
    qpos = ours.worlds.data.qpos.numpy()
    for index, infant in enumerate(theirs.infants):
        for name in ("object_cup_free", "object_ball_free", "mimo_location"):
            address = infant.model.joint(name).qposadr[0]
            expected = infant.data.qpos[address : address + 3]
            assert qpos[index, address : address + 3] == pytest.approx(expected, abs=1e-3), name
    for env in (ours, theirs):
        env.close()
