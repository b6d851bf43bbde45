"""Files of recordings that are packed, links or pipes."""

import os

import numpy as np
import pyarrow as pa
import pytest
from fuzz.recordings import prepare

import mimoc
from mimoc.errors import RecordingError
from mimoc.recording.tables import read_columns


def test_a_part_that_is_packed_is_refused_before_it_is_unpacked(tmp_path):
    table = pa.table({"step": np.zeros(10**5)})
    for name, packing in (("plain", None), ("packed", "zstd")):
        options = pa.ipc.IpcWriteOptions(compression=packing)
        with pa.ipc.new_stream(tmp_path / f"{name}.arrow", table.schema, options=options) as writer:
            writer.write_table(table)
    assert len(read_columns([tmp_path / "plain.arrow"])) == 10**5
    with pytest.raises(RecordingError, match="damaged"):
        read_columns([tmp_path / "packed.arrow"])


def test_links_and_pipes_among_the_files_of_a_recording_are_refused(tmp_path):
    recording = prepare(tmp_path)
    mimoc.read_recording(recording)
    episodes = (recording / "episodes").iterdir()
    read = (".json", ".parquet", ".arrow", ".mkv")
    files = [recording / "recording.json", *(path for path in episodes if path.suffix in read)]
    for path in files:
        kept = path.rename(tmp_path / "kept")
        for spoil in (os.mkfifo, lambda at, kept=kept: at.symlink_to(kept)):
            spoil(path)
            with pytest.raises(RecordingError):
                mimoc.read_recording(recording)
            path.unlink()
        kept.rename(path)
