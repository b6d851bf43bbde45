"""What is recorded is what was done and sensed, and all of it comes out again."""

import sys
import warnings
from threading import Event

import gymnasium
import numpy as np
import pyarrow.parquet as pq
import pytest
from support.forks import status_of_fork

import mimoc
from mimoc.base.errors import MissingExtraError, RecordingError, UnknownNameError
from mimoc.recording.columns import KEY, Described
from mimoc.recording.observer import WAITING, Writer

SPEC = {
    "mimoc": 1,
    "name": "reaching",
    "age_months": 18,
    "senses": {"proprioception": {"include": ["velocity"]}, "vestibular": {}, "touch": {"density": 0.5}},
    "task": {"kind": "reach", "steps": 12},
}
DISTURBED = {
    "delays": {"preset": "physiological"},
    "noise": {"motor": 0.1, "proprioception_deg": 1.0, "touch_n": 0.05, "delay_jitter_ms": 5},
}
ACTIONS = np.random.default_rng(0).uniform(-1, 1, (30, 8)).astype(np.float32)


@pytest.fixture(scope="module")
def reaching() -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate(SPEC)


@pytest.fixture(scope="module")
def disturbed() -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate(SPEC | DISTURBED)


def replayed(folder, **options) -> list[str]:
    return [str(each) for each in mimoc.replay_recording(folder, **options) if each.difference]


@pytest.fixture(scope="module")
def lived(reaching, tmp_path_factory):
    """Return the folder of a recording of two episodes, and all that was told during them."""
    folder, told = tmp_path_factory.mktemp("recordings") / "lived", []
    with mimoc.Recorder(mimoc.make(reaching), folder, part_rows=5, states_every=6) as env:
        for seed in (3, None):
            told.append([env.reset(seed=seed)])
            for action in ACTIONS[:12]:
                told[-1].append(env.step(action))
    return folder, told


def test_every_number_is_what_step_returned(lived):
    folder, told = lived
    for episode, (first, *steps) in zip(mimoc.read_recording(folder), told, strict=True):
        assert episode.steps == 12
        for name, readings in episode.observations.items():
            seen = np.stack([first[0][name], *(step[0][name] for step in steps)])
            assert (readings.dtype, readings.tobytes()) == (seen.dtype, seen.tobytes())
        assert np.array_equal(episode.actions, ACTIONS[:12])
        assert episode.rewards.tolist() == [step[1] for step in steps]
        assert episode.truncated.tolist() == [step[3] for step in steps]
        for name, values in episode.reward_terms.items():
            assert values.tolist() == [step[4]["reward_terms"][name] for step in steps]
        assert episode.infos["is_success"].tolist() == [step[4]["is_success"] for step in steps]


def test_the_file_names_every_number_with_its_unit(lived):
    folder, _ = lived
    env = mimoc.make(mimoc.read_recording(folder).bundle())
    metadata = pq.read_schema(folder / "episodes" / "0000-000000.parquet").metadata
    described = {reading.name: reading.layout for reading in Described.from_json(metadata[KEY]).readings}
    assert described == {name: env.unwrapped.layout(name) for name in ("proprioception", "vestibular", "touch")}


def test_an_episode_says_how_it_began_and_ended(lived):
    first, second = mimoc.read_recording(lived[0])
    assert (first.seed, second.seed, first.ended, second.ended) == (3, None, "truncated", "truncated")
    assert first.versions["mimoc"] == mimoc.__version__
    assert sorted(first.states) == [6, 12]


def test_everything_comes_out_again_even_a_later_episode_alone(lived):
    assert replayed(lived[0]) == []
    assert replayed(lived[0], episode=1) == []


def test_a_recorded_state_goes_on_as_it_did(lived):
    recording = mimoc.read_recording(lived[0])
    env = mimoc.make(recording.bundle()).unwrapped
    env.set_state(recording[1].states[6])
    for step in range(6, 12):
        observation, *_ = env.step(ACTIONS[step])
        assert observation["touch"].tobytes() == recording[1].observations["touch"][step + 1].tobytes()


def test_tables_are_ready_for_pandas(lived):
    """Columns of one length, each with a name of its own that ends in its unit."""
    recording = mimoc.read_recording(lived[0])
    columns = recording[0].columns()
    assert {array.shape for array in columns.values()} == {(13,)}
    assert any(name.endswith("angle [rad]") for name in columns)
    assert not any(name.startswith("touch") for name in columns)
    assert len(recording[0].columns("touch")) > recording[0].observations["touch"].shape[1]
    assert recording.summary()["steps"] == [12, 12]
    with pytest.raises(UnknownNameError, match="'tuch' is not a recorded observation; did you mean 'touch'"):
        recording[0].observation("tuch")


def test_noise_jitter_and_growth_come_out_again(disturbed, tmp_path):
    """Grown in the midst of an episode, by a wrapper, and by the option of a reset."""
    env = mimoc.Recorder(mimoc.make(disturbed), tmp_path / "grown")
    growing = mimoc.GrowthWrapper(env, lambda done: 18.0 + done // 4 / 4)
    growing.reset(seed=1)
    for action in ACTIONS[:10]:
        growing.step(action)
    env.unwrapped.grow(to=6)
    env.step(ACTIONS[10])
    env.reset(options={"age_months": 9.5})
    env.step(ACTIONS[11])
    growing.close()
    first, second = mimoc.read_recording(tmp_path / "grown")
    assert first.infos["age_months"][[0, 5, 9, 10]].tolist() == [18, 18.25, 18.5, 6]
    assert second.options == {"age_months": 9.5}
    assert replayed(tmp_path / "grown") == []


def test_what_is_done_besides_steps_comes_out_again(reaching, tmp_path):
    """A state set back, a push, an expression, a wrapper that was there first, actions of another type."""
    with mimoc.Recorder(mimoc.make(reaching, max_episode_steps=11), tmp_path / "done") as env:
        infant = env.unwrapped
        env.reset(seed=5)
        state = infant.get_state()
        for action in ACTIONS[:3]:
            env.step(action)
        infant.data.qvel[2] += 0.5
        env.step(ACTIONS[3].astype(float) / 3)
        infant.set_state(state)
        infant.set_expression("sad")
        for action in ACTIONS[:7]:
            _, _, _, truncated, _ = env.step(action)
        assert truncated
        infant.set_state(state)
        env.step(ACTIONS[0])
        env.reset()
    episodes = mimoc.read_recording(tmp_path / "done")
    assert [what for _, told in sorted(episodes[0].changes.items()) for what, _ in told] == [
        "physics",
        "action_dtype",
        "state",
        "expression",
        "action_dtype",
        "state",
    ]
    assert [(each.steps, each.ended) for each in episodes] == [(12, "reset"), (0, "closed")]
    assert replayed(tmp_path / "done") == []


def test_rooms_of_other_seeds_come_out_again(tmp_path):
    room = {"kind": "room", "toys": {"source": "builtin", "count": [1, 2]}}
    spec = {"mimoc": 1, "name": "room", "age_months": 9, "senses": {"vestibular": {}}, "scene": room}
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(spec)), tmp_path / "rooms") as env:
        for options in ({"scene_seed": 3}, None):
            env.reset(seed=0, options=options)
            env.step(env.action_space.high)
    assert replayed(tmp_path / "rooms") == []


def test_what_eyes_see_is_kept_to_the_pixel(bundle, tmp_path):
    env = mimoc.make(bundle)
    with mimoc.Recorder(env, tmp_path / "seen", part_rows=3) as recorded:
        seen = [recorded.reset(seed=0)[0]["eye_left"]]
        seen += [recorded.step(env.action_space.high)[0]["eye_left"] for _ in range(7)]
    (episode,) = mimoc.read_recording(tmp_path / "seen")
    assert np.array_equal(episode.observation("eye_left"), seen)
    names = sorted(path.name for path in (tmp_path / "seen" / "episodes").glob("*eye_right*"))
    assert names == [f"0000-000000{part}.eye_right.mkv" for part in (".0001", ".0002", "")]
    assert replayed(tmp_path / "seen") == []


def test_the_same_seed_gives_the_same_bytes(bundle, tmp_path):
    folders = tmp_path / "one", tmp_path / "other"
    for folder in folders:
        with mimoc.Recorder(mimoc.make(bundle), folder) as env:
            for seed in (0, None):
                env.reset(seed=seed)
                env.step(env.action_space.high)
    one, other = ({path.name: path.read_bytes() for path in (folder / "episodes").iterdir()} for folder in folders)
    assert {".json", ".mkv", ".parquet"} == {name[name.rindex(".") :] for name in one}
    assert one == other
    assert replayed(folders[0]) == []


def test_water_of_the_bundle_is_no_object_of_a_script(tmp_path):
    bath = {"name": "bath", "kind": "water", "depth_cm": 30}
    spec = {"mimoc": 1, "name": "x", "age_months": 6, "scene": {"objects": [bath], "start_at": "bath"}}
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(spec)), tmp_path / "wet") as env:
        env.reset(seed=0)
        env.step(env.action_space.high)
    assert replayed(tmp_path / "wet") == []


def test_infants_side_by_side_are_recorded_as_if_each_were_alone(disturbed, tmp_path):
    """Of two ages, with resets in between."""
    ages = [disturbed, disturbed.with_(age_months=12)]
    with mimoc.Recorder(mimoc.make_vec(ages, autoreset_mode="SameStep"), tmp_path / "many") as envs:
        envs.reset(seed=7)
        for action in ACTIONS[:20]:
            envs.step(np.stack([action, -action]))
    many = mimoc.read_recording(tmp_path / "many")
    assert [(each.infant, each.number, each.steps) for each in many] == [(0, 0, 12), (0, 1, 8), (1, 0, 12), (1, 1, 8)]
    assert replayed(tmp_path / "many") == []
    with mimoc.Recorder(mimoc.make(ages[1]), tmp_path / "alone") as env:
        env.reset(seed=8)
        for action in ACTIONS[:12]:
            env.step(-action)
    (alone,) = mimoc.read_recording(tmp_path / "alone")
    assert alone.observations["touch"].tobytes() == many.of_infant(1)[0].observations["touch"].tobytes()


def test_a_copy_of_an_infant_is_not_recorded(lived, reaching, tmp_path):
    import copy

    with mimoc.Recorder(mimoc.make(reaching), tmp_path / "original") as env:
        env.reset(seed=0)
        copy.deepcopy(env.unwrapped).step(ACTIONS[0])
        env.step(ACTIONS[1])
    (episode,) = mimoc.read_recording(tmp_path / "original")
    assert np.array_equal(episode.actions, ACTIONS[1:2])


def test_a_recording_is_continued_by_the_same_infant_alone(reaching, tmp_path):
    for seed in (0, 1):
        with mimoc.Recorder(mimoc.make(reaching), tmp_path / "kept") as env:
            env.reset(seed=seed)
            env.step(ACTIONS[0])
    before = {path: path.read_bytes() for path in (tmp_path / "kept").rglob("*") if path.is_file()}
    with pytest.raises(RecordingError, match=r"kept: the recording here is of another bundle \('reaching', "):
        mimoc.Recorder(mimoc.make(reaching.with_(age_months=12)), tmp_path / "kept")
    with pytest.raises(RecordingError, match="of 1 infants side by side, not 2"):
        mimoc.Recorder(mimoc.make_vec(reaching, num_envs=2), tmp_path / "kept")
    assert [each.seed for each in mimoc.read_recording(tmp_path / "kept")] == [0, 1]
    assert before == {path: path.read_bytes() for path in before}


def test_what_a_recording_is_not_written_into(reaching, tmp_path):
    env = mimoc.make(reaching)
    (tmp_path / "letter.txt").write_text("dear")
    with pytest.raises(RecordingError, match="the folder is not empty and no recording"):
        mimoc.Recorder(env, tmp_path)
    with pytest.raises(RecordingError, match=r"letter\.txt: this is a file"):
        mimoc.Recorder(env, tmp_path / "letter.txt")
    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]
    with mimoc.Recorder(env, tmp_path / "one"), pytest.raises(RecordingError, match="is being recorded already"):
        mimoc.Recorder(env, tmp_path / "two")
    other = mimoc.make(reaching)
    env = mimoc.make(reaching)
    with mimoc.Recorder(env, tmp_path / "one"), pytest.raises(RecordingError, match="another process is recording"):
        mimoc.Recorder(other, tmp_path / "one")
    with pytest.raises(TypeError, match=r"Recorder: expected an environment of mimoc's .*, got CartPoleEnv"):
        mimoc.Recorder(gymnasium.make("CartPole-v1"), tmp_path / "three")
    with pytest.raises(RecordingError, match="part_rows must be a positive whole number, not 0"):
        mimoc.Recorder(env, tmp_path / "four", part_rows=0)


class Stillness(mimoc.Task):
    """A task of a script's own."""

    def judge(self, data, action, effort):
        return mimoc.Verdict({"stillness": -float(np.abs(data.qvel).sum())})


def test_objects_of_a_script_are_said_and_asked_for(reaching, tmp_path):
    with pytest.warns(UserWarning, match="task is an object of a script's own .*Stillness"):
        recorder = mimoc.Recorder(mimoc.make(reaching, task=Stillness(steps=4)), tmp_path / "own")
    with recorder as env:
        env.reset(seed=0)
        for action in ACTIONS[:4]:
            env.step(action)
    with pytest.raises(RecordingError, match="recorded with task of a script's own"):
        mimoc.replay_recording(tmp_path / "own")
    assert replayed(tmp_path / "own", task=Stillness(steps=4)) == []


def test_without_pyav_the_blind_are_recorded_all_the_same(reaching, bundle, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(MissingExtraError, match=r"^av is not installed; run: pip install 'mimoc\[record\]'$"):
        mimoc.Recorder(mimoc.make(bundle), tmp_path / "seeing")
    with warnings.catch_warnings(), mimoc.Recorder(mimoc.make(reaching), tmp_path / "blind") as env:
        env.reset(seed=0)
    assert not (tmp_path / "seeing").exists()


@pytest.mark.full
def test_what_cannot_be_written_is_said_once_and_the_rest_is_kept(reaching, tmp_path):
    env = mimoc.Recorder(mimoc.make(reaching), tmp_path / "full", part_rows=2)
    env.reset(seed=0)
    for action in ACTIONS[:12]:
        env.step(action)
    env.recording.wait()
    (tmp_path / "full" / "episodes").rename(tmp_path / "full" / "moved")
    env.reset()
    with pytest.raises(mimoc.MimocError, match="cannot be written"):
        env.close()
    env.close()
    (tmp_path / "full" / "moved").rename(tmp_path / "full" / "episodes")
    assert [each.steps for each in mimoc.read_recording(tmp_path / "full")] == [12]


def test_a_push_is_kept_whatever_is_done_after_it(reaching, tmp_path):
    with mimoc.Recorder(mimoc.make(reaching), tmp_path / "pushed") as env:
        env.reset(seed=0)
        env.step(ACTIONS[0])
        env.unwrapped.data.qvel[:] += 0.1
        env.unwrapped.set_arousal(0.5)
        env.step(ACTIONS[1])
    (episode,) = mimoc.read_recording(tmp_path / "pushed")
    assert sorted(what for what, _ in episode.changes[1]) == ["arousal", "physics"]
    assert replayed(tmp_path / "pushed") == []


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_forked_process_writes_nothing_and_waits_for_nobody():
    """Though so many jobs were waiting when it was forked that its process would have had to wait."""
    writer, may_go_on, done = Writer(), Event(), []
    writer(lambda: may_go_on.wait(60) and None)
    for number in range(WAITING):
        writer(lambda number=number: done.append(number))

    def use() -> None:
        writer(lambda: done.append("child"))
        writer.drain()
        writer.close()
        assert done == []

    assert status_of_fork(use) == 0
    may_go_on.set()
    writer.close()
    assert done == list(range(WAITING))
