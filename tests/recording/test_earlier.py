"""Recordings that earlier versions of mimoc made are read; those that were killed, after they were converted.

`earlier.zip` is one by the version before parts were columns of Parquet from the start: an infant of nine months with
touch and eyes in two whole episodes and, as a kill leaves it, one in two parts.
"""

import zipfile
from collections.abc import Callable
from pathlib import Path
from shutil import copyfile
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

import mimoc
from mimoc.base.errors import RecordingError

STEPS = [4, 4, 3]
PART = "episodes/0000-000002.part0001.arrow"


@pytest.fixture
def earlier(tmp_path) -> Path:
    with zipfile.ZipFile(Path(__file__).with_name("earlier.zip")) as files:
        files.extractall(tmp_path / "earlier")
    return tmp_path / "earlier"


def test_whole_episodes_are_read_and_replayed_as_they_are(earlier):
    for part in (earlier / "episodes").glob("*.part*"):
        part.unlink()
    recording = mimoc.read_recording(earlier)
    assert [(each.steps, each.ended) for each in recording] == [(4, "reset"), (4, "reset")]
    assert recording[1].observation("eye_left").shape == (5, 12, 16, 3)
    assert_replayed(earlier)


def test_a_killed_one_is_replayed_after_it_was_converted(earlier, tmp_path, invoke):
    code, out, err = invoke("replay", earlier)
    assert (code, out) == (2, "")
    assert err.endswith(f"convert it by 'mimoc export {earlier} --to recording -o NEW'\n")
    assert invoke("export", earlier, "--to", "recording", "-o", tmp_path / "new") == (0, f"{tmp_path / 'new'}\n", "")
    recording = mimoc.read_recording(tmp_path / "new")
    assert [each.steps for each in recording] == STEPS
    assert [each.ended for each in recording] == ["reset", "reset", "unfinished"]
    assert recording[2].observation("eye_right").shape == (4, 12, 16, 3)
    assert recording[2].observation("touch").any()
    assert_replayed(tmp_path / "new")
    assert not list((tmp_path / "new").rglob("*.mp4"))


def assert_replayed(folder: Path) -> None:
    """Every number comes out again; pixels may depend on this machine's OpenGL, numbers on its MuJoCo.

    The last bits may depend on its processor, which ends the comparison by bits.
    """
    rows: list[dict[str, Any]] = []
    for replayed in mimoc.replay_recording(folder, watch=lambda env, observation: rows.append(observation)):
        difference, episode = replayed.difference, replayed.episode
        for name in ("proprioception", "touch"):
            if name in rows[0] and not replayed.other_versions:
                recorded = episode.observation(name)[: len(rows)]
                np.testing.assert_allclose([row[name] for row in rows], recorded, rtol=1e-5, atol=1e-6)
        by_bits = difference is None or difference.what.startswith("eye_") or replayed.other_versions
        assert by_bits or difference.what == "state" or abs(difference.now - difference.recorded) < 1e-6
        rows.clear()


def _rewritten(change: Callable[[Any], Any], **options: Any) -> Callable[[Path], None]:
    """Return what changes the rows of a part."""

    def craft(path: Path) -> None:
        with pa.ipc.open_stream(path.read_bytes()) as reader:
            table = change(reader.read_all())
        with pa.ipc.new_stream(path, table.schema, options=pa.ipc.IpcWriteOptions(**options)) as writer:
            writer.write_table(table)

    return craft


def _with_reward(change: Callable[[Any], Any]) -> Callable[[Path], None]:
    """Return what changes the rewards in a part, which may not be null."""

    def replace(table: Any) -> Any:
        column = change(table.column("reward").combine_chunks())
        return table.set_column(table.column_names.index("reward"), pa.field("reward", column.type, False), column)

    return _rewritten(replace)


@pytest.mark.parametrize(
    ("craft", "message"),
    [
        (_rewritten(lambda table: table, compression="zstd"), "it is packed"),
        (_rewritten(lambda table: table.drop_columns("reward")), "the column 'reward' is missing"),
        (_with_reward(lambda column: pa.nulls(len(column), column.type)), "the column 'reward' has nulls"),
        (_with_reward(lambda column: column.dictionary_encode()), "it is packed, or has more than rows"),
        (lambda path: copyfile(path.with_name("0000-000000.parquet"), path), "the file is damaged"),
        (lambda path: path.write_bytes(path.read_bytes()[:-3000]), "the file is damaged"),
        (lambda path: (path.unlink(), path.symlink_to("/dev/zero")), "is a link, which mimoc never writes"),
        (lambda path: (path.unlink(), path.mkdir()), "the file is missing"),
    ],
    ids=["packed", "fewer columns", "nulls", "dictionary", "Parquet", "cut", "link", "folder"],
)
def test_a_damaged_part_is_refused_in_one_line_and_nothing_is_written(craft, message, earlier, tmp_path):
    craft(earlier / PART)
    with pytest.raises(RecordingError, match=f"part0001.arrow: {message}"):
        mimoc.export_recording(earlier, "recording", tmp_path / "new")
    assert [path.name for path in tmp_path.iterdir()] == ["earlier"]
