"""A format of recorded points that a script adds is recognised and read like mimoc's own."""

import json

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import KindError, RecordingError
from mimoc.plugin import MotionFormat, PointRecording, UnusableFileError
from mimoc.schema.components.motion import FORMATS


def recognise(path):
    return path.suffix == ".dots"


def read(path, options):
    data = json.loads(path.read_text())
    if "names" not in data:
        raise UnusableFileError("has no names; add them")
    positions = np.array(data["positions"], dtype=float)
    return PointRecording(path.stem, data["rate_hz"], tuple(data["names"]), positions, np.ones(positions.shape[:2]))


DOTS = MotionFormat("dots", "points in one JSON file", recognise, read)


def test_an_added_format_is_read_with_names_and_checks(kicking, tmp_path, registered):
    labels = [name.upper().replace("_", " ") for name in kicking.names]
    data = {"names": labels, "positions": kicking.positions.tolist(), "rate_hz": 30}
    (tmp_path / "a.dots").write_text(json.dumps(data))
    with registered(DOTS):
        assert list(FORMATS)[-1] == "dots"
        recording = mimoc.read_points(tmp_path / "a.dots")
        assert recording.names == kicking.names
        assert np.array_equal(recording.positions, kicking.positions)
        (tmp_path / "b.dots").write_text("{}")
        with pytest.raises(RecordingError, match=r"b\.dots: has no names; add them$"):
            mimoc.read_points(tmp_path / "b.dots")
    with pytest.raises(RecordingError, match="in no format that mimoc recognises"):
        mimoc.read_points(tmp_path / "a.dots")


def test_the_name_of_one_of_mimocs_formats_is_taken():
    with pytest.raises(KindError, match="there is a format of recorded points 'csv' already, from mimoc"):
        mimoc.register(MotionFormat("csv", "another", recognise, read))


@pytest.mark.parametrize("name", FORMATS)
def test_each_format_of_mimocs_has_code_and_a_line_for_help(name):
    kind = FORMATS[name]
    assert kind.about == kind.about.strip(".")
    assert str(kind.read).startswith("mimoc.motion.read_")
