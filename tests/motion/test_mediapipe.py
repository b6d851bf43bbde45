"""MediaPipe's landmarks are read in the forms in which people export them, with MediaPipe's axes."""

import json
from dataclasses import replace

import numpy as np
import pytest
from support import filmed

import mimoc
from mimoc.base.errors import RecordingError
from mimoc.motion.read_mediapipe import LANDMARKS

PICTURE = 640, 480
WORLD = "its metres are MediaPipe's estimate from one camera, and are relative to the hips"


@pytest.fixture(scope="module")
def space():
    return filmed.in_space(60, filmed.BODY_25_POINTS)


def points(table):
    return [
        [dict(zip(("x", "y", "z", "visibility"), point, strict=True)) for point in frame] for frame in table.tolist()
    ]


def wide(table, columns):
    rows = table.reshape(len(table), -1).tolist()
    return "\n".join([",".join(columns), *(",".join(map(str, row)) for row in rows)])


def long(table, header, label):
    cells = [
        (frame, label(number), *point) for frame, row in enumerate(table.tolist()) for number, point in enumerate(row)
    ]
    return "\n".join([header, *(",".join(map(str, row)) for row in cells)])


TABLES = {
    "names": lambda t: wide(t, [f"{name}_{end}" for name in LANDMARKS for end in ("x", "y", "z", "visibility")]),
    "enum": lambda t: wide(t, [f"PoseLandmark.{name.upper()}.{end}" for name in LANDMARKS for end in "xyzv"]),
    "numbers": lambda t: wide(
        t, [f"landmark_{number}_{end}" for number in range(33) for end in ("x", "y", "z", "presence")]
    ),
    "from 0": lambda t: wide(t, [f"{end}{number}" for number in range(33) for end in "xyzv"]),
    "from 1": lambda t: wide(t, [f"{end}{number}" for number in range(1, 34) for end in "xyzv"]),
    "long numbers": lambda t: long(t, "frame,landmark_id,x,y,z,visibility", str),
    "long names": lambda t: long(t, "frame,landmark,x,y,z,visibility", lambda number: LANDMARKS[number].upper()),
}
LISTS = {
    "lists": points,
    "arrays": lambda t: t.tolist(),
    "landmarks": lambda t: [{"frame": at, "landmarks": row} for at, row in enumerate(points(t))],
    "of one person": lambda t: [{"pose_landmarks": [row], "segmentation_masks": None} for row in points(t)],
    "under a key": lambda t: {"fps": 30, "frames": [{"pose_world_landmarks": {"landmark": row}} for row in points(t)]},
    "by name": lambda t: [{"landmarks": dict(zip(LANDMARKS, row, strict=True))} for row in points(t)],
    "named": lambda t: [
        [{"name": name, **point} for name, point in zip(LANDMARKS, row, strict=True)] for row in points(t)
    ],
    "by frame": lambda t: {str(at): row for at, row in enumerate(points(t))},
}
FORMS = [*(("a.csv", form) for form in TABLES.values()), *(("a.json", form) for form in LISTS.values())]
NAMES = [*TABLES, *LISTS]


def write(recording, name, form, tmp_path):
    text = form(filmed.landmarks(recording))
    (tmp_path / name).write_text(text if isinstance(text, str) else json.dumps(text))
    return tmp_path / name


@pytest.mark.parametrize(("name", "form"), FORMS, ids=NAMES)
def test_shares_of_a_picture_of_known_size_are_pixels(name, form, body_25, tmp_path):
    read = mimoc.read_points(write(body_25, name, form, tmp_path), rate_hz=30, picture_px=PICTURE)
    seen = read.select([point for point in read.names if point not in ("neck", "mid_hip")])
    assert read.unit == "px"
    assert np.allclose(seen.positions, body_25.select(seen.names).positions)
    assert len(seen.names) == 21
    assert "positions are shares of a picture of 640 x 480 pixels" in read.notes


@pytest.mark.parametrize(("name", "form"), FORMS, ids=NAMES)
def test_metres_from_the_hips_are_turned_so_that_z_points_upwards(name, form, space, tmp_path):
    read = mimoc.read_points(write(space, name, form, tmp_path), rate_hz=30)
    expected = space.positions - space.hips[:, None]
    seen = [point for point in read.names if point not in ("neck", "mid_hip")]
    above = read.select(seen).positions - space.select(seen).positions + space.hips[:, None]
    assert read.unit == "m"
    assert np.allclose(above, above[0, 0])
    assert np.ptp(expected[..., 2]) > 0.1
    assert any(note.startswith(WORLD) for note in read.notes)


def test_shares_of_a_picture_of_unknown_size_are_asked_about(body_25, tmp_path):
    path = filmed.write_mediapipe(body_25, tmp_path / "a.csv")
    with pytest.raises(RecordingError, match=r"picture_px=\(1920, 1080\), or export pixels, not shares of the picture"):
        mimoc.read_points(path, rate_hz=30)


def test_an_infant_may_be_half_out_of_the_picture(body_25, tmp_path):
    beside = replace(body_25, positions=body_25.positions - [320, 0])
    read = mimoc.read_points(filmed.write_mediapipe(beside, tmp_path / "a.csv"), rate_hz=30, picture_px=PICTURE)
    assert np.allclose(read.path("left_knee"), beside.path("left_knee"))


def test_a_camera_says_the_size_of_its_picture(body_25, tmp_path):
    path = filmed.write_mediapipe(body_25, tmp_path / "a.json")
    camera = mimoc.Camera((500, 500), (320, 240), PICTURE)
    assert mimoc.read_points(path, rate_hz=30, camera=camera).trunk == pytest.approx(body_25.trunk, rel=0.05)


def test_of_both_in_one_file_metres_count_unless_the_picture_is_known(body_25, space, tmp_path):
    both = zip(points(filmed.landmarks(body_25)), points(filmed.landmarks(space)), strict=True)
    frames = [{"poseLandmarks": one, "poseWorldLandmarks": other} for one, other in both]
    (tmp_path / "a.json").write_text(json.dumps(frames))
    assert mimoc.read_points(tmp_path / "a.json", rate_hz=30).unit == "m"
    assert mimoc.read_points(tmp_path / "a.json", rate_hz=30, picture_px=PICTURE).unit == "px"


@pytest.mark.parametrize("empty", [None, [], {}, {"landmarks": []}, {"landmarks": None}])
def test_a_frame_in_which_nobody_was_found_is_a_gap(empty, space, tmp_path):
    frames = points(filmed.landmarks(space))
    (tmp_path / "a.json").write_text(json.dumps([*frames[:7], empty, *frames[8:]]))
    read = mimoc.read_points(tmp_path / "a.json", rate_hz=30)
    assert np.isnan(read.path("neck")[:, 0]).nonzero()[0].tolist() == [7]


def test_a_folder_has_a_file_for_each_frame(space, tmp_path):
    (tmp_path / "film").mkdir()
    for frame, row in enumerate(points(filmed.landmarks(space))):
        if frame != 4:
            (tmp_path / "film" / f"img{frame:03d}_cam2.json").write_text(json.dumps({"pose_world_landmarks": [row]}))
    read = mimoc.read_points(tmp_path / "film", rate_hz=30)
    assert (read.name, read.frames, read.unit) == ("film", 60, "m")
    assert np.isnan(read.positions[4]).all()


@pytest.mark.parametrize("size", [(0, 480), (640, -1), (640,), (10**9, 480)])
def test_a_size_of_no_picture_is_one_line(size, body_25, tmp_path):
    with pytest.raises(RecordingError, match="give width and height in pixels"):
        mimoc.read_points(filmed.write_mediapipe(body_25, tmp_path / "a.csv"), rate_hz=30, picture_px=size)


def test_landmarks_that_are_hardly_visible_are_gaps(body_25, tmp_path):
    table = filmed.landmarks(body_25)
    table[3:6, LANDMARKS.index("left_wrist"), 3] = 0.4
    (tmp_path / "a.json").write_text(json.dumps(points(table)))
    read = mimoc.read_points(tmp_path / "a.json", rate_hz=30, picture_px=PICTURE)
    assert np.isnan(read.path("left_wrist")[:, 0]).nonzero()[0].tolist() == [3, 4, 5]


def test_frame_rate_and_times_of_json_are_read(space, tmp_path):
    frames = points(filmed.landmarks(space))
    timed = [{"timestamp_ms": 40 * at, "landmarks": row} for at, row in enumerate(frames)]
    for data in (timed, {"fps": 25, "frames": frames}):
        (tmp_path / "a.json").write_text(json.dumps(data))
        assert mimoc.read_points(tmp_path / "a.json").rate_hz == 25


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        ({"landmarks": {}}, "has no list of frames with landmarks"),
        ([[{"x": 1, "visibility": 1}] * 33], "frame 0 of the list: landmarks are damaged; export it again"),
        ([[{"x": "one", "y": 1, "visibility": 1}] * 33], "frame 0 of the list: landmarks are damaged; export it again"),
        ([[{"x": 10**400, "y": 1, "visibility": 1}] * 33], "frame 0 of the list: landmarks are damaged"),
        ([[{"x": 1, "y": 1, "visibility": 1}] * 5], "has 5 landmarks in a frame, and not 33; export it again"),
        ([{"landmarks": [[[0, 0, 0]] * 33] * 2}], "has several persons in a frame; export the infant alone"),
        ({"pose_landmarks": [{"x": 1, "y": 1, "visibility": 1}] * 33}, "has one frame, and no movement"),
        ({"9" * 5000: 1, "landmarks": 1}, "has no list of frames with landmarks"),
    ],
)
def test_damaged_landmarks_are_one_line(data, reason, tmp_path):
    (tmp_path / "a.json").write_text(json.dumps(data))
    with pytest.raises(RecordingError) as caught:
        mimoc.read_points(tmp_path / "a.json", format="mediapipe", rate_hz=30)
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)
