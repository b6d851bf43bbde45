"""A camera that looks down at an angle is taken as given, or as the trunk is foreshortened; straight down otherwise."""

from dataclasses import replace

import numpy as np
import pytest
from support.retargeting import FRAMES, RATE_HZ, child, known_motions, slanted

import mimoc
from mimoc.base.errors import RecordingError, UnknownNameError
from mimoc.motion.body_points import film, locate
from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.movement.retargeting.sizes import lengths_of
from mimoc.movement.retargeting.start import STRAIGHT, pitch_of


@pytest.fixture(scope="module")
def qpos():
    """Return a motion of the average child of three months, shape (t, nq)."""
    return known_motions.known_motion(child().model, np.random.default_rng(2), FRAMES, RATE_HZ)


def flat(qpos, pitch_deg, **options):
    return replace(slanted(child().model, qpos, pitch_deg, **options), depth_m=None)


@pytest.mark.parametrize("turned_deg", [0, 90, 135, 180])
@pytest.mark.parametrize("pitch_deg", [30, 45])
def test_a_slanted_camera_is_found_however_the_infant_lies_in_its_picture(qpos, pitch_deg, turned_deg):
    pitch = pitch_of(flat(qpos, pitch_deg, turned_deg=turned_deg), child().model, None)
    assert pitch.deg.value == pytest.approx(pitch_deg, abs=8)
    assert pitch.deg.contains(pitch_deg)
    assert "--camera-pitch" in pitch.note


def test_a_slanted_camera_is_found_above_an_infant_on_its_belly(qpos):
    prone = qpos.copy()
    prone[:, 3:7] = [np.cos(np.pi / 4), 0, np.sin(np.pi / 4), 0]
    assert pitch_of(flat(prone, 45), child().model, None).deg.contains(45)


@pytest.mark.parametrize("turned_deg", [0, 60, 90])
def test_a_camera_that_looks_straight_down_is_not_taken_for_a_slanted_one(qpos, turned_deg):
    assert pitch_of(flat(qpos, 90, turned_deg=turned_deg), child().model, None).note == STRAIGHT


def test_an_infant_who_rolls_is_not_taken_for_one_of_a_slanted_camera(qpos):
    rolled = qpos.copy()
    rolled[:, 3:7] = [np.cos(np.pi / 4), 0, 0, np.sin(np.pi / 4)]  # On its side.
    assert pitch_of(flat(rolled, 90), child().model, None).note == STRAIGHT


@pytest.mark.full
def test_sizes_and_height_come_back_with_the_pitch_that_is_given(qpos):
    """With depth all of a slanted camera is known: a wrong frame of reference would show."""
    model, names = child().model, MINI_RGBD_POINTS
    result = mimoc.retarget(slanted(model, qpos, 45, names), 3.0, camera_pitch_deg=45)
    assert result.account.error_share < 0.01
    assert result.account.camera_pitch_deg.value == 45
    trunk = result.account.lengths_m["trunk"]
    assert trunk.value == pytest.approx(lengths_of(model)["trunk"], rel=0.02)
    middle_m = locate(model, qpos, names)[..., 2].mean()
    assert result.camera_height_m == pytest.approx(middle_m + np.sin(np.pi / 4), abs=0.02)


@pytest.mark.parametrize(
    ("pitch_deg", "message"), [(0.0, "above 0 and up to 90"), (91.0, "up to 90"), (1.0, "above the horizon")]
)
def test_an_impossible_pitch_is_refused(qpos, pitch_deg, message):
    with pytest.raises(RecordingError, match=message):
        pitch_of(flat(qpos, 90, turned_deg=90), child().model, pitch_deg)


def test_points_in_space_have_no_camera(qpos):
    seen = film(child().model, qpos, RATE_HZ)
    space = replace(seen, positions=locate(child().model, qpos, seen.names), camera=None, depth_m=None)
    with pytest.raises(RecordingError, match="have no camera"):
        pitch_of(space, child().model, 45)


def lying(qpos, roll: float) -> mimoc.PointRecording:
    """Return the points of the infant, turned about the axis from its left to its right, with depth."""
    turned = qpos.copy()
    turned[:, 3:7] = [np.cos(roll / 2), 0, np.sin(roll / 2), 0]
    return film(child().model, turned, RATE_HZ)


@pytest.mark.full
def test_an_infant_who_lies_the_other_way_round_than_is_said_is_asked_about(qpos):
    down, up = lying(qpos, np.pi / 2), lying(qpos, -np.pi / 2)
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "a", "age_months": 3, "scene": {"pose": "supine"}})
    for options in ({}, {"spec": spec}):
        with pytest.raises(RecordingError, match="comes out face down in 100%"):
            mimoc.retarget(down, 3.0, **options)
    with pytest.raises(RecordingError, match="comes out face up"):
        mimoc.retarget(up, 3.0, pose="prone")
    with pytest.raises(RecordingError, match="comes out face down"):
        mimoc.retarget(replace(down, depth_m=None), 3.0, pose="supine")
    with pytest.raises(UnknownNameError, match="sideways"):
        mimoc.retarget(up, 3.0, pose="sideways")
