"""What is wrong with a recording is one clear line: an error where it cannot be used, a note where it can."""

from dataclasses import replace

import numpy as np
import pytest
from support import filmed

import mimoc
from mimoc.base.errors import MimocError, RecordingError
from mimoc.motion.body_points import film
from mimoc.motion.labels import SIDES


def problem(path, **options) -> str:
    """Return what reading says, without the path."""
    with pytest.raises(MimocError) as caught:
        mimoc.read_points(path, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value).removeprefix(f"{path}: ")


def written(recording, tmp_path):
    return mimoc.write_points(recording, tmp_path / "a.npz")


def test_there_is_no_such_file(tmp_path):
    assert problem(tmp_path / "none") == "there is no such file or folder; check the path"
    assert problem(tmp_path / "none", format="csv") == "there is no such file or folder; check the path"


def test_a_path_that_no_file_has():
    assert problem("x" * 5000) == "cannot be read (File name too long); check the path and its permissions"
    assert problem("a\nb").endswith("a?b: there is no such file or folder; check the path")


def test_an_empty_folder(tmp_path):
    assert problem(tmp_path) == "the folder is empty; give the one with the files of the pose estimator"


def test_a_format_that_is_not_recognised(tmp_path):
    (tmp_path / "a.mp4").write_bytes(b"film")
    reason = (
        "is in no format that mimoc recognises; give its format: openpose, mediapipe, coco, mini_rgbd, csv, npz, c3d"
    )
    assert problem(tmp_path / "a.mp4") == reason
    assert problem(tmp_path) == reason


def test_a_format_or_a_view_that_does_not_exist(tmp_path):
    assert (
        problem(tmp_path, format="opnpose") == "'opnpose' is not a format of recorded points; did you mean 'openpose'?"
    )
    assert problem(tmp_path, view="bck") == "'bck' is not a view; did you mean 'back'?"


def test_a_folder_read_in_another_format(body_25, tmp_path):
    folder = filmed.write_openpose(body_25, tmp_path / "film")
    assert problem(folder, format="mini_rgbd").startswith("has no folder joints_2Ddep or joints_3D")
    assert problem(folder, format="csv").startswith("cannot be read")


def test_damaged_json_is_named(body_25, tmp_path):
    folder = filmed.write_openpose(body_25, tmp_path / "film")
    (folder / f"film_{7:012d}_keypoints.json").write_text('{"people": [')
    expected = (
        f"film_{7:012d}_keypoints.json: is damaged JSON (EOF while parsing a list at line 1 column 12); export it again"
    )
    assert problem(folder, rate_hz=30) == expected


def test_points_of_another_number_are_named(body_25, tmp_path):
    folder = filmed.write_openpose(body_25, tmp_path / "film")
    name = f"film_{7:012d}_keypoints.json"
    (folder / name).write_text('{"people": [{"pose_keypoints_2d": [1, 2, "three"]}]}')
    assert problem(folder, rate_hz=30) == f"{name}: points are not numbers; export it again"
    (folder / name).write_text('{"people": [{"pose_keypoints_2d": [1, 2, 1]}]}')
    assert problem(folder, rate_hz=30) == f"{name}: points are not 75 numbers; export it again"


def test_no_frame_rate(body_25, tmp_path):
    folder = filmed.write_openpose(body_25, tmp_path / "film")
    assert problem(folder) == "has no frame rate; say how many frames a second the camera took: rate_hz=30"


@pytest.mark.parametrize("rate_hz", [0, -30, 1e9, float("nan"), float("inf")])
def test_a_frame_rate_of_no_camera(rate_hz, kicking, tmp_path):
    assert "frames a second; give a frame rate from 1 to 1000" in problem(written(kicking, tmp_path), rate_hz=rate_hz)


def test_a_frame_rate_that_is_given_against_the_files_own(kicking, tmp_path):
    read = mimoc.read_points(written(kicking, tmp_path), rate_hz=60)
    assert read.rate_hz == 60
    assert read.notes == ("its own frame rate is 30, and not 60 frames/s, as was given",)


def test_one_frame(kicking, tmp_path):
    path = written(kicking.window(0, 1), tmp_path)
    assert problem(path) == "has one frame, and no movement; give all frames of a film"


def test_no_trunk(kicking, tmp_path):
    path = written(kicking.select(["head", "left_knee", "right_hip"]), tmp_path)
    expected = "has no neck, left_hip, only head; left_knee; right_hip; name its points: names={'label': 'neck'}"
    assert problem(path) == expected


def test_labels_that_mean_nothing(kicking, tmp_path):
    path = written(replace(kicking, names=tuple(f"p{index}" for index in range(14))), tmp_path)
    expected = "no label is the name of a point (p0; p1; p2; p3; p4; and 9 more); say what they are"
    assert problem(path) == f"{expected}: names={{'label': 'left_hip'}}"


def test_names_that_do_not_exist(kicking, tmp_path):
    path = written(kicking, tmp_path)
    assert problem(path, names={"head": "hed"}) == "'hed' is not a point; did you mean 'head'?"
    assert problem(path, names={"haed": "head"}).startswith(
        "has no point 'haed', which is given a name; did you mean 'head'"
    )


def test_a_trunk_that_is_hardly_seen(kicking, tmp_path):
    positions = kicking.positions.copy()
    positions[3:, kicking.names.index("neck")] = np.nan
    path = written(replace(kicking, positions=positions), tmp_path)
    assert problem(path) == "shows neck and hips in 5% of its frames; choose another view of the infant"


def test_shares_of_the_picture_instead_of_pixels(kicking, tmp_path):
    path = written(replace(kicking, positions=kicking.positions / 640), tmp_path)
    assert problem(path).endswith("export pixels, not shares of the picture")


def test_millimetres_instead_of_metres(in_space, tmp_path):
    path = written(replace(in_space, positions=1000 * in_space.positions), tmp_path)
    assert problem(path).endswith("m long; export positions in metres")


def test_a_wrong_order_of_points(kicking, tmp_path):
    path = written(replace(kicking, names=kicking.names[::-1]), tmp_path)
    reason = problem(path)
    assert "trunks apart, on infants" in reason
    assert reason.endswith("its points may be in another order: say what its labels are: names={'label': 'left_hip'}")


@pytest.mark.parametrize("pair", [("left_hip", "left_knee"), ("right_elbow", "right_hand")])
def test_points_on_a_limb_that_have_each_others_names_are_a_note(pair, kicking, tmp_path):
    other = dict(zip(pair, pair[::-1], strict=True))
    wrong = replace(kicking, names=tuple(other.get(name, name) for name in kicking.names))
    read = mimoc.read_points(written(wrong, tmp_path))
    assert read.notes == (f"these move more: {pair[0]} than {pair[1]}; they may be called each other's name",)


def exchanged(recording, start: int, stop: int, limbs=("hip", "knee", "foot")):
    names = list(recording.names)
    left, right = ([names.index(f"{side}_{part}") for part in limbs] for side in SIDES)
    positions = recording.positions.copy()
    positions[start:stop, left + right] = positions[start:stop, right + left]
    return replace(recording, positions=positions)


@pytest.mark.parametrize("limbs", [("hip", "knee", "foot"), ("shoulder", "elbow", "hand")])
@pytest.mark.parametrize(("start", "stop"), [(0, 9), (20, 21), (50, 60)])
def test_sides_that_are_exchanged_in_some_frames_are_put_right(start, stop, limbs, kicking, tmp_path):
    read = mimoc.read_points(written(exchanged(kicking, start, stop, limbs), tmp_path))
    assert np.array_equal(read.positions, kicking.select(read.names).positions)
    limb = "legs" if "hip" in limbs else "arms"
    assert read.notes == (f"left and right {limb} were exchanged in {stop - start} frames, and are put right",)


def test_sides_that_are_exchanged_beside_gaps_are_put_right(kicking, tmp_path):
    gappy = replace(kicking, positions=kicking.positions.copy())
    gappy.positions[18:22, kicking.names.index("left_knee")] = np.nan
    read = mimoc.read_points(written(exchanged(gappy, 20, 30), tmp_path))
    assert np.array_equal(read.positions, gappy.select(read.names).positions, equal_nan=True)


FROM_BEHIND = (
    "shows an infant from behind: if it lies on its belly give view='back', if the picture is mirrored or y counts "
    "upwards view='mirrored', if left and right are exchanged view='swapped'"
)


def test_an_infant_from_behind_can_be_read_as_that(kicking, tmp_path):
    path = written(replace(kicking, positions=kicking.positions * [-1, 1] + [640, 0]), tmp_path)
    assert problem(path) == FROM_BEHIND
    read = mimoc.read_points(path, view="back")
    assert read.notes == ()
    assert np.allclose(read.path("neck"), [640, 0] + kicking.path("neck") * [-1, 1])


@pytest.mark.parametrize("axis", [0, 1])
def test_a_mirrored_picture_is_put_right(axis, kicking, tmp_path):
    """But for half a turn, if y counts upwards."""
    positions = kicking.positions.copy()
    positions[..., axis] = 500 - positions[..., axis]
    path = written(replace(kicking, positions=positions), tmp_path)
    assert problem(path) == FROM_BEHIND
    read = mimoc.read_points(path, view="mirrored").select(kicking.names)
    ways, others = (np.diff(one.positions, axis=0) for one in (read, kicking))
    assert np.allclose(ways, others if axis == 0 else -others)


def test_legs_that_are_exchanged_throughout(kicking, tmp_path):
    path = written(exchanged(kicking, 0, 60), tmp_path)
    assert problem(path) == "has its left hip on the side of its right shoulder; check what is left and right"


def test_sides_that_are_exchanged_throughout_are_put_right(kicking, tmp_path):
    every = exchanged(kicking, 0, 60, ("shoulder", "elbow", "hand", "hip", "knee", "foot"))
    path = written(every, tmp_path)
    assert problem(path) == FROM_BEHIND
    read = mimoc.read_points(path, view="swapped")
    assert np.array_equal(read.select(kicking.names).positions, kicking.positions)


def test_an_infant_that_turns_over_is_a_note(kicking, tmp_path):
    half = kicking.positions.copy()
    half[45:] = half[45:] * [-1, 1] + [640, 0]
    read = mimoc.read_points(written(replace(kicking, positions=half), tmp_path))
    assert read.notes == ("the infant is seen from behind, or left and right are exchanged, in 25% of frames",)


def test_a_picture_that_is_turned_is_no_problem(kicking, tmp_path):
    assert mimoc.read_points(written(replace(kicking, positions=640 - kicking.positions), tmp_path)).notes == ()


KNEES = (
    "has knees that bend backwards: left and right are exchanged (view='swapped'), or the picture or an axis is "
    "mirrored (view='mirrored')"
)


def test_knees_say_whether_space_is_mirrored(in_space, tmp_path):
    path = written(replace(in_space, positions=in_space.positions * [1, 1, -1]), tmp_path)
    assert problem(path) == KNEES
    assert mimoc.read_points(path, view="mirrored").notes == ()


def test_knees_say_whether_a_picture_with_depth_is_mirrored(tmp_path):
    deep = film(filmed.kicking_model(), filmed.kicking(60), 30)
    mirrored = replace(deep, positions=deep.positions * [-1, 1] + [2 * deep.camera.centre_px[0], 0])
    path = written(mirrored, tmp_path)
    assert problem(path) == KNEES
    assert np.allclose(mimoc.read_points(path, view="mirrored").select(deep.names).positions, deep.positions)


TURNS = {
    "-z": lambda p: p * [1, -1, -1],
    "y": lambda p: p[..., [0, 2, 1]] * [1, 1, -1],
    "-y": lambda p: p[..., [0, 2, 1]] * [1, -1, 1],
    "x": lambda p: p[..., [2, 1, 0]] * [1, 1, -1],
    "-x": lambda p: p[..., [2, 1, 0]] * [-1, 1, 1],
}


@pytest.mark.parametrize("write", ["a.npz", "a.csv", "a.c3d"])
@pytest.mark.parametrize("up", TURNS)
def test_an_infant_in_space_that_does_not_lie_on_its_back_is_asked_about(up, write, in_space, tmp_path):
    """The answer is the option that the question names."""
    turned = replace(in_space, positions=TURNS[up](in_space.positions))
    path = (
        filmed.write_c3d(turned, tmp_path / write) if write == "a.c3d" else mimoc.write_points(turned, tmp_path / write)
    )
    how = (
        "lies face down: give view='back' if it lies on its belly, or"
        if up == "-z"
        else "does not lie on its back: give"
    )
    reason = problem(path)
    assert reason.startswith(how)
    assert f"up='{up}' if that axis points upwards" in reason
    read = mimoc.read_points(path, up=up).select(in_space.names)
    assert np.allclose(read.positions, in_space.positions, atol=1e-6)
    assert read.notes == ()


def test_an_infant_in_space_on_its_belly_is_said_to_be(in_space, tmp_path):
    prone = replace(in_space, positions=in_space.positions * [1, -1, -1])
    assert mimoc.read_points(written(prone, tmp_path), view="back").notes == ()
    supine = written(in_space, tmp_path)
    assert problem(supine, view="back").startswith("lies face up: give view='front' if it lies on its back, or up='-z'")


def test_an_infant_that_sits_is_said_to_have_its_z_axis_upwards(in_space, tmp_path):
    sits = written(replace(in_space, positions=TURNS["y"](in_space.positions)), tmp_path)
    assert problem(sits).endswith("or up='z' if it sits, stands or lies on its side")
    assert np.array_equal(mimoc.read_points(sits, up="z").path("neck"), TURNS["y"](in_space.path("neck")))


def test_nobody_hangs_head_down(in_space, tmp_path):
    along = in_space.path("neck") - in_space.hips
    axis = int(np.argmax(np.abs(along[0])))
    turned = in_space.positions[..., [(axis + 1) % 3, (axis + 2) % 3, axis]] * [1, 1, -np.sign(along[0, axis])]
    assert problem(written(replace(in_space, positions=turned), tmp_path), up="z") == (
        "hangs head down: give up='-z' if that axis points upwards"
    )


@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_places_that_are_shares_of_a_picture_are_not_metres(suffix, in_space, tmp_path):
    """With a third axis, they are refused as without; columns that name metres are believed."""
    shares = (in_space.positions - in_space.positions.min()) / np.ptp(in_space.positions)
    path = mimoc.write_points(replace(in_space, positions=shares), tmp_path / f"a.{suffix}")
    assert mimoc.read_points(path).unit == "m"
    if suffix == "csv":
        path.write_text(path.read_text().replace("_m,", ","))
        assert problem(path).endswith("or export pixels, not shares of the picture")
        assert mimoc.read_points(path, picture_px=(640, 480), view="back").unit == "px"


def test_a_prone_infant_with_depth_is_no_problem(tmp_path):
    """It is seen from behind, but its knees bend as knees do."""
    qpos = filmed.kicking(60)
    qpos[:, 3:7] = filmed.SUPINE * [1, 1, -1, 1]
    deep = film(filmed.kicking_model(), qpos, 30)
    assert mimoc.read_points(written(deep, tmp_path)).notes == ()
    flat = written(replace(deep, depth_m=None), tmp_path)
    assert problem(flat) == FROM_BEHIND


def two(body_25, tmp_path, **options):
    small = replace(body_25, positions=body_25.positions / 2 + 300)
    folder = filmed.write_openpose(body_25, tmp_path / "film", (small,))
    read = mimoc.read_points(folder, rate_hz=30, **options)
    return read, small if options else body_25


@pytest.mark.parametrize("options", [{}, {"infant": 0}, {"infant": "0"}])
def test_of_several_persons_the_largest_is_taken_or_the_one_that_is_asked_for(options, body_25, tmp_path):
    read, expected = two(body_25, tmp_path, **options)
    read, expected = (filmed.without_neck(recording) for recording in (read, expected))
    assert np.allclose(read.positions, expected.select(read.names).positions, rtol=0, atol=1e-3)
    who = "number 0" if options else "the largest"
    first = f"film_{0:012d}_keypoints.json"
    assert read.notes[0] == f"the infant is taken to be {who} of 2 persons in {first}, and is followed from there"


def test_a_person_that_is_not_there(body_25, tmp_path):
    two(body_25, tmp_path)
    assert problem(tmp_path / "film", rate_hz=30, infant=2).endswith("_keypoints.json; give 0 to 1")
    alone = filmed.write_openpose(body_25, tmp_path / "alone")
    assert problem(alone, rate_hz=30, infant=1) == "has one person in each frame, and no infant '1'; leave it out"


def test_persons_that_are_tracked_have_identities(body_25, tmp_path):
    small = replace(body_25, positions=body_25.positions / 2 + 300)
    entries = [*filmed.coco_entries(small, track_id=3), *filmed.coco_entries(body_25, track_id=8)]
    (tmp_path / "a.json").write_text(str(entries).replace("'", '"'))
    read = mimoc.read_points(tmp_path / "a.json", rate_hz=30)
    assert read.notes[0] == "the infant is taken to be '8', the largest of 2 persons"
    assert np.allclose(read.path("nose"), body_25.path("nose"), rtol=0, atol=1e-3)
    read = mimoc.read_points(tmp_path / "a.json", rate_hz=30, infant=3)
    assert np.allclose(read.path("nose"), small.path("nose"), rtol=0, atol=1e-3)
    assert problem(tmp_path / "a.json", rate_hz=30, infant=5) == "has no person '5'; choose from 3, 8"


def test_nobody(tmp_path):
    for frame in range(3):
        (tmp_path / f"{frame}_keypoints.json").write_text('{"people": []}')
    assert problem(tmp_path, rate_hz=30) == "has nobody in any frame; check that the pose estimator sees the infant"


def test_two_recordings_in_one_folder(body_25, tmp_path):
    folder = filmed.write_openpose(body_25, tmp_path / "film")
    for path in sorted(folder.iterdir())[:3]:
        path.with_name(path.name.replace("film", "other")).write_bytes(path.read_bytes())
    assert problem(folder, rate_hz=30).endswith("have the same number; give a folder with one recording")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "has no rows below its first line, which names the columns; check what was exported"),
        (
            "scorer,n\nindividuals,a",
            "has a row 'scorer', but no rows 'bodyparts' and 'coords' below it; export it again",
        ),
        ("a,b\n1,2", "has no points in columns such as neck_x and neck_y (a; b); name its columns so"),
        ("neck_x,neck_y\n1", "row 2 has 1 cell, not 2 as the first; export it again"),
        ("neck_x,neck_x,neck_y\n1,2,3", "has the column neck_x twice; keep one infant, and each column once"),
        (
            "neck_x,neck_y\n1,a",
            "'a' in the column neck_y is not a number; leave cells of unseen points empty",
        ),
        (
            "frame,neck_x,neck_y\n2,1,1\n1,1,1",
            "has frames without a number, or in no order; sort it by frames",
        ),
        ("time_s,neck_x,neck_y\n0,1,1\n0,1,1", "has times that do not rise from row to row; check the column of times"),
        ("x,y\n1,2", "has x and y, but no columns 'frame' and 'point'; add them, or name columns neck_x ..."),
        ("frame,point,x,y\n0,neck,1,2\n0,neck,1,2", "has a point twice in a frame; keep one infant only"),
        (
            "frame,neck_x,neck_y\n0,1,1\n900000000,1,1\n900000001,1,1",
            "frames are numbered up to 900,000,001; mimoc reads up to 262,144: cut it",
        ),
    ],
)
def test_tables_that_cannot_be_read(text, reason, tmp_path):
    (tmp_path / "a.csv").write_text(text)
    assert problem(tmp_path / "a.csv", rate_hz=30) == reason


def test_no_note_and_no_warning_of_a_good_recording(kicking, tmp_path):
    assert mimoc.read_points(written(kicking, tmp_path)).notes == ()


def test_a_name_that_points_cannot_be_written_to(kicking, tmp_path):
    with pytest.raises(MimocError, match=r"a\.txt: not a name for points; end it in \.npz or \.csv"):
        mimoc.write_points(kicking, tmp_path / "a.txt")
    assert list(tmp_path.iterdir()) == []


def test_links_are_not_followed(kicking, body_25, tmp_path):
    path = written(kicking, tmp_path)
    (tmp_path / "b.npz").symlink_to(path)
    assert problem(tmp_path / "b.npz") == "is a link, which mimoc never writes"
    folder = filmed.write_openpose(body_25, tmp_path / "film")
    one = sorted(folder.iterdir())[4]
    content = one.read_bytes()
    one.unlink()
    (tmp_path / "elsewhere.json").write_bytes(content)
    one.symlink_to(tmp_path / "elsewhere.json")
    assert problem(folder, rate_hz=30) == f"{one.name} is a link, which mimoc never writes"


@pytest.mark.parametrize("name", ["a.csv", "a.json", "a.npz", "a.c3d"])
def test_a_file_that_is_too_large(name, tmp_path):
    with (tmp_path / name).open("wb") as file:
        file.truncate(2**27 + 1)
    assert problem(tmp_path / name) == "is larger than 128 MB, the most that mimoc reads; cut it"


@pytest.mark.parametrize(("frames", "rate_hz"), [(1, 30), (2, 30), (9, 30), (10, 30), (60, 12), (60, 1)])
def test_what_is_short_or_slow_can_be_smoothed(frames, rate_hz, kicking):
    smooth = replace(kicking.window(0, frames), rate_hz=rate_hz).smoothed()
    assert smooth.positions.shape == (frames, 14, 2)
    assert np.isfinite(smooth.positions).all()


def test_pickles_are_not_read(tmp_path):
    np.savez(tmp_path / "a.npz", positions=np.array([{}], dtype=object), allow_pickle=True)
    assert problem(tmp_path / "a.npz").endswith("is not as mimoc.write_points writes it, or damaged; write it again")


def test_a_recording_error_is_what_users_catch(tmp_path):
    with pytest.raises(RecordingError):
        mimoc.read_points(tmp_path)
