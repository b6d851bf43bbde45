"""Files say the names of their own points, and of which category a person is."""

import json
from dataclasses import replace

import numpy as np
import pytest
from support import filmed

import mimoc
from mimoc.base.errors import RecordingError
from mimoc.motion.labels import POINTS, known_name
from mimoc.motion.read_coco import COCO_17
from mimoc.motion.read_openpose import BODY_25

REVERSED = COCO_17[::-1]
META = [
    {"keypoint_id2name": {str(number): name for number, name in enumerate(REVERSED)}},
    {"keypoint_name2id": {name: number for number, name in enumerate(REVERSED)}},
    {"keypoint_info": {str(number): {"name": name, "id": number} for number, name in enumerate(REVERSED)}},
    {"keypoint_names": [*REVERSED]},
]


def same(read, recording) -> bool:
    names = [name for name in COCO_17 if name in read.names]
    known = recording.select(names).positions
    return len(names) == len(COCO_17) and np.allclose(read.select(names).positions, known, rtol=0, atol=1e-3)


@pytest.mark.parametrize("meta", META)
def test_meta_info_of_mmpose_names_the_points(meta, body_25, tmp_path):
    assert same(mimoc.read_points(filmed.write_mmpose(body_25, tmp_path / "a.json", **meta), rate_hz=30), body_25)


def test_a_file_for_each_picture_has_meta_info_too(body_25, tmp_path):
    data = json.loads(filmed.write_mmpose(body_25, tmp_path / "a.json").read_text())
    (tmp_path / "film").mkdir()
    for frame in data["instance_info"]:
        one = {"meta_info": data["meta_info"], "instance_info": frame["instances"]}
        (tmp_path / "film" / f"{frame['frame_id']:04d}_cam2.json").write_text(json.dumps(one))
    assert same(mimoc.read_points(tmp_path / "film", rate_hz=30), body_25)
    other = {**one, "meta_info": {"keypoint_names": [*COCO_17]}}
    (tmp_path / "film" / "0007_cam2.json").write_text(json.dumps(other))
    with pytest.raises(RecordingError, match="has files with other names of keypoints"):
        mimoc.read_points(tmp_path / "film", rate_hz=30)


@pytest.mark.parametrize(
    ("meta", "reason"),
    [
        ({"keypoint_id2name": {"0": "nose", "2": "neck"}}, "has damaged names of keypoints in meta_info"),
        ({"keypoint_id2name": ["nose"]}, "has damaged names of keypoints in meta_info"),
        ({"keypoint_info": {"0": {"id": 0}}}, "has damaged names of keypoints in meta_info"),
        ({"keypoint_names": [1, 2]}, "has names of keypoints that are not a list of texts"),
        ({"keypoint_names": ["nose", "nose"]}, "has a name of keypoints twice"),
        ({"keypoint_names": ["nose"]}, "a person has 51 numbers, and not 3 for each of 1 points"),
    ],
)
def test_damaged_names_are_one_line(meta, reason, body_25, tmp_path):
    with pytest.raises(RecordingError, match=reason):
        mimoc.read_points(filmed.write_mmpose(body_25, tmp_path / "a.json", **meta), rate_hz=30)


def categories(body_25, tmp_path, *names, present=slice(None)):
    """Write persons of categories, of which the first are larger."""
    several = {
        name: replace(body_25, positions=body_25.positions * (1 - 0.2 * number) + 40 * number)
        for number, name in enumerate(names)
    }
    path = filmed.write_categories(several, tmp_path / "a.json")
    data = json.loads(path.read_text())
    kept = [*range(1, len(names) + 1)][present]
    data["annotations"] = [one for one in data["annotations"] if one["category_id"] in kept]
    path.write_text(json.dumps(data))
    return path, several


def test_points_have_the_names_of_their_category(body_25, tmp_path):
    path, several = categories(body_25, tmp_path, "adult", "infant", present=slice(1, 2))
    read = mimoc.read_points(path, rate_hz=30)
    assert same(read, several["infant"])
    assert read.frames == 60  # Names of pictures end in `cam2`.


def test_of_an_adult_and_an_infant_the_infant_is_taken(body_25, tmp_path):
    path, several = categories(body_25, tmp_path, "adult", "infant")
    read = mimoc.read_points(path, rate_hz=30)
    assert same(read, several["infant"])
    assert "persons of the category infant are taken, and not of adult" in read.notes


def test_a_category_can_be_asked_for(body_25, tmp_path):
    path, several = categories(body_25, tmp_path, "one", "other")
    assert same(mimoc.read_points(path, rate_hz=30, infant="other"), several["other"])
    assert same(mimoc.read_points(path, rate_hz=30, infant="one"), several["one"])


def test_persons_of_categories_that_say_nothing_are_compared(body_25, tmp_path):
    """Their points are put in one order; the largest is followed."""
    path, several = categories(body_25, tmp_path, "one", "other")
    assert same(mimoc.read_points(path, rate_hz=30), several["one"])


def test_a_category_that_is_not_there_is_one_line(body_25, tmp_path):
    path, _ = categories(body_25, tmp_path, "one", "other")
    path.write_text(path.read_text().replace('"category_id": 2', '"category_id": 7'))
    with pytest.raises(RecordingError, match="a person has the category_id 7, and names of keypoints have only 1; 2"):
        mimoc.read_points(path, rate_hz=30)


def individuals(body_25, tmp_path, *names):
    several = {name: replace(body_25, positions=body_25.positions + 10 * number) for number, name in enumerate(names)}
    return filmed.write_deeplabcut(several, tmp_path / "a.csv"), several


def test_one_individual_of_deeplabcut_is_read(body_25, tmp_path):
    path, several = individuals(body_25, tmp_path, "mus1")
    assert same(mimoc.read_points(path, rate_hz=30), several["mus1"])


def test_points_that_belong_to_no_individual_are_left_out(body_25, tmp_path):
    path, several = individuals(body_25, tmp_path, "kim", "single")
    assert same(mimoc.read_points(path, rate_hz=30), several["kim"])


def test_of_several_individuals_the_one_that_is_named_is_read(body_25, tmp_path):
    path, several = individuals(body_25, tmp_path, "kim", "mother")
    assert same(mimoc.read_points(path, rate_hz=30, infant="mother"), several["mother"])
    assert same(mimoc.read_points(path, rate_hz=30, infant="kim"), several["kim"])
    with pytest.raises(RecordingError, match=r"has several individuals \(kim; mother\); say .* infant='kim'"):
        mimoc.read_points(path, rate_hz=30)
    with pytest.raises(RecordingError, match="has no individual 'kin'; did you mean 'kim'"):
        mimoc.read_points(path, rate_hz=30, infant="kin")


def test_labelled_pictures_of_deeplabcut_are_read(body_25, tmp_path):
    """Before the points, each row has the path of its picture in three cells."""
    path, several = individuals(body_25, tmp_path, "kim")
    rows = [row.split(",") for row in path.read_text().splitlines()]
    named = [[row[0], "", "", *row[1:]] for row in rows[:4]]
    named += [["labeled-data", "film7", f"img{int(row[0]):03d}.png", *row[1:]] for row in rows[4:]]
    path.write_text("\n".join(map(",".join, named)))
    assert same(mimoc.read_points(path, rate_hz=30), several["kim"])


def test_a_table_with_a_row_for_each_track(body_25, tmp_path):
    """As SLEAP writes it."""
    tracks = {name: replace(body_25, positions=body_25.positions + 9 * number) for number, name in enumerate("ab")}
    header = ["track", "frame_idx", "instance.score", *(f"{name}.{axis}" for name in body_25.names for axis in "xy")]
    rows = [
        [name, str(frame), "0.9", *map(str, row)]
        for name, one in tracks.items()
        for frame, row in enumerate(one.positions.reshape(one.frames, -1).tolist())
    ]
    (tmp_path / "a.csv").write_text("\n".join(map(",".join, [header, *rows])))
    assert same(mimoc.read_points(tmp_path / "a.csv", rate_hz=30, infant="b"), tracks["b"])
    with pytest.raises(RecordingError, match=r"has several individuals \(a; b\)"):
        mimoc.read_points(tmp_path / "a.csv", rate_hz=30)


@pytest.mark.parametrize("name", POINTS)
def test_each_name_means_itself_however_it_is_written(name):
    side, _, part = name.partition("_")
    words = [name, name.upper(), name.replace("_", " "), name.title().replace("_", "")]
    if side in ("left", "right"):
        words += [f"{part}_{side}", f"{side[0]}_{part}", f"{part}.{side[0]}", f"Baby 2:{side[0].upper()}{part.title()}"]
    assert {word: known_name(word) for word in words} == dict.fromkeys(words, name)


def test_every_label_of_body_25_is_a_point():
    assert "" not in filmed.BODY_25_POINTS
    assert len({*filmed.BODY_25_POINTS}) == len(BODY_25) == 25


@pytest.mark.parametrize("label", ["", "left", "l", "marker", "12", "spine", "left_left_hip", "hipp"])
def test_other_words_mean_no_point(label):
    assert known_name(label) == ""


def test_markers_around_a_point_have_it_in_their_middle_unless_it_is_named(tmp_path):
    kicking = filmed.filmed(20)
    shift = np.zeros((20, 14, 2))
    shift[:, kicking.names.index("left_hand")] = 10
    around = [replace(kicking, positions=kicking.positions + sign * shift) for sign in (-1, 1)]
    hands = [one.path("left_hand") for one in around]
    others = kicking.select([name for name in kicking.names if name not in ("left_hand", "head")])
    labels = (*others.names, "LWRA", "LWRB", "head", "LFHD")
    head = kicking.path("head")
    positions = np.concatenate([others.positions, np.stack([*hands, head, head + 50], axis=1)], axis=1)
    table = replace(kicking, names=labels, positions=positions, confidence=np.ones((20, len(labels))))
    read = mimoc.read_points(mimoc.write_points(table, tmp_path / "a.csv"))
    assert np.allclose(read.path("left_wrist"), kicking.path("left_hand"))
    assert np.array_equal(read.path("head"), head)
    assert read.notes == ("left_wrist is taken to be at LWRA, LWRB", "left out: LFHD")
