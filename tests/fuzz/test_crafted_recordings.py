"""Every recording that was ever made to do harm is refused in one line; nothing outside of it is opened or changed."""

import json
import os
from contextlib import suppress
from pathlib import Path
from shutil import copytree

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fuzz.crafted_recordings import DESCRIPTIONS, PART, TABLES, VIDEOS, WHOLE
from fuzz.fuzzing import Canaries, is_clear
from fuzz.recordings import Prepared, go_on, prepare, read, replay_to_video
from fuzz.strange_infants import CANARIES

import mimoc
from mimoc.base.errors import MimocError

SEEING, BLIND = 0, 1
FILES = ("recording.json", "episodes", f"{PART}.json", f"{PART}.parquet", "episodes/0000-000000.parquet", "bundles")
"""What a link may stand in place of; the bundle of the recording, as well."""


@pytest.fixture(scope="module")
def prepared(tmp_path_factory) -> Prepared:
    """Return honest recordings, which are only to be read."""
    return prepare(tmp_path_factory.mktemp("prepared"))


@pytest.fixture
def outside(tmp_path):
    canaries = Canaries(tmp_path / "outside", CANARIES)
    yield canaries
    canaries.close()


@pytest.fixture
def copied(prepared, tmp_path):
    return lambda number: Path(copytree(prepared.folders[number], tmp_path / "recording"))


def uses(folder: Path, bundle: mimoc.Bundle):
    out = folder.parent
    return {
        "read": lambda: read(folder),
        "csv": lambda: mimoc.export_recording(folder, "csv", out / "csv"),
        "minari": lambda: mimoc.export_recording(folder, "minari", out / "minari"),
        "lerobot": lambda: mimoc.export_recording(folder, "lerobot", out / "lerobot"),
        "view": lambda: mimoc.view(folder, out / "page.html"),
        "replay": lambda: list(mimoc.replay_recording(folder)),
        "video": lambda: replay_to_video(folder, out / "video.gif"),
        "record": lambda: go_on(folder, bundle),
    }


def refusal(use) -> str:
    with pytest.raises(MimocError) as error:
        use()
    assert is_clear(error.value)
    return str(error.value)


@pytest.mark.full
def test_an_honest_recording_can_be_used_in_every_way(copied, prepared):
    for use in uses(copied(BLIND), prepared.bundles[BLIND]).values():
        use()


@pytest.mark.parametrize("name", TABLES | DESCRIPTIONS)
def test_a_crafted_recording_is_refused_in_one_line(name, copied, outside):
    craft, said = (TABLES | DESCRIPTIONS)[name]
    folder = copied(BLIND)
    craft(folder, outside.folder)
    assert said in refusal(lambda: read(folder))
    assert outside.opened() == []


@pytest.mark.parametrize("name", VIDEOS)
def test_a_crafted_video_is_refused_in_one_line(name, copied, outside):
    craft, said = VIDEOS[name]
    folder = copied(SEEING)
    craft(folder, outside.folder)
    assert said in refusal(lambda: read(folder))


@pytest.mark.parametrize("use", ["csv", "minari", "lerobot", "view", "replay", "video"])
def test_no_use_of_a_crafted_recording_is_a_traceback(use, copied, prepared):
    """A part of another type; who records another episode in the folder does not read it."""
    craft, said = TABLES["a part of whole numbers"]
    folder = copied(BLIND)
    craft(folder, folder)
    before = sorted(path.name for path in folder.parent.rglob("*"))
    assert said in refusal(uses(folder, prepared.bundles[BLIND])[use])
    assert sorted(path.name for path in folder.parent.rglob("*")) == before


@pytest.mark.parametrize("name", [*FILES, "bundles/*", "a video"])
@pytest.mark.parametrize("kind", ["link", "link to nothing", "pipe", "folder"])
def test_what_is_not_a_file_of_the_recording_is_neither_read_nor_written(name, kind, copied, prepared, outside):
    number = SEEING if name == "a video" else BLIND
    folder = copied(number)
    path = next(folder.glob("episodes/*.mkv" if name == "a video" else name))
    path.rename(folder.parent / "kept")
    if kind == "link":
        path.symlink_to(outside.folder if (folder.parent / "kept").is_dir() else outside.folder / "canary.skn")
    elif kind == "link to nothing":
        path.symlink_to(outside.folder / "new")
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        path.mkdir()
    ways = uses(folder, prepared.bundles[number])
    if kind != "folder" or name not in ("episodes", "bundles"):  # Those are folders.
        refusal(ways["read"])
    for what in ("csv", "record"):
        with suppress(MimocError):  # Neither needs every file.
            ways[what]()
    assert outside.opened() == []


@pytest.mark.parametrize("name", ["episodes", "bundles"])
def test_a_new_recording_is_not_written_into_linked_folders(name, prepared, tmp_path, outside):
    (tmp_path / "new").mkdir()
    (tmp_path / "new" / name).symlink_to(outside.folder)
    error = refusal(lambda: go_on(tmp_path / "new", prepared.bundles[BLIND]))
    assert f"{tmp_path / 'new' / name}: this is a link, through which mimoc writes nothing" in error
    assert outside.opened() == []


@pytest.mark.parametrize("part", [PART.removesuffix(".0001"), PART])
def test_a_part_without_rows_is_refused(part, copied, prepared):
    folder = copied(BLIND)
    path = folder / f"{part}.parquet"
    pq.write_table(pq.read_table(path).slice(0, 0), path)
    assert str(folder / "episodes" / "0000-000002") in refusal(lambda: read(folder))


def test_actions_beyond_the_type_in_which_they_were_given_are_not_replayed(copied, prepared):
    folder = copied(BLIND)
    path = folder / f"{WHOLE}.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"changes": [{"step": 0, "action_dtype": "float16"}]}))
    table = pq.read_table(path.with_suffix(".parquet"))
    actions = pa.array([[1e6] * len(row) for row in table["action"].to_pylist()], table["action"].type)
    pq.write_table(
        table.set_column(table.column_names.index("action"), table.field("action"), actions),
        path.with_suffix(".parquet"),
    )
    said = refusal(uses(folder, prepared.bundles[BLIND])["replay"])
    assert "'action_dtype' is float16, which cannot hold the action 1000000.0" in said


def test_a_number_that_was_a_flag_in_an_earlier_part_is_a_number_in_all(copied, prepared):
    """As the info of a script's own task may be."""
    folder = copied(BLIND)
    path = folder / f"{PART}.parquet"
    table = pq.read_table(path)
    place = table.column_names.index("info.is_success")
    numbers = pa.array([0.5] * len(table))
    pq.write_table(table.set_column(place, pa.field("info.is_success", numbers.type, False), numbers), path)
    *_, in_parts = mimoc.read_recording(folder)
    assert in_parts.infos["is_success"].tolist() == [0.0, 0.5, 0.5]
