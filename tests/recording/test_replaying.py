"""A replay says which number differs first, and what is damaged; what a kill leaves is read and kept."""

import json
import os
import signal
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from unittest import mock

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as arrays

import mimoc
from mimoc.base.errors import RecordingError
from mimoc.recording import columns as described, video
from mimoc.recording.columns import Sparse, compact_names, expand_names, reading_of
from mimoc.recording.description import from_plain, is_same, to_plain
from mimoc.recording.tables import array_of

SPEC = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"proprioception": {}, "touch": {"density": 0.2}}}
ROWS = 9
HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    """Return the folder of a recording, which is only to be read."""
    folder = tmp_path_factory.mktemp("recordings") / "made"
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(SPEC)), folder, states_every=4) as env:
        env.reset(seed=0)
        for _ in range(ROWS):
            env.step(env.action_space.high)
    return folder


@pytest.fixture
def copied(made, tmp_path) -> Path:
    subprocess.run(["cp", "-r", made, tmp_path / "copy"], check=True)
    return tmp_path / "copy"


def changed(folder: Path, column: str, row: int, index: int, by: float) -> None:
    path = folder / "episodes" / "0000-000000.parquet"
    table = pq.read_table(path)
    array = array_of(table, column).copy()
    array.reshape(len(array), -1)[row, index] += by
    place, kind = table.column_names.index(column), table.schema.field(column)
    values = [each if array.ndim == 1 else each.tolist() for each in array]
    pq.write_table(table.set_column(place, kind, pa.array(values, kind.type)), path)


def test_the_first_different_number_is_named(copied, invoke):
    changed(copied, "observation.proprioception", 7, 2, 0.25)
    changed(copied, "reward", 8, 0, 1.0)
    (replayed,) = mimoc.replay_recording(copied)
    layout = mimoc.read_recording(copied)[0].layout("proprioception")
    difference = replayed.difference
    assert (difference.step, difference.what, difference.name) == (7, "proprioception", f"'{layout[2]}'")
    assert difference.recorded - difference.now == pytest.approx(0.25)
    code, out, err = invoke("replay", copied)
    assert (code, err) == (1, "")
    assert out.startswith(f"infant 0, episode 0, step 7: proprioception '{layout[2]}' was ")
    assert out.endswith("failed: 1 of 1 episode did not come out again\n")


def test_what_is_heard_comes_out_again(tmp_path):
    senses = {"hearing": {"output": "waveform"}}
    spec = {"mimoc": 1, "name": "x", "age_months": 6, "actuation": {"voice": True}, "senses": senses}
    spec["scene"] = {"objects": [{"name": "ball", "at": {"x_cm": 40, "z_cm": 5}}]}
    folder = tmp_path / "heard"
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(spec)), folder, states_every=4) as env:
        env.reset(seed=0)
        for _ in range(ROWS):
            env.step(env.action_space.high)
    (replayed,) = mimoc.replay_recording(folder)
    assert replayed.difference is None


def test_another_action_leads_elsewhere(copied):
    changed(copied, "action", 3, 0, -1.5)
    (replayed,) = mimoc.replay_recording(copied)
    assert replayed.difference.step in (3, 4)


def test_other_versions_are_named_as_a_possible_reason(copied):
    changed(copied, "time_s", 2, 0, 1.0)
    sidecar = copied / "episodes" / "0000-000000.json"
    told = json.loads(sidecar.read_text())
    told["versions"]["mujoco"] = "3.9.0"
    sidecar.write_text(json.dumps(told))
    (replayed,) = mimoc.replay_recording(copied)
    assert "step 2: time_s was 1.02, is 0.02 (by 1); recorded with mujoco 3.9.0, now " in str(replayed)


def test_another_state_is_a_difference(copied):
    sidecar = copied / "episodes" / "0000-000000.json"
    told = json.loads(sidecar.read_text())
    told["states"][1]["state"]["steps"] = 5
    sidecar.write_text(json.dumps(told))
    (replayed,) = mimoc.replay_recording(copied)
    assert (replayed.difference.step, replayed.difference.what, replayed.difference.name) == (8, "state", "steps")


@pytest.mark.parametrize("damage", ["cut", "removed", "no json", "no description", "bundle", "other version"])
def test_a_damaged_recording_is_one_clear_line(damage, copied, invoke):
    episodes = copied / "episodes"
    bundle = next((copied / "bundles").iterdir())
    if damage == "cut":
        os.truncate(episodes / "0000-000000.parquet", 500)
    elif damage == "removed":
        (episodes / "0000-000000.parquet").unlink()
    elif damage == "no json":
        (episodes / "0000-000000.json").write_text("{")
    elif damage == "no description":
        (copied / "recording.json").unlink()
    elif damage == "bundle":
        (bundle / "scene.xml").write_text("<mujoco/>")
    else:
        (copied / "recording.json").write_text('{"recording": 99}')
    code, out, err = invoke("replay", copied)
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert str(copied) in err


EDITS = {
    "recording.json": [("infants", 3), ("infants", [{"name": "infant", "bundle": 3}]), ("marks", [{"run": 3}])],
    "episodes/0000-000000.json": [
        ("rows", "10"),
        ("states", [{"step": 4}]),
        ("changes", [{"step": 1, "physics": [1]}]),
        ("changes", [{"step": 1, "state": {}}]),
        ("reset", {"seed": "x"}),
        ("start", {}),
        ("start", []),
        ("objects", True),
        ("ended", None),
    ],
}


@pytest.mark.parametrize(("file", "key", "value"), [(file, *edit) for file, edits in EDITS.items() for edit in edits])
def test_an_edited_recording_is_one_clear_line(file, key, value, copied, invoke):
    (copied / file).write_text(json.dumps(json.loads((copied / file).read_text()) | {key: value}))
    code, _, err = invoke("replay", copied)
    assert (code, len(err.splitlines())) == (2, 1)
    assert str(copied / file) in err


def test_what_is_not_there_is_not_replayed(made, tmp_path):
    with pytest.raises(RecordingError, match="nothing recorded of infant 3"):
        mimoc.replay_recording(made, infant=3)
    with pytest.raises(RecordingError, match="there is no such folder"):
        mimoc.read_recording(tmp_path / "nowhere")
    with pytest.raises(RecordingError, match=r"this is not a recording, it has no recording\.json"):
        mimoc.read_recording(tmp_path)


ENDLESS = """
import sys, mimoc
from test_replaying import SPEC
env = mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(SPEC), max_episode_steps=9), sys.argv[1], part_rows=4)
env.reset(seed=0)
for step in range(1, 12):
    if env.step(env.action_space.high)[3]:
        env.reset()
env.recording.wait()
for number in range(10**9):
    env.step(env.action_space.high)
    if number == 7:
        env.recording.wait()
        print("there", flush=True)
"""


@pytest.mark.full
def test_a_kill_leaves_whole_episodes_and_the_last_one_to_its_last_part(tmp_path):
    folder = tmp_path / "killed"
    command = [sys.executable, "-c", ENDLESS, folder]
    with subprocess.Popen(command, stdout=subprocess.PIPE, env={**os.environ, "PYTHONPATH": str(HERE)}) as process:
        assert process.stdout.readline() == b"there\n"
        process.send_signal(signal.SIGKILL)
    first, second = mimoc.read_recording(folder)
    assert (first.steps, first.ended) == (9, "reset")
    assert second.ended == "unfinished"
    assert second.steps >= 7
    steps = second.steps
    assert np.isfinite(second.observations["proprioception"]).all()
    assert all(each.difference is None for each in mimoc.replay_recording(folder, episode=0))
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(SPEC)), folder) as env:
        env.reset(seed=1)
    _, second, third = mimoc.read_recording(folder)
    assert (second.steps, second.ended, third.number, third.seed) == (steps, "unfinished", 2, 1)


def test_control_c_loses_nothing(tmp_path):
    env = mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(SPEC)), tmp_path / "stopped")

    def interrupted() -> None:
        with env:
            env.reset(seed=0)
            for _ in range(5):
                env.step(env.action_space.high)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    (episode,) = mimoc.read_recording(tmp_path / "stopped")
    assert (episode.steps, episode.ended) == (5, "closed")


numbers = arrays.arrays(
    st.sampled_from([np.dtype(name) for name in ("f4", "f8", "c16", "i4", "u1", "?")]),
    arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4),
)
states = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | numbers,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(inner, max_size=3).map(tuple)
        | st.dictionaries(st.text() | st.integers(), inner, max_size=3)
    ),
    max_leaves=12,
)


@given(state=states)
def test_a_state_comes_back_from_json_to_the_bit(state):
    again = from_plain(json.loads(json.dumps(to_plain(state), allow_nan=False)))
    assert is_same(state, again)
    assert type(again) is type(state)


def test_states_tell_apart_what_equals():
    assert not is_same(np.array([0.0]), np.array([-0.0]))
    assert not is_same([1.0], (1.0,))
    assert is_same(float("nan"), float("nan"))


@pytest.mark.parametrize("unknown", [object(), {1, 2}, np.array([None])])
def test_what_cannot_be_kept_is_refused(unknown):
    with pytest.raises(RecordingError, match="cannot be kept"):
        to_plain({"task": [unknown]})


@pytest.mark.parametrize("damaged", [{"$array": "AAAA", "dtype": "<f8", "shape": [3]}, {"$float": "x"}, {"$items": 1}])
def test_damaged_states_are_one_clear_error(damaged):
    with pytest.raises(RecordingError, match="damaged"):
        from_plain(damaged)


names = st.builds(
    "{}{}{}".format, st.sampled_from(["hip ", "left 2 ", ""]), st.integers(0, 12), st.sampled_from([" x", " y", ""])
)


@given(layout=st.lists(names | st.text(max_size=3), max_size=14))
def test_any_layout_comes_back_whatever_counts_as_long(layout):
    with mock.patch.object(described, "LONG", 0):
        assert expand_names(json.loads(json.dumps(compact_names(layout)))) == tuple(layout)
    assert expand_names(compact_names(layout)) == tuple(layout)


def test_thousands_of_skin_points_take_few_words(open_env):
    layout = open_env(senses={"touch": {}}).layout("touch")
    assert len(json.dumps(compact_names(layout))) < len(layout)
    assert expand_names(compact_names(layout)) == layout


@given(
    rows=arrays.arrays(
        st.sampled_from([np.dtype("f4"), np.dtype("f8"), np.dtype("i4")]),
        st.tuples(st.integers(1, 3), st.integers(1, 70)),
        fill=st.just(0),
    )
)
def test_a_sparse_row_has_every_number_whose_bits_are_not_zero(rows):
    sparse = Sparse(reading_of("touch", rows[0]), len(rows))
    for number, row in enumerate(rows):
        sparse.put(number, row)
    again = np.zeros_like(rows)
    for number, (start, end) in enumerate(zip(sparse.ends, sparse.ends[1:], strict=False)):
        again[number, sparse.index[start:end]] = sparse.value[start:end]
    assert again.tobytes() == rows.tobytes()


@pytest.mark.parametrize("size", [(17, 33), (1, 1), (24, 1), (1, 24), (3, 2)], ids=str)
def test_pictures_come_back_as_they_were(size, tmp_path):
    """Of odd sizes, from parts of any length."""
    pictures = np.random.default_rng(0).integers(0, 256, (9, *size, 3), np.uint8)
    paths = [tmp_path / "episodes" / f"part{number}.mkv" for number in range(3)]
    paths[0].parent.mkdir()
    for path, part in zip(paths, (pictures[:5], pictures[5:6], pictures[6:]), strict=True):
        video.write_pictures(path, part, Fraction(100))
    assert np.array_equal(video.read_pictures(paths, 9, (*size, 3)), pictures)


@pytest.mark.parametrize("damage", ["empty", "no video", "no text"])
def test_a_damaged_video_is_one_clear_error(damage, tmp_path):
    """Even if its text, such as the name of the library that wrote it, cannot be decoded."""
    path = tmp_path / "episodes" / "eye.mkv"
    path.parent.mkdir()
    video.write_pictures(path, np.zeros((2, 16, 16, 3), np.uint8), Fraction(100))
    written = path.read_bytes()
    path.write_bytes({"empty": b"", "no video": b"no video", "no text": written.replace(b"Lavf", b"\x93avf")}[damage])
    with pytest.raises(RecordingError, match=r"eye\.mkv: the file is damaged"):
        video.read_pictures([path], 2, (16, 16, 3))
