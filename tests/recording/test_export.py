"""Recordings in the formats of others, opened by their own libraries, or by Parquet and JSON."""

import csv
import json
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import av
import minari
import numpy as np
import pyarrow.parquet as pq
import pytest
from support.store import built

import mimoc
from mimoc.base.errors import KindError, MissingExtraError, OutputError, RecordingError, UnknownNameError
from mimoc.recording.reading import ReadRecording
from mimoc.recording.replaying import replay
from mimoc.schema import plugins
from mimoc.schema.kinds import EXPORTERS, ExporterKind

SENSES = {"proprioception": {}, "touch": {"density": 0.3}, "vision": {"width_px": 16, "height_px": 12}}
STEPS = 6
FLOATS = {"float": "float32", "double": "float64"}
"""Names of NumPy's for those of Arrow's."""


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> ReadRecording:
    """Return a recording of two episodes of an infant with all senses, the second of which is cut short."""
    spec = {"mimoc": 1, "name": "all_senses", "age_months": 9, "senses": SENSES, "scene": {"pose": "sitting"}}
    spec |= {"task": {"kind": "selfbody", "steps": STEPS}}
    folder = tmp_path_factory.mktemp("recordings") / "senses"
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(spec)), folder) as env:
        env.action_space.seed(0)
        for steps in (STEPS, STEPS - 2):
            env.reset(seed=steps)
            for _ in range(steps):
                env.step(env.action_space.sample())
    return mimoc.read_recording(folder)


@pytest.fixture(scope="module")
def exported(recording, tmp_path_factory):
    """Return what exports the recording to a format once: the folder, and what is said."""
    done: dict[str, tuple[Path, tuple[str, ...]]] = {}

    def export(to: str) -> tuple[Path, tuple[str, ...]]:
        if to not in done:
            out = tmp_path_factory.mktemp("exported") / to
            done[to] = out, mimoc.export_recording(recording, to, out)
        return done[to]

    return export


def test_minari_loads_what_was_recorded(recording, exported, monkeypatch):
    """Every picture to the pixel."""
    out, notes = exported("minari")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(out))
    data_set = minari.load_dataset("mimoc/all_senses-v0")
    assert (data_set.total_episodes, data_set.total_steps) == (2, 2 * STEPS - 2)
    for ours, theirs in zip(recording, data_set.iterate_episodes(), strict=True):
        for name, array in ours.observations.items():
            assert theirs.observations[name].tobytes() == array.tobytes()
        assert np.array_equal(theirs.actions, ours.actions.astype(np.float32))
        assert np.array_equal(theirs.rewards, ours.rewards)
        speeds = theirs.infos["movement.right_hand_speed_m_s"]
        assert np.array_equal(np.float32(speeds), ours.movement["right_hand_speed_m_s"])
        assert theirs.truncations[-1] != theirs.terminations[-1]
    assert any(note.startswith("1 episode cut short") for note in notes)


def test_minari_recovers_the_environment_that_was_recorded(recording, exported, monkeypatch):
    """The same numbers again, from a data set alone."""
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(exported("minari")[0]))
    env = minari.load_dataset("mimoc/all_senses-v0").recover_environment()
    assert env.spec.max_episode_steps == STEPS
    env.reset(seed=recording[0].seed)
    for step, action in enumerate(recording[0].actions):
        observed = env.step(action)[0]
        for name, array in recording[0].observations.items():
            assert np.array_equal(observed[name], array[step + 1])
    env.close()


def test_lerobot_finds_its_layout(recording, exported):
    """Files, columns, types and shapes as its description says, and rows that are those of the recording."""
    out, notes = exported("lerobot")
    info = json.loads((out / "meta" / "info.json").read_text())
    assert (info["codebase_version"], info["total_episodes"], info["total_frames"]) == ("v3.0", 2, 2 * STEPS - 2)
    rows = pq.read_table(out / info["data_path"].format(chunk_index=0, file_index=0))
    numbers = {name: each for name, each in info["features"].items() if each["dtype"] != "video"}
    assert set(rows.column_names) == set(numbers)
    for name, feature in numbers.items():
        kind = rows.schema.field(name).type
        size = getattr(kind, "list_size", 1)
        dtype = str(getattr(kind, "value_type", kind))
        assert ([size], FLOATS.get(dtype, dtype)) == (feature["shape"], feature["dtype"])
        assert feature["names"] is None or len(feature["names"]) == size
    assert rows["index"].to_pylist() == list(range(2 * STEPS - 2))
    states = np.stack(rows["observation.state"].to_numpy())
    assert np.array_equal(states[:STEPS], recording[0].observations["proprioception"][:-1])
    moved, names = np.stack(rows["observation.movement"].to_numpy()), info["features"]["observation.movement"]["names"]
    speeds = moved[:STEPS, names.index("right_hand_speed_m_s")]
    assert np.array_equal(speeds, recording[0].movement["right_hand_speed_m_s"][:-1])
    assert any("pictures are videos with losses" in note for note in notes)


def test_lerobot_finds_each_episode_in_the_tables_and_videos(exported):
    out, _ = exported("lerobot")
    info = json.loads((out / "meta" / "info.json").read_text())
    episodes = pq.read_table(out / "meta" / "episodes" / "chunk-000" / "file-000.parquet").to_pylist()
    assert [(each["dataset_from_index"], each["dataset_to_index"]) for each in episodes] == [(0, 6), (6, 10)]
    eye = "observation.images.eye_left"
    video = out / info["video_path"].format(video_key=eye, chunk_index=0, file_index=0)
    with av.open(video) as container:
        pictures = sum(1 for _ in container.decode(video=0))
    assert pictures == round(episodes[-1][f"videos/{eye}/to_timestamp"] * info["fps"])
    assert np.shape(episodes[0][f"stats/{eye}/mean"]) == (3, 1, 1)
    assert pq.read_table(out / "meta" / "tasks.parquet").to_pydict() == {"task_index": [0], "task": ["selfbody"]}
    stats = json.loads((out / "meta" / "stats.json").read_text())
    rows = pq.read_table(out / "data" / "chunk-000" / "file-000.parquet")
    actions = np.stack(rows["action"].to_numpy()).astype(float)
    assert stats["action"]["std"] == pytest.approx(actions.std(axis=0))
    assert stats.keys() == info["features"].keys()


def test_tables_of_text_have_every_number(recording, exported):
    out, notes = exported("csv")
    with (out / "0000-000000.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    columns = recording[0].columns("action", "proprioception")
    assert len(rows) == STEPS + 1
    assert all(
        np.float32(rows[3][name]) == np.float32(array[3]) for name, array in columns.items() if array.dtype != bool
    )
    with (out / "0000-000000.touch.csv").open(newline="") as file:
        touched = list(csv.DictReader(file))
    assert len(touched) == np.count_nonzero(recording[0].observations["touch"])
    assert "'eye_left' is left out: a table cannot hold pictures" in notes


def test_bad_exports_write_nothing(recording, invoke, tmp_path, monkeypatch):
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "letter.txt").write_text("dear")
    with pytest.raises(UnknownNameError, match="'minary' is not a format of recordings; did you mean 'minari'"):
        mimoc.export_recording(recording, "minary", tmp_path / "out")
    with pytest.raises(OutputError, match="full: the folder is not empty"):
        mimoc.export_recording(recording, "csv", tmp_path / "full")
    with pytest.raises(OutputError, match=r"letter\.txt: this is a file"):
        mimoc.export_recording(recording, "csv", tmp_path / "full" / "letter.txt")
    monkeypatch.setitem(sys.modules, "minari", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'mimoc\[minari\]'"):
        mimoc.export_recording(recording, "minari", tmp_path / "out")
    code, out, err = invoke("export", tmp_path, "--to", "csv", "-o", tmp_path / "out")
    assert (code, out) == (2, "")
    assert "this is not a recording" in err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["full"]


def test_nothing_recorded_is_nothing_to_export(recording, tmp_path):
    with mimoc.Recorder(mimoc.make(recording.bundle()), tmp_path / "empty") as env:
        env.reset(seed=0)
    with pytest.raises(RecordingError, match="there are no control steps in this recording"):
        mimoc.export_recording(tmp_path / "empty", "csv", tmp_path / "out")


def test_an_infant_without_actions_is_recorded_and_exported_as_text_only(tmp_path):
    """All its joints are locked; pyarrow, as Minari uses it too, ends Python at lists without numbers."""
    spec = {"mimoc": 1, "name": "cast", "age_months": 3, "senses": {"proprioception": {}}}
    locked = {"actuation": {"locked": ["trunk", "arms", "eyes", "legs", "neck", "hands"]}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(spec | locked))
    with mimoc.Recorder(mimoc.make(bundle), tmp_path / "still", part_rows=2) as env:
        assert env.action_space.shape == (0,)
        env.reset(seed=0)
        for _ in range(3):
            env.step(env.action_space.sample())
    recording = mimoc.read_recording(tmp_path / "still")
    assert recording[0].actions.shape == (3, 0)
    again = replay(recording, lambda bundle, other_seeds: mimoc.InfantEnv(bundle))
    assert [replayed.difference for replayed in again] == [None]
    mimoc.export_recording(recording, "csv", tmp_path / "text")
    for name in ("minari", "lerobot"):
        with pytest.raises(RecordingError, match="this format holds actions, and this infant has none"):
            mimoc.export_recording(recording, name, tmp_path / name)


def write_returns(recording: ReadRecording, folder: Path, progress) -> list[str]:
    for done, episode in enumerate(recording):
        progress(done, len(recording))
        (folder / f"{done}.txt").write_text(str(episode.rewards.sum()))
    return ["all but the return is left out"]


def test_a_format_from_outside_is_exported_to_from_python_and_by_the_command(recording, registered, invoke, tmp_path):
    """A generator's lines count, and to return nothing is to lose nothing."""

    def lazy(recording, folder, progress):
        (folder / "steps.txt").write_text(str([episode.steps for episode in recording]))
        yield "steps only"

    with registered(ExporterKind("returns", "returns", write_returns)):
        assert mimoc.export_recording(recording, "returns", tmp_path / "a") == ("all but the return is left out",)
        code, out, err = invoke("export", recording.path, "--to", "returns", "-o", tmp_path / "b")
    with registered(ExporterKind("lazy", "steps", lazy)):
        assert mimoc.export_recording(recording, "lazy", tmp_path / "c") == ("steps only",)
    with registered(ExporterKind("silent", "nothing", lambda recording, folder, progress: None)):
        assert mimoc.export_recording(recording, "silent", tmp_path / "d") == ()
    assert (code, out, err) == (0, f"{tmp_path / 'b'}\n", "note: all but the return is left out\n")
    for folder in (tmp_path / "a", tmp_path / "b"):
        assert float((folder / "1.txt").read_text()) == pytest.approx(recording[1].rewards.sum())
    assert (tmp_path / "c" / "steps.txt").read_text() == str([STEPS, STEPS - 2])


def test_a_format_of_one_kind_of_episodes_refuses_others(registered, tmp_path):
    spec = {"mimoc": 1, "name": "cast", "age_months": 3}
    locked = {"actuation": {"locked": ["trunk", "arms", "eyes", "legs", "neck", "hands"]}}
    with mimoc.Recorder(mimoc.make(mimoc.InfantSpec.model_validate(spec | locked)), tmp_path / "still") as env:
        env.reset(seed=0)
        env.step(env.action_space.sample())
    uniform = registered(ExporterKind("returns", "returns", write_returns, is_uniform=True))
    with uniform, pytest.raises(RecordingError, match="this format holds actions, and this infant has none"):
        mimoc.export_recording(tmp_path / "still", "returns", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("run", "error", "reason"),
    [
        (lambda recording, folder, progress: 5, KindError, r"the exporter 'bad' returned \[5\]; let it return lines"),
        (lambda recording, folder, progress: [recording], KindError, "the exporter 'bad' returned"),
        (lambda recording, folder, progress: (folder / "no" / "such").touch(), OutputError, "out: cannot be written"),
        (lambda recording: [], TypeError, "takes 1 positional argument"),
        ("wave", KindError, "the plug-in module 'wave' has no usable function 'export'"),
    ],
)
def test_a_format_from_outside_that_fails_leaves_nothing(recording, registered, tmp_path, run, error, reason):
    with registered(ExporterKind("bad", "fails", run)), pytest.raises(error, match=reason):
        mimoc.export_recording(recording, "bad", tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("record", "reason"),
    [
        (ExporterKind("csv", "mine", write_returns), "there is a format of recordings 'csv' already, from mimoc"),
        (ExporterKind("lerobot", "mine", write_returns), "there is a format of recordings 'lerobot' already"),
        (ExporterKind("my format", "mine", write_returns), "'my format' cannot name a format of recordings"),
        (ExporterKind("mine", "mine", 5), "ExporterKind.run is 5"),
        (ExporterKind("mine", "mine", "no_such_module"), "names the module 'no_such_module', which does not exist"),
        (ExporterKind("mine", "mine", write_returns, "no"), "ExporterKind.is_uniform is 'no'"),
    ],
)
def test_a_format_that_cannot_be_registered_is_refused_in_one_line(record, reason):
    with pytest.raises(KindError, match=reason):
        mimoc.register(record)
    assert "mine" not in EXPORTERS


def test_a_format_of_an_installed_package_is_exported_to(recording, tmp_path, monkeypatch):
    (tmp_path / "mimoc_lengths.py").write_text(
        "from mimoc.plugin import ExporterKind\n"
        "def export(recording, folder, progress):\n"
        "    (folder / 'lengths.txt').write_text(str([episode.steps for episode in recording]))\n"
        "KIND = ExporterKind('lengths', 'lengths of episodes', 'mimoc_lengths')\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    plugins._load(EntryPoint("lengths", "mimoc_lengths:KIND", "mimoc.exporters"))
    try:
        assert mimoc.export_recording(recording, "lengths", tmp_path / "out") == ()
    finally:
        EXPORTERS.remove("lengths")
    assert (tmp_path / "out" / "lengths.txt").read_text() == str([STEPS, STEPS - 2])


SPEC = {"mimoc": 1, "name": "kim", "age_months": 3, "senses": {"proprioception": {}}}
SHAPES = {"body_pos_w": 3, "body_quat_w": 4, "body_lin_vel_w": 3, "body_ang_vel_w": 3}


def test_a_motion_has_joints_and_bodies_at_each_control_step(tmp_path):
    with mimoc.Recorder(mimoc.make(built(SPEC)), tmp_path / "run") as env:
        env.reset(seed=0)
        for _ in range(20):
            env.step(0.1 * env.action_space.sample())
    (note,) = mimoc.export_recording(tmp_path / "run", "mjlab", tmp_path / "out")
    assert "left out" in note
    with np.load(tmp_path / "out" / "0000-000000.npz") as motion:
        frames, bodies = 21, len(motion["body_names"])
        assert motion["fps"].tolist() == [100.0]
        assert motion["joint_pos"].shape == motion["joint_vel"].shape == (frames, len(motion["joint_names"]))
        for name, size in SHAPES.items():
            assert motion[name].shape == (frames, bodies, size)
        assert np.linalg.norm(motion["body_quat_w"], axis=-1) == pytest.approx(np.ones((frames, bodies)), abs=1e-5)
        speeds = np.gradient(motion["body_pos_w"][:, 0].astype(float), 0.01, axis=0)
        assert np.allclose(speeds[5:-5], motion["body_lin_vel_w"][5:-5, 0], atol=0.05)
