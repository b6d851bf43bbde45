"""Pages of recordings: what they show is what was recorded."""

from collections.abc import Iterator
from io import BytesIO

import av
import mujoco
import numpy as np
import pytest
from support.pages import few_ages, read_page

import mimoc
from mimoc.base.errors import RecordingError
from mimoc.viewer import episode_page as replayed
from mimoc.viewer.episode_page import describe_episode, page_of_recording

STEPS = 30
SENSES = {
    "proprioception": {},
    "touch": {"density": 0.2},
    "vision": {"width_px": 16, "height_px": 16},
}


@pytest.fixture(scope="module", autouse=True)
def pages_of_few_ages() -> Iterator[None]:
    with few_ages():
        yield


@pytest.fixture(scope="module")
def recorded(tmp_path_factory) -> tuple[mimoc.recording.reading.ReadRecording, np.ndarray]:
    """Return a recording of two episodes, and the states in the first, shape (STEPS + 1, nq)."""
    spec = {"mimoc": 1, "name": "recorded", "age_months": 9, "senses": SENSES, "scene": {"pose": "supine"}}
    spec |= {"delays": {"preset": "physiological"}}
    folder, states = tmp_path_factory.mktemp("recordings") / "short", []
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(spec)), folder) as env:
        env.reset(seed=3)
        states.append(env.unwrapped.data.qpos.copy())
        for step in range(STEPS):
            if step == 10:
                env.unwrapped.grow(to=10)
                env.unwrapped.set_expression("surprised")
            env.step(env.action_space.sample())
            states.append(env.unwrapped.data.qpos.copy())
        env.reset(seed=4)
        env.step(env.action_space.sample())
    return mimoc.read_recording(folder), np.stack(states)


@pytest.fixture(scope="module")
def known(recorded) -> dict:
    page, difference = page_of_recording(recorded[0])
    assert difference is None
    return read_page(page)["recording"]


def test_it_moves_as_it_was_recorded_and_grows_when_it_grew(known, recorded):
    assert np.abs(known["qpos"] - recorded[1]).max() < 1e-6
    assert known["frame_ages_months"].tolist() == [9] * 11 + [10] * (STEPS - 10)
    assert known["seconds"][-1] == pytest.approx(recorded[0][0].time_s[-1])


def test_its_face_changes_when_it_changed(known):
    shown = [known["expressions"]["names"][index] for index in known["expressions"]["shown"]]
    assert shown == ["neutral"] * 11 + ["surprised"] * (STEPS - 10)


def test_touch_is_what_was_observed(known, recorded):
    observed = recorded[0][0].observation("touch").reshape(STEPS + 1, -1, 3)
    sizes_n = np.linalg.norm(observed, axis=2)
    felt = known["felt"]
    for frame in range(STEPS + 1):
        part = slice(felt["ends"][frame], felt["ends"][frame + 1])
        shown_n = np.zeros(sizes_n.shape[1])
        shown_n[felt["points"][part]] = felt["forces_n"][part]
        assert shown_n == pytest.approx(sizes_n[frame], rel=1e-6)
    assert sizes_n.max() > 0
    (curve,) = (curve for curve in known["curves"] if curve["name"] == "touch")
    assert curve["high"] == pytest.approx([sizes_n.sum(axis=1).max()], rel=1e-6)
    assert "self-touch on both sides" in curve["layout"][0]


def test_curves_are_all_numbers_to_a_share_of_their_range(known, recorded):
    episode = recorded[0][0]
    curves = {curve["name"]: curve for curve in known["curves"]}
    assert list(curves) == ["action", "reward", "proprioception", "touch"]
    for name, expected in (
        ("action", episode.column("action")[1:]),
        ("proprioception", episode.observation("proprioception")[1:]),
    ):
        curve = curves[name]
        assert tuple(curve["layout"]) == episode.layout(name)
        spans = curve["high"] - curve["low"]
        found = curve["low"] + (curve["levels"].T + 32768.0) / 65535 * spans
        assert (np.abs(found[1:] - expected) <= 1e-4 * spans + 1e-6).all()


def test_eyes_show_a_video_of_what_was_seen(known, recorded):
    assert set(known["pictures"]) == {"eye_left", "eye_right"}
    with av.open(BytesIO(known["pictures"]["eye_left"].tobytes())) as video:
        shown = np.stack([frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)])
    seen = recorded[0][0].observation("eye_left")
    assert shown.shape == seen.shape
    assert np.abs(shown.astype(int) - seen).mean() < 8


def test_long_episodes_have_fewer_frames_of_the_same_duration(recorded, monkeypatch, known):
    monkeypatch.setattr(replayed, "FRAMES", 12)
    data, *_ = describe_episode(recorded[0], recorded[0][0])
    short = data["recording"]
    assert short["stride"] == 3
    assert np.array_equal(short["qpos"].astype(np.float32), known["qpos"][::3])


def test_another_episode_can_be_chosen_and_one_that_is_not_there_is_refused(recorded):
    another = read_page(page_of_recording(recorded[0], number=1)[0])["recording"]
    assert (another["episode"], len(another["seconds"])) == (1, 2)
    with pytest.raises(RecordingError, match="there is nothing recorded of episode 7"):
        page_of_recording(recorded[0], number=7)


def test_a_replay_that_differs_says_where(recorded, monkeypatch):
    step = mujoco.mj_step

    def differently(model, data, nstep=1):
        data.qvel[0] += 1e-3
        step(model, data, nstep)

    monkeypatch.setattr(mujoco, "mj_step", differently)
    _, difference, _ = describe_episode(recorded[0], recorded[0][0])
    assert difference.startswith("infant 0, episode 0, step ")
