"""Conversion of earlier recordings, which have parts of an episode as Arrow streams if they were killed."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mimoc.bundle.io import write_bundle
from mimoc.bundle.regular_files import UnusableFileError
from mimoc.recording import folder, tables
from mimoc.recording.description import RECORDING
from mimoc.recording.dictionary import read_dictionary, write_dictionary
from mimoc.recording.folder import EPISODES, part_stem, with_extension
from mimoc.recording.movement_columns.column import Column
from mimoc.recording.reading import ReadRecording
from mimoc.recording.tables import STEP, check_rows, pa

FILE = re.compile(r"([0-9]{4,}-[0-9]{6,})(?:\.part([0-9]{4,}))?(\.json|\.parquet|\.arrow|\.[^/]+\.mkv)")
MOST_PART_BYTES, MOST_COPIED_BYTES = 2**30, 2**33
"""Of a part, which was held in memory before it was written, and of any other file."""


def export(recording: ReadRecording, out: Path, progress: Callable[[int, int], None]) -> list[str]:
    """Write a recording of any version as this version records; small videos are left out."""
    home, names = recording.path / EPISODES, folder.names_in(recording.path)
    for number, infant in enumerate(recording.description.infants):
        write_bundle(recording.bundle(number), folder.bundle_folder(out, infant.bundle))
    (out / EPISODES).mkdir()
    for name in names:
        match = FILE.fullmatch(name)
        if match is None or (match[2] and f"{match[1]}.json" in names):  # Parts of an episode that had been joined.
            continue
        stem = part_stem(out / EPISODES / match[1], int(match[2] or 0))
        if match[3] == ".arrow":
            tables.write_table(with_extension(stem, folder.TABLE), _rows(home / name))
        else:
            target = with_extension(stem, match[3])
            with folder.opened(home / name, MOST_COPIED_BYTES) as file, target.open("wb") as copied:
                shutil.copyfileobj(file, copied)
    entries = read_dictionary(recording.path).values()
    columns = (Column(item["name"], item["unit"], item["about"], item["frame"], item["source"]) for item in entries)
    write_dictionary(out, columns)
    folder.write_json(out / RECORDING, recording.description.model_dump(exclude_unset=True))
    return []


def _rows(path: Path) -> Any:
    """Return the rows of an Arrow stream."""
    with folder.opened(path, MOST_PART_BYTES, *tables.DAMAGED) as file:
        content = pa.py_buffer(file.read())
        for message in pa.ipc.MessageReader.open_stream(pa.BufferReader(content)):
            is_rows = message.type == "record batch"
            if not (is_rows or message.type == "schema") or (is_rows and _is_packed(message.metadata.to_pybytes())):
                raise UnusableFileError("it is packed, or has more than rows")
        with pa.ipc.open_stream(content) as stream:
            described, table = tables.described_by(stream.schema), stream.read_all()
            check_rows(table, described, first_step=table.column(STEP)[0].as_py() if len(table) else 0)
            return table


def _is_packed(message: bytes) -> bool:
    """Return whether the rows of an Arrow message are compressed, so that they may unpack to more than a file has.

    Its metadata is a FlatBuffer: the field `compression`, the fourth of the table `RecordBatch`, is there or not, and
    this table is the third field of the table `Message`, as Arrow's `format/Message.fbs` says.
    """

    def number(at: int, size: int) -> int:
        return int.from_bytes(message[at : at + size], "little")

    def field(table: int, index: int) -> int:
        """Return where a field of a table is, 0 if it is left out."""
        listed = table - int.from_bytes(message[table : table + 4], "little", signed=True)
        at = number(listed + 4 + 2 * index, 2) if 4 + 2 * index < number(listed, 2) else 0
        return table + at if at else 0

    header = field(number(0, 4), 2)
    return bool(field(header + number(header, 4), 3))
