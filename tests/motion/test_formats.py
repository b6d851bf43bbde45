"""What pose estimators, MINI-RGBD and motion capture write is read as it was."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support import filmed

import mimoc
from mimoc.base.errors import KindError, RecordingError
from mimoc.motion.body_points import film
from mimoc.motion.labels import POINTS
from mimoc.motion.point_recording import MINI_RGBD_CAMERA
from mimoc.motion.read_coco import COCO_17
from mimoc.motion.read_mediapipe import LANDMARKS
from mimoc.plugin import MotionFormat, PointRecording, UnusableFileError
from mimoc.schema.kinds import FORMATS

PIXEL = 1e-3
"""Digits of JSON files, half of the last."""


def are_close(one, other, within: float = 1e-9) -> bool:
    names = [name for name in one.names if name in other.names]
    return {*names} == {*one.names} and np.allclose(
        one.select(names).positions, other.select(names).positions, rtol=0, atol=within, equal_nan=True
    )


def test_a_folder_of_openpose(body_25, tmp_path):
    read = mimoc.read_points(filmed.write_openpose(body_25, tmp_path / "film"), rate_hz=30)
    assert (read.name, read.unit, read.rate_hz, read.frames) == ("film", "px", 30, 60)
    assert read.names == tuple(name for name in POINTS if name in filmed.BODY_25_POINTS)
    assert are_close(filmed.without_neck(read), filmed.without_neck(body_25), PIXEL)
    assert (read.confidence == 1).all()


def test_what_openpose_calls_the_neck_is_not_taken_for_it(body_25, tmp_path):
    """It was learnt from the middle of the shoulders: the neck is put above that, where mimoc's own is."""
    positions = body_25.positions.copy()
    positions[:, body_25.names.index("neck")] = 0.5
    read = mimoc.read_points(
        filmed.write_openpose(replace(body_25, positions=positions), tmp_path / "film"), rate_hz=30
    )
    assert read.trunk == pytest.approx(body_25.trunk, rel=0.05)
    assert "the neck is taken to be a little above the middle of the shoulders" in read.notes


def test_a_point_that_openpose_does_not_see_is_a_gap(body_25, tmp_path):
    positions = body_25.positions.copy()
    positions[10:25, body_25.names.index("left_wrist")] = np.nan
    folder = filmed.write_openpose(replace(body_25, positions=positions), tmp_path / "film")
    read = mimoc.read_points(folder, rate_hz=30)
    assert np.isnan(read.path("left_wrist")).all(axis=1).nonzero()[0].tolist() == list(range(10, 25))
    assert read.confidence[12, read.names.index("left_wrist")] == 0
    assert "not seen: left_wrist in 25% of frames; the longest gap is 0.5 s" in read.notes


def test_a_frame_without_a_file_is_a_gap(body_25, tmp_path):
    folder = filmed.write_openpose(body_25, tmp_path / "film")
    (folder / f"film_{7:012d}_keypoints.json").unlink()
    read = mimoc.read_points(folder, rate_hz=30)
    assert read.frames == 60
    assert np.isnan(read.positions[7]).all()
    assert read.notes[0] == "1 of 60 frames are missing"


@pytest.mark.parametrize("name", ["frames", "film.json"])
def test_coco_keypoints_in_one_file_or_many(name, body_25, tmp_path):
    read = mimoc.read_points(filmed.write_coco(body_25, tmp_path / name), rate_hz=25)
    assert are_close(read.select(COCO_17), body_25.select(COCO_17), PIXEL)
    assert read.trunk == pytest.approx(body_25.trunk, rel=0.06)  # In the middle of the shoulders it would be .86.
    assert read.notes == ("the neck is taken to be a little above the middle of the shoulders",)


def annotations(entries):
    images = [{"id": 1000 + entry["image_id"], "file_name": f"a/{entry['image_id']:05d}.jpg"} for entry in entries]
    seen = [
        {**entry, "image_id": 1000 + entry["image_id"], "keypoints": _flags(entry["keypoints"])} for entry in entries
    ]
    return {"images": images, "annotations": seen, "categories": [{"keypoints": [*COCO_17]}]}


def _flags(numbers):
    return [2 if index % 3 == 2 else number for index, number in enumerate(numbers)]


def mmpose(entries):
    def instance(entry):
        numbers = entry["keypoints"]
        points = [[x, y] for x, y in zip(numbers[::3], numbers[1::3], strict=True)]
        return {"keypoints": points, "keypoint_scores": numbers[2::3]}

    return {"instance_info": [{"frame_id": 1 + entry["image_id"], "instances": [instance(entry)]} for entry in entries]}


def mmpose_of_a_video(entries):
    return mmpose(entries)["instance_info"]


def alphapose(entries):
    return [{**entry, "image_id": f"{entry['image_id']}.jpg", "idx": 4} for entry in entries[::-1]]


@pytest.mark.parametrize("dialect", [annotations, mmpose, mmpose_of_a_video, alphapose])
def test_coco_keypoints_as_others_write_them(dialect, body_25, tmp_path):
    (tmp_path / "film.json").write_text(json.dumps(dialect(filmed.coco_entries(body_25))))
    read = mimoc.read_points(tmp_path / "film.json", rate_hz=30)
    assert are_close(read.select(COCO_17), body_25.select(COCO_17), PIXEL)
    assert (read.confidence == 1).all()


@pytest.mark.parametrize("place", ["", "joints_2Ddep"])
def test_a_sequence_of_mini_rgbd_has_depth(place, tmp_path):
    deep = film(filmed.kicking_model(), filmed.kicking(60), 30)
    filmed.write_mini_rgbd(deep, tmp_path / "07")
    read = mimoc.read_points(tmp_path / "07" / place)
    assert are_close(deep, read)
    assert np.allclose(read.select(deep.names).depth_m, deep.depth_m)
    assert (read.name, read.rate_hz, read.camera) == ("07", 30, MINI_RGBD_CAMERA)
    assert read.notes[0] == "30 frames/s are taken for granted"


def test_depths_in_millimetres_become_metres(tmp_path):
    deep = film(filmed.kicking_model(), filmed.kicking(60), 30)
    filmed.write_mini_rgbd(replace(deep, depth_m=1000 * deep.depth_m), tmp_path / "07")
    read = mimoc.read_points(tmp_path / "07")
    assert np.allclose(read.select(deep.names).depth_m, deep.depth_m)
    assert "depths are taken for millimetres" in read.notes


@pytest.mark.parametrize("scale", [1, 1000])
def test_joints_in_space_of_mini_rgbd(scale, in_space, tmp_path):
    filmed.write_mini_rgbd(replace(in_space, positions=in_space.positions * scale), tmp_path / "07")
    read = mimoc.read_points(tmp_path / "07").select(in_space.names)
    raised = in_space.positions - [0, 0, in_space.positions[..., 2].min()]
    assert read.unit == "m"
    assert np.allclose(read.positions, raised)


def test_public_keypoints_of_mini_rgbd(kicking, tmp_path):
    read = mimoc.read_points(filmed.write_pairs(kicking, tmp_path / "101.csv"))
    assert are_close(kicking, read)
    assert (read.rate_hz, read.camera) == (30, MINI_RGBD_CAMERA)
    assert read.notes == ("30 frames/s are taken for granted", "the camera is taken for that of MINI-RGBD")
    camera = mimoc.Camera((500, 500), (320, 240), (640, 480))
    read = mimoc.read_points(tmp_path / "101.csv", rate_hz=25, camera=camera)
    assert (read.rate_hz, read.camera, read.notes) == (25, camera, ())


def long_table(recording, folder: Path) -> Path:
    rows = [
        f"{frame},{name},{x!r},{y!r},{frame / 25}"
        for frame, positions in enumerate(recording.positions.tolist())
        for name, (x, y) in zip(recording.names, positions, strict=True)
    ]
    (folder / "long.csv").write_text("\n".join(["frame,point,x,y,time_s", *rows]))
    return folder / "long.csv"


def of_deeplabcut(recording, folder: Path) -> Path:
    axes = ("x", "y", "likelihood")
    header = [
        [word, *words]
        for word, words in (
            ("scorer", ["net"] * 3 * len(recording.names)),
            ("bodyparts", [name for name in recording.names for _ in axes]),
            ("coords", axes * len(recording.names)),
        )
    ]
    rows = [
        [str(frame), *(repr(number) for x, y in positions for number in (x, y, 1.0))]
        for frame, positions in enumerate(recording.positions.tolist())
    ]
    (folder / "dlc.csv").write_text("\n".join(",".join(row) for row in [*header, *rows]))
    return folder / "dlc.csv"


def of_excel(recording, folder: Path) -> Path:
    """Write semicolons, decimal commas and a mark of the order of bytes."""
    header = ";".join(f"{name}.{axis.upper()}" for name in recording.names for axis in "xy")
    rows = [
        ";".join(repr(number).replace(".", ",") for number in row)
        for row in recording.positions.reshape(60, -1).tolist()
    ]
    (folder / "excel.csv").write_text("\ufeff" + "\r\n".join([header, *rows]))
    return folder / "excel.csv"


@pytest.mark.parametrize("write", [long_table, of_deeplabcut, of_excel])
def test_tables_as_others_write_them(write, kicking, tmp_path):
    assert are_close(kicking, mimoc.read_points(write(kicking, tmp_path), rate_hz=25))


def test_the_frame_rate_of_a_table_is_that_of_its_times(kicking, tmp_path):
    path = mimoc.write_points(replace(kicking, rate_hz=29.97), tmp_path / "a.csv")
    assert mimoc.read_points(path).rate_hz == 29.97
    rows = path.read_text().splitlines()
    path.write_text("\n".join([*rows[:20], *rows[24:]]))
    read = mimoc.read_points(path)
    assert (read.rate_hz, read.frames) == (29.97, 60)
    path.write_text("\n".join(row.partition(",")[2] for row in path.read_text().splitlines()))
    read = mimoc.read_points(path)
    assert (read.rate_hz, read.frames) == (29.97, 60)
    assert np.isnan(read.positions[19:23]).all()


@pytest.mark.parametrize("unit", ["mm", "m"])
def test_markers_of_motion_capture(unit, in_space, tmp_path):
    read = mimoc.read_points(filmed.write_c3d(in_space, tmp_path / "a.c3d", unit=unit))
    assert are_close(in_space, read, 1e-6)
    assert (read.rate_hz, read.unit, read.notes) == (30, "m", ("the z axis is taken to point upwards",))


def test_markers_of_plug_in_gait_are_points(in_space, tmp_path):
    labels = {"head": "LFHD", "neck": "C7", "shoulder": "SHO", "elbow": "ELB", "hand": "FIN"}
    labels |= {"hip": "ASI", "knee": "KNE", "foot": "TOE"}
    names = tuple(
        "Baby:" + labels.get(name, name[0].upper() + labels.get(name.partition("_")[2], "")) for name in in_space.names
    )
    read = mimoc.read_points(filmed.write_c3d(in_space, tmp_path / "a.c3d", names))
    assert are_close(in_space, read, 1e-6)
    assert "left_hip is taken to be at Baby:LASI" in read.notes


@pytest.mark.parametrize(
    "unit",
    ["", "MM", "Millimeters", "milli-metre", "[mm]", "m.", "Meter", "cm", "Centimetres", "dm", "inches", "in", "ft"],
)
def test_units_of_markers_by_every_word(unit, in_space, tmp_path):
    read = mimoc.read_points(filmed.write_c3d(in_space, tmp_path / "a.c3d", unit=unit))
    assert are_close(in_space, read, 1e-6)


@pytest.mark.parametrize("unit", ["furlong", "ms", "s", "deg"])
def test_a_unit_that_is_not_known_is_asked_about(unit, in_space, tmp_path):
    path = filmed.write_c3d(in_space, tmp_path / "a.c3d", unit=unit)
    with pytest.raises(RecordingError, match=f"unknown unit '{unit}'; export it in one of mm, cm, dm, m, in, ft"):
        mimoc.read_points(path)


@pytest.mark.parametrize("seen", [0.0, 0.1, 0.5])
def test_markers_on_the_back_need_not_be_seen(seen, in_space, tmp_path):
    """An infant that lies on its back hides some of Plug-in Gait's."""
    labels = {"neck": "CLAV", "left_hip": "LASI", "right_hip": "RASI"}
    behind = in_space.select([*labels])
    hidden = behind.positions - [0, 0, 0.05]
    hidden[round(seen * behind.frames) :] = np.nan
    names = (*(labels.get(name, name) for name in in_space.names), "C7", "LPSI", "RPSI")
    positions = np.concatenate([in_space.positions, hidden], axis=1)
    whole = replace(in_space, names=names, positions=positions, confidence=np.ones(positions.shape[:2]))
    read = mimoc.read_points(filmed.write_c3d(whole, tmp_path / "a.c3d"))
    assert are_close(in_space, read, 1e-6)
    assert {"neck is taken to be at CLAV", "left out: C7; LPSI; RPSI"} <= {*read.notes}


@pytest.mark.parametrize(("unit", "size"), [("mm", 1000), ("cm", 100), ("m", 1)])
def test_columns_of_a_table_name_their_unit(unit, size, in_space, tmp_path):
    path = mimoc.write_points(replace(in_space, positions=in_space.positions * size), tmp_path / "a.csv")
    text = path.read_text()
    for end in (f"_{unit},", f" [{unit}],", f"({unit}),"):
        path.write_text(text.replace("_m,", end))
        assert are_close(in_space, mimoc.read_points(path), 1e-9)


def test_a_marker_that_is_not_seen_is_a_gap(in_space, tmp_path):
    positions = in_space.positions.copy()
    positions[5:9, 3] = np.nan
    read = mimoc.read_points(filmed.write_c3d(replace(in_space, positions=positions), tmp_path / "a.c3d"))
    assert np.isnan(read.path(in_space.names[3])[:, 0]).nonzero()[0].tolist() == [5, 6, 7, 8]


def test_integers_and_other_byte_orders_of_c3d_are_read(in_space, tmp_path):
    """A file by hand, with a scale of a tenth of a millimetre, as MIPS computers wrote them."""
    path = tmp_path / "old.c3d"
    path.write_bytes(old_c3d(in_space))
    assert are_close(in_space, mimoc.read_points(path), 1e-4)


def old_c3d(recording) -> bytes:
    k, t = len(recording.names), recording.frames
    lines = b"".join(name.encode().ljust(20) for name in recording.names)
    group = bytes([5, 255]) + b"POINT" + (3).to_bytes(2, "big") + b"\0"
    values = bytes([255, 2, 20, k]) + lines + b"\0"
    labels = bytes([6, 1]) + b"LABELS" + (2 + len(values)).to_bytes(2, "big") + values
    parameters = (bytes([1, 0x50, 2, 86]) + group + labels).ljust(1024, b"\0")
    header = bytearray(512)
    header[:2] = 2, 0x50
    for word, value in ((1, k), (3, 1), (4, t), (8, 4)):
        header[2 * word : 2 * word + 2] = value.to_bytes(2, "big")
    header[12:16] = np.array(0.1, ">f4").tobytes()
    header[20:24] = np.array(30, ">f4").tobytes()
    numbers = np.zeros((t, k, 4), ">i2")
    numbers[..., :3] = np.round(recording.positions * 1e4)
    return bytes(header) + parameters + numbers.tobytes()


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
