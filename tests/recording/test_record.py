"""Videos of infants, with what their eyes see beside them, and the sound that reaches their ears."""

import sys
import wave
from contextlib import closing
from fractions import Fraction

import av
import gymnasium
import numpy as np
import pytest
from support import store
from support.worlds import ANNA, BEN, world

import mimoc
from mimoc.base.errors import MissingExtraError, OutputError, RenderingError, UnknownNameError
from mimoc.policies.named import policy_of
from mimoc.policies.rollout import Run
from mimoc.recording import video
from mimoc.recording.record import GAP_PX, VideoFrames, film_of
from mimoc.recording.video import check_video, open_video
from mimoc.render.camera import shows

SIZE = {"height_px": 64}


def stopping(error, after: int):
    def make(env):
        act, taken = policy_of(env, "random"), iter(range(after))

        def policy(generator, observation):
            if next(taken, None) is None:
                raise error
            return act(generator, observation)

        return policy

    return make


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_a_film_lasts_as_long_as_what_it_shows(name, env, tmp_path, watch):
    """A picture at the start, and one every 40 ms."""
    told = []
    summary = mimoc.record(env, "random", tmp_path / name, steps=40, **SIZE, progress=lambda *done: told.append(done))
    seen, ends_s = watch(tmp_path / name)
    assert seen.shape == (11, 64, 86 if name == "film.mp4" else 85, 3)
    assert ends_s[-1] == pytest.approx(0.44)
    assert (seen[1:] != seen[:-1]).any(axis=(1, 2, 3)).all()
    assert told == [(step, 40) for step in range(1, 41)]
    assert summary.steps == 40


def test_there_is_at_most_a_picture_each_step(env, tmp_path, watch):
    mimoc.record(env, "zero", tmp_path / "film.mp4", steps=5, rate_hz=1000, **SIZE)
    seen, ends_s = watch(tmp_path / "film.mp4")
    assert len(seen) == 6
    assert ends_s[-1] == pytest.approx(0.06)


def test_the_eyes_view_is_beside_it(env, tmp_path, watch):
    mimoc.record(env, "zero", tmp_path / "film.gif", steps=4, eyes=True, **SIZE)
    assert watch(tmp_path / "film.gif")[0].shape[1:] == (64, 85 + 4 + 30, 3)


def test_filming_changes_nothing_of_what_happens(env, bundle, tmp_path):
    filmed = mimoc.record(mimoc.make(bundle), "random", tmp_path / "film.gif", steps=8, seed=3, **SIZE)
    run = Run(env, "random", 3)
    for _ in range(8):
        run.step()
    alone = run.summary()
    assert (filmed.hip_path_m, filmed.joint_speed_rad_s) == (alone.hip_path_m, alone.joint_speed_rad_s)


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_control_c_keeps_what_was_filmed(name, env, tmp_path, watch):
    with pytest.raises(KeyboardInterrupt):
        mimoc.record(env, stopping(KeyboardInterrupt(), 12), tmp_path / name, steps=1000, **SIZE)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert len(watch(tmp_path / name)[0]) == 4


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_an_error_leaves_nothing_and_what_was_there(name, env, tmp_path):
    (tmp_path / name).write_bytes(b"older")
    with pytest.raises(ZeroDivisionError):
        mimoc.record(env, stopping(ZeroDivisionError(), 12), tmp_path / name, steps=1000, **SIZE)
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [(name, b"older")]


def test_bad_names_are_refused_before_anything_runs(env, tmp_path):
    with pytest.raises(OutputError, match=r"film\.webm: not a supported video format"):
        mimoc.record(env, stopping(AssertionError(), 0), tmp_path / "film.webm")
    with pytest.raises(UnknownNameError, match="'rnadom' is not a policy"):
        mimoc.record(env, "rnadom", tmp_path / "film.gif")
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_written_is_one_clear_error(env):
    with pytest.raises(OutputError, match=r"^/proc/film\.(gif|mp4): cannot be written "):
        mimoc.record(env, "zero", "/proc/film.gif", steps=1, **SIZE)
    with pytest.raises(OutputError, match=r"^/proc/film\.(gif|mp4): cannot be written "):
        mimoc.record(env, "zero", "/proc/film.mp4", steps=1, **SIZE)


def test_only_infants_are_filmed(tmp_path):
    with pytest.raises(TypeError, match="record: expected an environment of mimoc's on the CPU, got CartPoleEnv"):
        mimoc.record(gymnasium.make("CartPole-v1"), "zero", tmp_path / "film.gif")


def test_pictures_follow_each_other_in_real_time(env, tmp_path, watch):
    """At 30 pictures a second of an infant that acts 100 times a second."""
    mimoc.record(env, "random", tmp_path / "film.mp4", steps=50, rate_hz=30, **SIZE)
    seen, ends_s = watch(tmp_path / "film.mp4")
    assert len(seen) == 16
    assert np.diff(ends_s) == pytest.approx(np.full(15, 1 / 30), abs=1e-3)


@pytest.fixture(scope="module")
def pair():
    return world(anna=ANNA, ben=BEN)


def test_a_film_of_a_world_shows_all_and_one_of_a_batch_shows_rows(pair, tmp_path, watch):
    """Each world in one picture, and worlds beside each other."""
    alone = SIZE["height_px"] * 4 // 3
    with closing(mimoc.make_parallel(pair)) as env:
        several = mimoc.record(env, {"anna": "random"}, tmp_path / "world.gif", steps=8, **SIZE)
    with closing(mimoc.make_vec(pair, num_envs=4)) as envs:
        rows = mimoc.record(envs, "zero", tmp_path / "batch.gif", steps=8, **SIZE)
    assert {name: summary.steps for name, summary in several.items()} == {"anna": 8, "ben": 8}
    assert several["anna"].measures["joint_speed_rad_s"] > several["ben"].measures["joint_speed_rad_s"]
    assert [*rows] == ["0", "1", "2", "3"]
    one, two = watch(tmp_path / "world.gif")[0], watch(tmp_path / "batch.gif")[0]
    assert one.shape == (3, SIZE["height_px"], alone, 3)
    assert two.shape[0] == 3
    assert two.shape[2] > 2 * alone


def test_whose_eyes_a_film_has_is_chosen_by_name(pair, tmp_path):
    with closing(mimoc.make_parallel(pair)) as env:
        films = {}
        for infant in (None, "anna", "ben"):
            file = tmp_path / f"{infant}.gif"
            mimoc.record(env, "zero", file, steps=1, eyes=True, infant=infant, **SIZE)
            films[infant] = file.read_bytes()
        with pytest.raises(UnknownNameError, match="'bem' is not a name of an infant of this environment; did you"):
            mimoc.record(env, "zero", tmp_path / "bem.gif", infant="bem")
    assert films[None] == films["anna"] != films["ben"]


STEPS = 30


def filmed(file, **hearing) -> np.ndarray:
    data = {"mimoc": 1, "name": "x", "age_months": 6, "senses": {"hearing": {"thresholds": "off", **hearing}}}
    observed = []
    with closing(mimoc.make(store.built(data)).unwrapped) as env:
        observation, _ = env.reset(seed=0)
        with film_of(file, env.manifest.step_ms, height_px=48) as film:
            film({"": env}, {"": observation})
            for number in range(STEPS):
                if number == 20:
                    env.reset()
                observation = env.step(np.full(env.action_space.shape, 0.3, np.float32))[0]
                film({"": env}, {"": observation})
                observed.append(observation["hearing"])
    return np.concatenate(observed, axis=1)


def read(file) -> tuple[int, np.ndarray]:
    with wave.open(str(file)) as opened:
        samples = np.frombuffer(opened.readframes(opened.getnframes()), "<i2").reshape(-1, opened.getnchannels())
        return opened.getframerate(), samples


@pytest.mark.parametrize("rate_hz", [24_000, 16_000])
def test_the_wav_beside_a_video_is_what_the_ears_got(rate_hz, tmp_path):
    observed = filmed(tmp_path / "f.gif", output="waveform", sample_rate_hz=rate_hz)
    framerate, samples = read(tmp_path / "f.wav")
    assert framerate == rate_hz
    assert samples.shape == (STEPS * rate_hz // 100, 2)
    wanted = observed.T / np.abs(observed).max() * 32_000
    assert np.abs(samples - wanted).max() < 1


def test_infants_that_observe_bands_have_the_same_sound(tmp_path):
    filmed(tmp_path / "bands.gif", output="cochleagram")
    filmed(tmp_path / "waves.gif", output="waveform")
    assert (read(tmp_path / "bands.wav")[1] == read(tmp_path / "waves.wav")[1]).all()


def test_an_mp4_has_the_sound_as_its_track(tmp_path):
    filmed(tmp_path / "f.mp4", output="waveform")
    with av.open(str(tmp_path / "f.mp4")) as container:
        track = container.streams.audio[0]
        frames = np.concatenate([frame.to_ndarray() for frame in container.decode(track)], axis=1)
    samples = read(tmp_path / "f.wav")[1].T / 32768
    assert track.rate == 24_000
    assert frames.shape[1] >= samples.shape[1]
    products = np.correlate(frames[0], samples[0], "valid")  # The codec begins with silence of its own.
    assert products.max() > 0.9 * np.linalg.norm(frames[0]) * np.linalg.norm(samples[0])


def test_one_that_does_not_hear_has_none(tmp_path):
    bundle = store.built({"mimoc": 1, "name": "x", "age_months": 6, "senses": {"vestibular": {}}})
    with closing(mimoc.make(bundle)) as env:
        mimoc.record(env, "zero", tmp_path / "f.gif", steps=4, height_px=48)
    assert [path.name for path in tmp_path.iterdir()] == ["f.gif"]


def test_of_a_world_it_is_the_sound_of_the_infant_that_is_named_or_hears_first(tmp_path):
    deaf = {"mimoc": 1, "name": "x", "age_months": 6, "senses": {"vestibular": {}}}
    hearing = {**deaf, "senses": {"hearing": {"output": "levels"}}, "actuation": {"voice": True}}
    with closing(mimoc.make_parallel(world(anna=deaf, ben=hearing))) as env:
        for infant in ("anna", "ben", None):
            mimoc.record(env, "random", tmp_path / f"{infant}.gif", steps=4, height_px=48, infant=infant)
    assert sorted(path.name for path in tmp_path.glob("*.wav")) == ["None.wav", "ben.wav"]
    assert (read(tmp_path / "None.wav")[1] == read(tmp_path / "ben.wav")[1]).all()


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


def pictures(count: int, height: int = 48, width: int = 64) -> list[np.ndarray]:
    found = np.full((count, height, width, 3), 40, np.uint8)
    for number, picture in enumerate(found):
        picture[:, 8 * number % width :][:, :8] = (230, 60, 120)
    return list(found)


def write(path, shown, rate_hz=25):
    film = open_video(path, Fraction(rate_hz))
    for picture in shown:
        film.add(picture)
    return film.save()


@pytest.mark.parametrize("name", ["film.mp4", "film.gif", "FILM.GIF"])
def test_what_is_read_is_what_was_written(name, tmp_path, watch):
    """In this order, for as long, and nearly in these colours."""
    shown = pictures(7)
    file = write(tmp_path / name, shown)
    seen, ends_s = watch(file.rename(tmp_path / name.lower()))
    assert seen.shape == (7, 48, 64, 3)
    assert ends_s == pytest.approx([0.04 * number for number in range(1, 8)])
    assert np.abs(seen.astype(int) - shown).mean() < 4
    assert all(not np.array_equal(one, other) for one, other in zip(seen[1:], seen, strict=False))
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize("rate_hz", [7, 12, 30, 60])
def test_a_gif_keeps_time_at_any_rate(rate_hz, tmp_path, watch):
    """To the hundredth of a second that it can say, also in the long run."""
    _, ends_s = watch(write(tmp_path / "film.gif", pictures(40), rate_hz))
    assert ends_s == pytest.approx([number / rate_hz for number in range(1, 41)], abs=0.0051)


@pytest.mark.parametrize("size", [(47, 63), (33, 18)])
def test_odd_sizes_are_made_even_for_mp4(size, tmp_path, watch):
    seen, _ = watch(write(tmp_path / "film.mp4", pictures(3, *size)))
    assert seen.shape == (3, size[0] + size[0] % 2, size[1] + size[1] % 2, 3)


@pytest.mark.parametrize("codec", video.CODECS)
def test_each_codec_gives_an_mp4(codec, tmp_path, watch, monkeypatch):
    monkeypatch.setattr(video, "CODECS", (codec,))
    assert len(watch(write(tmp_path / "film.mp4", pictures(5)))[0]) == 5


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_a_film_that_is_discarded_leaves_what_was_there(name, tmp_path):
    (tmp_path / name).write_bytes(b"older")
    film = open_video(tmp_path / name, Fraction(25))
    film.add(pictures(1)[0])
    film.discard()
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [(name, b"older")]


@pytest.mark.parametrize("name", ["film.avi", "film", "film.mp4.txt", ".gif"])
def test_other_names_are_no_videos(name, tmp_path):
    with pytest.raises(OutputError, match=r"not a supported video format; end the name in \.mp4 or \.gif$"):
        check_video(tmp_path / name)


def test_a_video_needs_a_folder_and_is_none(tmp_path):
    (tmp_path / "film.gif").mkdir()
    with pytest.raises(OutputError, match=r"film\.gif: this is a folder"):
        check_video(tmp_path / "film.gif")
    with pytest.raises(OutputError, match="there is no folder"):
        check_video(tmp_path / "nowhere" / "film.gif")


def test_without_pyav_there_are_only_gifs(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(MissingExtraError, match=r"^av is not installed; run: pip install 'mimoc\[record\]'$"):
        check_video(tmp_path / "film.mp4")
    assert write(tmp_path / "film.gif", pictures(2)).stat().st_size


def test_a_gif_does_not_grow_without_end(tmp_path, monkeypatch):
    monkeypatch.setattr(video, "MAX_GIF_FRAMES", 3)
    with pytest.raises(OutputError, match=r"a GIF can have at most 3 frames; record fewer steps, or an \.mp4"):
        write(tmp_path / "film.gif", pictures(4))
