"""A video of an infant that hears has what reaches its ears beside it, and in it."""

import wave
from contextlib import closing

import av
import numpy as np
import pytest
from support import store
from support.worlds import world

import mimoc
from mimoc.recording import film_of

STEPS = 30


def filmed(file, **hearing) -> np.ndarray:
    """Return what a hearing infant observes while it is filmed."""
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
