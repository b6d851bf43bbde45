from contextlib import closing

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import RenderingError
from mimoc.recording.record import GAP_PX, VideoFrames
from mimoc.render.camera import shows

HEIGHT_PX = 2 * 32 + GAP_PX
WIDTH_PX = round(HEIGHT_PX * 4 / 3)


@pytest.fixture
def open_film():
    """Return what opens a film without shadows, which take time."""
    films = []

    def open_one(env, **options):
        env.model.vis.quality.shadowsize = 0
        films.append(VideoFrames(env, HEIGHT_PX, **options))
        return films[-1]

    yield open_one
    for film in films:
        film.close()


def test_a_frame_shows_what_happens(open_env, open_film):
    env = open_env()
    observation, _ = env.reset(seed=0)
    film = open_film(env)
    first, again = film.frame(observation), film.frame(observation)
    env.step(env.action_space.high)
    for _ in range(20):
        observation, *_ = env.step(env.action_space.high)
    assert first.shape == (HEIGHT_PX, WIDTH_PX, 3)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, film.frame(observation))


def test_beside_it_is_exactly_what_the_infant_observes(open_env, open_film):
    """Blurred, foveated and late as it is."""
    vision = {"width_px": 32, "height_px": 32, "foveation": 5}
    env = open_env(senses={"vision": vision}, delays={"vision_ms": 50}, scene={"pose": "sitting"})
    env.reset(seed=0)
    film = open_film(env, eyes=True)
    for _ in range(3):
        observation, *_ = env.step(env.action_space.high)
    frame = film.frame(observation)
    assert frame.shape == (HEIGHT_PX, WIDTH_PX + GAP_PX + 32, 3)
    column = frame[:, WIDTH_PX + GAP_PX :]
    assert np.array_equal(column[:32], observation["eye_left"])
    assert np.array_equal(column[-32:], observation["eye_right"])


@pytest.mark.parametrize(("width_px", "height_px"), [(64, 64), (48, 24), (7, 100)])
def test_pictures_of_any_size_fit_beside_it(width_px, height_px, open_env, open_film):
    vision = {"width_px": width_px, "height_px": height_px}
    env = open_env(senses={"vision": vision}, scene={"pose": "sitting"})
    observation, _ = env.reset(seed=0)
    frame = open_film(env, eyes=True).frame(observation)
    assert frame.shape[1] == WIDTH_PX + GAP_PX + round(32 * width_px / height_px)
    assert frame[:32, WIDTH_PX + GAP_PX :].mean() == pytest.approx(observation["eye_left"].mean(), rel=0.1)


def test_eyes_that_the_infant_does_not_use_are_drawn_sharp(open_env, open_film):
    """Without its own head in the way."""
    frames = []
    for senses in ({}, {"vision": {"width_px": 32, "height_px": 32, "acuity": "off", "supersample": 2}}):
        env = open_env(senses=senses, scene={"pose": "sitting"})
        observation, _ = env.reset(seed=0)
        frames.append(open_film(env, eyes=True).frame(observation))
    assert np.array_equal(*frames)


def test_an_infant_without_eyes_shows_nothing_of_their_view(open_env):
    env = open_env(body={"remove": ["left_eye", "right_eye"]})
    with pytest.raises(RenderingError, match="'infant' has no eyes"):
        VideoFrames(env, HEIGHT_PX, eyes=True)


def test_an_infant_stays_in_the_picture_while_the_camera_hardly_moves(open_env, open_film):
    """It falls over, and is thrown far away."""
    env = open_env(scene={"pose": "standing"})
    observation, _ = env.reset(seed=0)
    film = open_film(env)
    first, moves_m = None, []
    for step in range(40):
        film.frame(observation)
        assert shows(film.shot, film.camera.spheres(env.unwrapped.data), film.camera.aspect)
        first = film.shot if first is None else first
        moves_m.append(np.linalg.norm(film.shot.position_m - first.position_m))
        if step == 20:
            env.data.qvel[0] = 5.0
        for _ in range(4):
            observation, *_ = env.step(env.action_space.low)
    assert max(moves_m[:5]) == 0
    assert moves_m[-1] > 0.5


def test_another_episode_is_a_cut(open_env, open_film):
    env = open_env()
    observation, _ = env.reset(seed=0)
    film = open_film(env)
    first = film.frame(observation)
    env.data.qvel[0] = 20.0
    for _ in range(30):
        observation, *_ = env.step(env.action_space.low)
    film.frame(observation)
    observation, _ = env.reset(seed=0)
    assert np.array_equal(film.frame(observation), first)


def test_an_infant_that_grows_is_shown_as_it_is_then(open_film):
    """Its model is another one, and so are the cameras of the film, from where they were."""
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "infant", "age_months": 3, "senses": {}})
    with closing(mimoc.make(spec).unwrapped) as env:
        env.reset(seed=0)
        film = open_film(env)
        before, shot = film.frame({}), film.shot
        env.grow(to=24)
        env.model.vis.quality.shadowsize = 0
        grown, anew = film.frame({}), open_film(env)
        anew.shot = shot
        assert np.array_equal(grown, anew.frame({}))
        assert not np.array_equal(grown, before)
