import gc
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from scipy import ndimage

import mimoc
from mimoc.base.errors import RenderingError, UnknownNameError
from mimoc.bundle.model import load_model, load_posed
from mimoc.compiler import building
from mimoc.components.senses.touch import run
from mimoc.components.senses.touch.run import skin_markers
from mimoc.render import body_camera
from mimoc.render.body_camera import MOST_LOADED, UNLOADED, BodyCamera
from mimoc.render.camera import (
    CLEARANCE_M,
    FROM_THE_FRONT,
    FROM_THE_SIDE,
    Planes,
    Spheres,
    fit_shot,
    planes_of,
    shows,
    view_of_body,
)
from mimoc.render.opengl import open_context
from mimoc.render.portrait import ROW_FOVY_DEG, Framing, lineup, overview, portrait
from mimoc.schema.infant import load_spec


def share_of(picture, colour):
    """Return how much of a picture has the hue of a colour, in whatever light."""
    pixels = picture.reshape(-1, 3) + 1e-9
    hues = pixels / pixels.sum(axis=1, keepdims=True)
    return (np.abs(hues - colour / colour.sum()).max(axis=1) < 0.02).mean()


@pytest.fixture
def open_camera():
    cameras = []

    def open_one(model, width, height, *view):
        cameras.append(BodyCamera(model, ["hip"], width, height, *view))
        return cameras[-1]

    yield open_one
    for camera in cameras:
        camera.close()


def posed(bundle, pose, shadows_px=0):
    """Return a model and its state; large shadows take time to draw."""
    model = load_model(bundle)
    model.vis.quality.shadowsize = shadows_px
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    return model, data


def test_a_portrait_shows_skin_and_clothes(config):
    picture, model = portrait(config, width=160, height=120), load_model(config)
    assert (picture.shape, picture.dtype) == ((120, 160, 3), np.uint8)
    for material, least in (("skin", 0.01), ("pants_up", 0.002)):  # Trousers have folds.
        assert share_of(picture, model.material(material).rgba[:3]) > least


@pytest.fixture(scope="module", params=[(120, 120), (200, 120), (120, 200)], ids=str)
def stage(request, bundle):
    """Return a model, the camera that looks at its infant, and the width and height of its pictures."""
    model, _ = posed(bundle, "supine")
    with closing(BodyCamera(model, ["hip"], *request.param)) as camera:
        yield model, camera, request.param


@pytest.mark.parametrize("pose", ["supine", "prone", "sitting", "standing"])
def test_all_of_the_infant_is_in_the_picture_and_fills_it(bundle, pose, stage):
    """It is where the picture changes when the infant is taken out of it."""
    (model, camera, (width, height)), (_, data) = stage, posed(bundle, pose)
    colours = model.mat_rgba.copy()
    with_infant = camera.render(data).astype(int)
    model.mat_rgba[model.geom_matid[model.geom_bodyid > 0], 3] = 0
    model.mat_rgba[model.skin_matid, 3] = 0
    shown = np.abs(with_infant - camera.render(data)).max(axis=2) > 20
    model.mat_rgba[:] = colours
    assert not shown[[0, -1]].any()
    assert not shown[:, [0, -1]].any()
    assert max(np.ptp(np.nonzero(shown)[0]) / height, np.ptp(np.nonzero(shown)[1]) / width) > 0.65


def test_the_same_state_is_the_same_picture_whatever_was_drawn_before(bundle, open_camera):
    model, data = posed(bundle, "prone", shadows_px=256)
    camera = open_camera(model, 64, 64)
    first = camera.render(data)
    camera.render(posed(bundle, "standing")[1])
    assert np.array_equal(camera.render(data), first)


def test_the_pose_is_that_of_the_bundle_unless_another_is_asked_for(bundle):
    usual, sitting, prone = (portrait(bundle, pose, 64, 64) for pose in (None, "sitting", "prone"))
    assert np.array_equal(usual, sitting)
    assert not np.array_equal(usual, prone)


def test_an_unknown_pose_is_refused(bundle):
    with pytest.raises(UnknownNameError, match="'handstand' is not a pose; "):
        portrait(bundle, "handstand")


@pytest.mark.parametrize(("width", "height"), [(16, 16), (31, 77), (656, 496)])
def test_a_picture_has_the_size_that_is_asked_for(bundle, width, height):
    """Also one that is larger than MuJoCo's usual 640 x 480, and one whose rows are not whole words."""
    picture = portrait(bundle, width=width, height=height)
    assert picture.shape == (height, width, 3)
    assert len(np.unique(picture[:, -1].reshape(-1, 3), axis=0)) > 1


def test_an_environment_draws_what_happens(open_env):
    env = open_env(render_mode="rgb_array")
    env.model.vis.quality.shadowsize = 0
    env.reset(seed=0)
    before = env.render()
    for _ in range(20):
        env.step(env.action_space.high)
    after = env.render()
    assert before.shape == after.shape == (480, 480, 3)
    assert not np.array_equal(before, after)
    assert not np.shares_memory(before, after)


def test_drawing_changes_nothing_of_what_happens(open_env):
    drawn, alone = open_env(render_mode="rgb_array"), open_env()
    for env in (drawn, alone):
        env.model.vis.quality.shadowsize = 0
        env.reset(seed=0)
        for _ in range(3):
            env.step(env.action_space.high)
            env.render()
    assert np.array_equal(drawn.data.qpos, alone.data.qpos)


def test_cameras_side_by_side_do_not_disturb_each_other(bundle, bundle_at, open_camera):
    """Each keeps its own textures, size and picture, whatever becomes of the other."""
    subjects = [(posed(bundle, "prone", shadows_px=256), 64), (posed(bundle_at(0), "supine", shadows_px=512), 96)]
    alone = []
    for (model, data), size in subjects:
        camera = open_camera(model, size, size)
        alone.append(camera.render(data))
        camera.close()
    together = [open_camera(model, size, size) for (model, _), size in subjects]
    for _ in range(2):
        for camera, ((_, data), _), picture in zip(together, subjects, alone, strict=True):
            assert np.array_equal(camera.render(data), picture)
    together[0].close()
    assert np.array_equal(together[1].render(subjects[1][0][1]), alone[1])


class CountedContext:
    """An OpenGL context that counts how often it is freed."""

    def __init__(self, width, height):
        self.context, self.freed = open_context(width, height), 0

    def make_current(self):
        self.context.make_current()

    def free(self):
        self.freed += 1
        self.context.free()


@pytest.fixture
def contexts(monkeypatch):
    opened = []

    def open_counted(width, height):
        opened.append(CountedContext(width, height))
        return opened[-1]

    monkeypatch.setattr("mimoc.render.renderer.open_context", open_counted)
    return opened


def test_a_context_is_freed_once_however_often_it_is_closed(bundle, contexts, open_env):
    env = open_env(render_mode="rgb_array")
    env.reset(seed=0)
    assert not contexts
    env.render()
    env.render()
    assert [context.freed for context in contexts] == [0]
    env.close()
    env.close()
    assert [context.freed for context in contexts] == [1]


@pytest.mark.full
def test_a_context_that_is_forgotten_is_freed_too(bundle, contexts):
    env = mimoc.InfantEnv(bundle, render_mode="rgb_array")
    env.reset(seed=0)
    env.render()
    del env
    gc.collect()
    assert [context.freed for context in contexts] == [1]


def test_a_portrait_frees_its_context_even_if_it_fails(bundle, contexts, monkeypatch):
    portrait(bundle, width=16, height=16)
    monkeypatch.setattr(mujoco, "mjr_render", lambda *args: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        portrait(bundle, width=16, height=16)
    assert [context.freed for context in contexts] == [1, 1]


def test_infants_in_a_row_are_to_scale():
    """Standing, what shows of them is as high in proportion as the children are long."""
    infants = [mimoc.build(mimoc.InfantSpec(mimoc=1, name="infant", age_months=age)) for age in (2, 20)]
    picture = lineup(infants, "standing", width=400, height=300, framing=Framing(elevation_deg=0, transparent=True))
    parts, _ = ndimage.label(picture[..., 3] > 128)
    heights_px = [np.ptp(np.flatnonzero((parts == number).any(axis=1))) for number in (1, 2)]
    lengths_cm = [infant.manifest.child.length_cm for infant in infants]
    assert max(heights_px) / min(heights_px) == pytest.approx(lengths_cm[1] / lengths_cm[0], rel=0.1)


def test_faces_at_the_ends_of_a_row_do_not_turn_away():
    """The camera sees each from within 10 degrees of straight ahead."""
    standing = Spheres(np.array([[0.0, y, z] for y in np.arange(5) * 0.4 for z in (0.1, 0.4, 0.7)]), np.full(15, 0.1))
    walls = Planes(np.empty((0, 3)), np.empty((0, 3)))
    position_m = fit_shot(standing, walls, FROM_THE_FRONT, 2.5, ROW_FOVY_DEG).position_m
    angles_deg = np.degrees(np.arctan2(np.abs(standing.centres_m[:, 1] - position_m[1]), position_m[0]))
    assert angles_deg.max() < 10


@pytest.mark.parametrize("months", [0, 9, 24])
def test_an_infant_on_its_back_shows_its_face(months, bundle_at, open_camera):
    """It looks at the camera from less than 60 degrees away."""
    model, data = posed(bundle_at(months), "supine")
    position_m = open_camera(model, 16, 16, view_of_body(FROM_THE_SIDE, data, "hip")).shot(data).position_m
    way = position_m - data.body("head").xpos
    ahead = data.body("head").xmat.reshape(3, 3)[:, 0]
    assert ahead @ way > 0.5 * np.linalg.norm(way)


@pytest.mark.parametrize("pose", ["supine", "sitting", "standing"])
def test_nothing_of_an_infant_is_burnt_out(bundle, pose):
    """Its skin has its own colour wherever it is brightest: only red comes to the end of its range."""
    model = load_model(bundle)
    picture = portrait(bundle, pose, 320, 240)
    hues = picture / (picture.sum(axis=2, keepdims=True) + 1e-9)
    skin = np.abs(hues - model.material("skin").rgba[:3] / model.material("skin").rgba[:3].sum()).max(axis=2) < 0.02
    assert skin.sum() > 300
    brightest = picture[skin].max(axis=0)
    assert brightest[0] > 220
    assert brightest[1] < 240
    assert brightest[2] < 215


def test_infants_of_any_kind_stand_in_one_row(bundle):
    """Their names do not clash, whatever hands and muscles they have."""
    other = {"body": {"hands": "five_finger", "remove": ["left_eye"]}, "actuation": {"model": "muscle"}}
    spec = {"mimoc": 1, "name": "other", "age_months": 12, **other}
    picture = lineup([bundle, mimoc.build(mimoc.InfantSpec.model_validate(spec)), bundle], width=90, height=60)
    assert picture.std() > 10


@pytest.fixture(scope="module")
def feeling():
    spec = {"mimoc": 1, "name": "feeling", "age_months": 9, "senses": {"touch": {"density": 0.3}}}
    spec |= {"scene": {"pose": "standing"}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(spec))
    return bundle, *posed(bundle, "standing")


def share_of_skin_points(picture):
    """Return how much of a picture is the blue of points that feel nothing, and the red of those that do.

    Nothing else is as much more blue than red, or red than green.
    """
    red, green, blue = picture.astype(int).transpose(2, 0, 1)
    return (blue - red > 80).mean(), (red - green > 80).mean()


@pytest.mark.full
def test_the_skin_shows_in_a_picture_and_where_it_feels_something_in_another_colour(feeling):
    bundle, *_ = feeling
    markers = skin_markers(bundle, *load_posed(bundle))
    bare, skin = (portrait(bundle, width=320, height=240, markers=each) for each in (None, markers))
    assert skin.shape == bare.shape
    assert share_of_skin_points(bare)[0] == 0
    assert share_of_skin_points(skin)[0] > 0.0005
    assert share_of_skin_points(skin)[1] > share_of_skin_points(bare)[1] + 0.00005  # Hems are reddish, too.


def test_the_points_that_are_pressed_are_larger_and_the_one_most_so_has_the_strongest_colour(feeling):
    markers = skin_markers(*feeling)
    bundle, model, data = feeling
    state = run.bind(bundle.manifest.senses.touch, model, bundle).skin_state(data)
    forces_n = np.linalg.norm(state.forces, axis=1)
    assert np.array_equal(markers.positions_m, state.positions)
    assert set(state.bodies[forces_n > 0]) <= {"left_foot", "right_foot", "left_toes", "right_toes"}
    assert markers.radii_m[forces_n > 0].min() > 1.2 * markers.radii_m[forces_n == 0].max()
    assert markers.colours[forces_n.argmax()] == pytest.approx(MOST_LOADED)
    assert markers.colours[forces_n == 0] == pytest.approx(np.tile(UNLOADED, ((forces_n == 0).sum(), 1)))


def test_where_nothing_is_felt_all_points_are_alike(feeling):
    bundle, model, _ = feeling
    data = mujoco.MjData(model)
    data.qpos[2] += 1
    mujoco.mj_forward(model, data)
    assert len(np.unique(skin_markers(bundle, model, data).colours, axis=0)) == 1


def test_skin_points_are_in_one_picture_only(feeling, open_camera):
    bundle, model, data = feeling
    camera = open_camera(model, 64, 64)
    first = camera.render(data)
    assert not np.array_equal(camera.render(data, skin_markers(bundle, model, data)), first)
    assert np.array_equal(camera.render(data), first)


@pytest.mark.full
def test_infants_in_a_row_show_their_skin_each_in_its_place(feeling):
    """Both stand on soles that are pressed, and a rim of what they feel shows; one is in a room at home."""
    bundle, *_ = feeling
    spec = {"mimoc": 1, "name": "other", "age_months": 9, "senses": {"touch": {"density": 0.3}}}
    other = mimoc.build(mimoc.InfantSpec.model_validate(spec | {"scene": {"kind": "room", "pose": "standing"}}))
    markers = [skin_markers(each, *load_posed(each)) for each in (bundle, other)]
    bare, skin = (lineup([bundle, other], width=320, height=240, markers=each) for each in (None, markers))
    assert share_of_skin_points(bare)[0] == 0
    for half in (slice(0, 160), slice(160, 320)):
        unloaded, pressed = share_of_skin_points(skin[:, half])
        assert unloaded > 0.001
        assert pressed > share_of_skin_points(bare[:, half])[1]  # Hems are reddish, too.


def test_an_infant_without_touch_has_no_skin_to_show(bundle_at):
    bundle = bundle_at(9)
    with pytest.raises(RenderingError, match=r"'infant' has no sense of touch.* add `senses: \{touch: \{\}\}`"):
        skin_markers(bundle, *load_posed(bundle))


@pytest.fixture(scope="module")
def playroom():
    return building.builder(load_spec(Path(__file__).parents[2] / "configs" / "playroom.yaml"))


@pytest.fixture(scope="module")
def room(built):
    return built(scene={"kind": "room", "pose": "sitting", "toys": {"count": [3, 3]}})


def test_toys_and_infant_are_in_the_picture(room, built):
    """It differs where they are from that of the same room without toys."""
    empty = built(scene={"kind": "room", "pose": "sitting"})
    full, bare = overview(room, 160, 120), overview(empty, 160, 120)
    assert full.shape == bare.shape == (120, 160, 3)
    assert not np.array_equal(full, bare)
    assert full.std() > 20


def test_the_same_room_is_the_same_picture(room):
    assert np.array_equal(overview(room, 80, 60), overview(room, 80, 60))


@pytest.mark.parametrize("seed", range(12))
def test_no_room_is_seen_through_a_wall(seed, playroom, monkeypatch):
    """Also seed 7, whose infant looks at a wall that is near; and everything is in the picture."""
    seen = []

    def look(camera, data):
        seen.append((camera.shot(data), camera.spheres(data), planes_of(data.model, data), camera.aspect))

    monkeypatch.setattr(BodyCamera, "render", look)
    monkeypatch.setattr(body_camera, "Renderer", lambda *_: SimpleNamespace(close=lambda: None))
    overview(playroom(seed, check=False), 32, 24)
    ((shot, spheres, walls, aspect),) = seen
    assert walls.clearance_m(shot.position_m) >= CLEARANCE_M
    assert shows(shot, spheres, aspect)
