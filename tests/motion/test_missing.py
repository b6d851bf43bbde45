"""What is unsure, what zeros stand for and what jumps out of reach is not seen, and a note says how much that is."""

import json
from dataclasses import replace

import numpy as np
import pytest
from support.filmed import BODY_25_POINTS, coco_entries, filmed, in_space, write_coco, write_openpose

import mimoc
from mimoc.base.errors import RecordingError
from mimoc.motion.point_recording import PointRecording
from mimoc.plugin import MotionFormat

ENDS = "left_wrist", "right_wrist", "left_ankle", "right_ankle"


@pytest.fixture(scope="module")
def infant():
    return filmed(150, BODY_25_POINTS)


def unsure(recording, score: float, share: float = 0.04, *, wild: bool = True):
    """Return it with hands and feet of a low score in some frames, at places by chance or where they are, and which."""
    generator = np.random.default_rng(0)
    which = np.zeros(recording.confidence.shape, bool)
    columns = [recording.names.index(name) for name in ENDS]
    which[:, columns] = generator.random((recording.frames, len(columns))) < share
    places = generator.uniform(0, 480, recording.positions.shape) if wild else recording.positions
    positions = np.where(which[..., None], places, recording.positions)
    return replace(recording, positions=positions, confidence=np.where(which, score, 0.9)), which


def as_openpose(recording, folder):
    return write_openpose(recording, folder / "a")


def as_coco(recording, folder):
    return write_coco(recording, folder / "a.json")


def as_mmpose(recording, folder):
    entries = [
        {
            "frame_id": entry["image_id"],
            "instances": [
                {
                    "keypoints": np.reshape(entry["keypoints"], (-1, 3))[:, :2].tolist(),
                    "keypoint_scores": entry["keypoints"][2::3],
                }
            ],
        }
        for entry in coco_entries(recording)
    ]
    (folder / "a.json").write_text(json.dumps(entries))
    return folder / "a.json"


def as_table(recording, folder):
    return mimoc.write_points(recording, folder / "a.csv")


def as_deeplabcut(recording, folder):
    path = mimoc.write_points(recording, folder / "a.csv")
    path.write_text(path.read_text().replace("_confidence", "_likelihood"))
    return path


def as_mediapipe(recording, folder):
    path = mimoc.write_points(recording, folder / "a.csv")
    path.write_text(path.read_text().replace("_confidence", "_visibility"))
    return path


USUAL = [
    (as_openpose, 0.05),
    (as_coco, 0.3),
    (as_mmpose, 0.3),
    (as_table, 0.3),
    (as_deeplabcut, 0.6),
    (as_mediapipe, 0.5),
]


def gaps(recording, name: str) -> list[int]:
    return np.flatnonzero(np.isnan(recording.path(name)).any(axis=1)).tolist()


@pytest.mark.parametrize(("write", "usual"), USUAL)
def test_points_below_what_is_usual_in_a_format_are_not_seen(write, usual, infant, tmp_path):
    below, which = unsure(infant, usual - 0.01)
    read = mimoc.read_points(write(below, tmp_path), rate_hz=30)
    for name in ENDS:
        assert gaps(read, name) == np.flatnonzero(which[:, infant.names.index(name)]).tolist()
        assert (read.confidence[gaps(read, name), read.names.index(name)] == 0).all()
    said = f"points have a confidence below {usual:g}, and are taken not to be seen"
    assert sum(said in note for note in read.notes) == 1
    assert not any("jump" in note for note in read.notes)


@pytest.mark.parametrize(("write", "usual"), USUAL)
def test_points_from_there_on_are_seen(write, usual, infant, tmp_path):
    at, _ = unsure(infant, usual, wild=False)
    read = mimoc.read_points(write(at, tmp_path), rate_hz=30)
    assert not any(gaps(read, name) for name in ENDS)
    assert not any("confidence" in note for note in read.notes)


@pytest.mark.parametrize(("least", "is_seen"), [(0, True), (0.4, True), (0.41, False), (1, False)])
def test_what_is_unsure_is_for_users_to_say(least, is_seen, infant, tmp_path):
    some, which = unsure(replace(infant, confidence=np.ones_like(infant.confidence)), 0.4, 0.1, wild=False)
    some = replace(some, confidence=np.where(which, 0.4, 1.0))
    read = mimoc.read_points(mimoc.write_points(some, tmp_path / "a.npz"), min_score=least)
    assert bool(gaps(read, "left_wrist")) is not is_seen


def test_the_share_of_unsure_points_is_said(infant, tmp_path):
    some, which = unsure(infant, 0.02)
    read = mimoc.read_points(as_table(some, tmp_path))
    assert (
        f"{100 * which.mean():.2g} % of points have a confidence below 0.3, and are taken not to be seen" in read.notes
    )


@pytest.mark.parametrize("share", [0.025, 0.04, 0.2])
@pytest.mark.parametrize("score", [0.02, 0.0])
def test_a_low_score_is_as_good_as_none(score, share, infant, tmp_path):
    some, which = unsure(infant, score, share)
    read = mimoc.read_points(as_table(some, tmp_path)).select(infant.names)
    expected = np.where(which[..., None], np.nan, infant.positions)
    assert np.allclose(read.positions, expected, rtol=0, atol=1e-3, equal_nan=True)


def test_a_threshold_that_leaves_nothing_is_refused(infant, tmp_path):
    faint = replace(infant, confidence=np.full_like(infant.confidence, 0.2))
    said = r"has a confidence below 0\.3 at 100% of its points; if they can be trusted: min_score=0$"
    with pytest.raises(RecordingError, match=said):
        mimoc.read_points(as_table(faint, tmp_path))
    assert not any(gaps(mimoc.read_points(tmp_path / "a.csv", min_score=0), name) for name in ENDS)
    with pytest.raises(RecordingError, match=r"has no point with a confidence of 0\.3 or more; give a lower one: min_"):
        mimoc.read_points(as_coco(faint, tmp_path), rate_hz=30)


@pytest.mark.parametrize("least", [-0.1, 1.1, float("nan"), 60])
def test_a_threshold_is_from_0_to_1(least, tmp_path):
    with pytest.raises(RecordingError, match=rf"min_score={least:g} is no confidence; give one from 0 to 1$"):
        mimoc.read_points(tmp_path, min_score=least)


def test_the_threshold_holds_for_an_added_format(infant, registered, tmp_path):
    some, which = unsure(infant, 0.4, wild=False)
    (tmp_path / "a.dots").touch()
    with registered(MotionFormat("dots", "points", lambda path: path.suffix == ".dots", lambda path, options: some)):
        assert not gaps(mimoc.read_points(tmp_path / "a.dots"), "left_wrist")
        read = mimoc.read_points(tmp_path / "a.dots", min_score=0.5)
    assert gaps(read, "left_wrist") == np.flatnonzero(which[:, infant.names.index("left_wrist")]).tolist()


@pytest.mark.parametrize("score", [0.9, 1.0])
@pytest.mark.parametrize("share", [0.02, 0.1, 0.3])
def test_points_that_jump_out_of_reach_are_not_seen(share, score, infant, tmp_path):
    """However sure the estimator was; and the order of points is not blamed."""
    some, which = unsure(infant, score, share)
    read = mimoc.read_points(as_table(some, tmp_path))
    seen = np.isfinite(read.select(infant.names).positions).all(axis=-1)
    assert seen[which].mean() < 0.2  # Some places are within reach.
    assert seen[~which].mean() > 0.98
    (note,) = (note for note in read.notes if "jump" in note)
    assert note.startswith("points that jump to where no limb can be are taken not to be seen: ")


@pytest.mark.parametrize("frame", [0, 1, 70, 149])
def test_one_wild_point_is_a_gap(frame, infant, tmp_path):
    positions = infant.positions.copy()
    positions[frame, infant.names.index("left_ankle")] += [0, 1.2 * infant.trunk]
    read = mimoc.read_points(as_table(replace(infant, positions=positions), tmp_path))
    assert frame in gaps(read, "left_ankle")
    assert len(gaps(read, "left_ankle")) <= 2
    assert "points that jump to where no limb can be are taken not to be seen: left_ankle in " in " ".join(read.notes)


def test_a_hand_that_is_somewhere_else_for_a_while_is_a_gap(infant, tmp_path):
    """Such as that of an adult."""
    positions = infant.positions.copy()
    positions[60:80, infant.names.index("left_wrist")] = infant.positions[:20, infant.names.index("neck")] + [300, 0]
    read = mimoc.read_points(as_table(replace(infant, positions=positions), tmp_path))
    assert gaps(read, "left_wrist") == list(range(60, 80))


@pytest.mark.parametrize("rate_hz", [5, 25, 120])
def test_quick_movements_are_no_jumps(rate_hz, infant, tmp_path):
    """A body that swings by a trunk's length, at up to seven of them a second."""
    swing = 0.5 * infant.trunk * np.sin(14 * np.arange(150) / rate_hz)
    quick = replace(infant, positions=infant.positions + swing[:, None, None] * [0, 1], rate_hz=rate_hz)
    assert not any("jump" in note for note in mimoc.read_points(as_table(quick, tmp_path)).notes)


def with_zeros(recording: PointRecording, name: str, frames: list[int]) -> PointRecording:
    positions = recording.positions.copy()
    positions[frames, recording.names.index(name)] = 0
    return replace(recording, positions=positions)


def test_zeros_of_a_table_are_not_seen(infant, tmp_path):
    read = mimoc.read_points(as_table(with_zeros(infant, "left_knee", [3, 4, 90]), tmp_path))
    assert gaps(read, "left_knee") == [3, 4, 90]


def test_the_origin_of_a_table_is_a_point(tmp_path):
    space = in_space(60)
    centred = replace(space, positions=space.positions - space.positions[:, [space.names.index("neck")]])
    assert not gaps(mimoc.read_points(as_table(centred, tmp_path)), "neck")


def test_zeros_with_a_confidence_are_not_seen(infant, tmp_path):
    """As YOLO writes points that it is not sure of."""
    entries = coco_entries(infant)
    entries[8]["keypoints"][27:29] = [0, 0]
    (tmp_path / "a.json").write_text(json.dumps(entries))
    assert gaps(mimoc.read_points(tmp_path / "a.json", rate_hz=30), "left_wrist") == [8]


def test_points_of_annotations_that_are_not_labelled_are_not_seen(infant, tmp_path):
    """Their third number is 0, whatever their place; of hidden points, it is 1."""
    entries = coco_entries(infant)
    for entry in entries:
        entry["keypoints"][2::3] = [2] * 17
    entries[8]["keypoints"][29], entries[9]["keypoints"][29] = 0, 1
    (tmp_path / "a.json").write_text(json.dumps(entries))
    assert gaps(mimoc.read_points(tmp_path / "a.json", rate_hz=30), "left_wrist") == [8]


def write_c3d(recording, path, residual: float):
    """Write markers with a residual for all that are not zeros, and 0 for those."""
    import ezc3d

    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [recording.rate_hz]
    file["parameters"]["POINT"]["LABELS"]["value"] = list(recording.names)
    file["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    places = recording.positions.transpose(2, 1, 0) * 1000
    file["data"]["points"] = np.concatenate([places, np.ones((1, *places.shape[1:]))])
    file["data"]["meta_points"]["residuals"] = np.where(places.any(axis=0), residual, 0)[None]
    file.write(str(path))
    return path


@pytest.mark.parametrize("residual", [0.0, 1.0])
def test_zeros_of_c3d_are_not_seen(residual, tmp_path):
    space = with_zeros(in_space(60), "left_knee", [3, 4, 50])
    read = mimoc.read_points(write_c3d(space, tmp_path / "a.c3d", residual))
    assert gaps(read, "left_knee") == [3, 4, 50]
    assert not gaps(read, "right_knee")
    assert "not seen: left_knee in 5% of frames; the longest gap is 0.067 s" in read.notes
