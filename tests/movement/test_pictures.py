"""Stick figures side by side, and plots of measures and of hip and knee."""

import numpy as np
import pytest
from PIL import Image, ImageSequence
from support.filmed import in_space
from support.moving import placed, restless

from mimoc.base.errors import MovementError, OutputError
from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.movement.filming import Filmed
from mimoc.movement.real_infants import real_infants
from mimoc.movement.report import compare, measure_all
from mimoc.movement.stick_figures import animate, write_measures, write_phases

BLUE, RED = (51, 102, 154), (200, 67, 31)


def frames(path) -> np.ndarray:
    with Image.open(path) as image:
        return np.stack([np.asarray(frame.convert("RGB")) for frame in ImageSequence.Iterator(image)]).astype(int)


def shows(picture: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    return (np.abs(picture - colour) < 30).all(axis=-1)


def test_figures_stand_side_by_side_as_long_as_the_shortest(tmp_path):
    recordings = [restless(0, 3.0), restless(1, 2.0), in_space(90)]
    pictures = frames(animate(recordings, tmp_path / "three.gif", size_px=100))
    assert pictures.shape[0] == 30
    assert pictures.shape[2] >= 300
    assert [shows(pictures[5][:, start : start + 106], BLUE).any() for start in (0, 106, 212)] == [True] * 3


def test_heads_are_up_however_the_camera_is_turned(tmp_path):
    recording = restless(0, 2.0)
    for quarter in range(4):
        sine, cosine = np.sin(np.pi / 2 * quarter), np.cos(np.pi / 2 * quarter)
        turned = placed(recording, recording.positions @ np.array([[cosine, sine], [-sine, cosine]]))
        picture = frames(animate([turned], tmp_path / "one.gif", size_px=120))[0]
        assert np.argwhere(shows(picture, RED))[:, 1].mean() < np.argwhere(shows(picture, BLUE))[:, 1].mean()


def test_what_is_not_seen_is_not_drawn(tmp_path):
    recording = restless(0, 2.0)
    positions = recording.positions.copy()
    positions[:, [name.startswith("left_") and "hip" not in name for name in recording.names]] = np.nan
    pictures = frames(animate([placed(recording, positions)], tmp_path / "half.gif", size_px=100))
    whole = frames(animate([recording], tmp_path / "whole.gif", size_px=100))
    assert shows(pictures, BLUE).sum() < 0.5 * shows(whole, BLUE).sum()


def test_figures_can_be_in_rows_below_their_titles(tmp_path):
    pictures = frames(
        animate([restless(seed, 1.0) for seed in range(3)], tmp_path / "a.gif", "abc", columns=2, size_px=80)
    )
    assert pictures.shape[1] > 2 * 80
    assert pictures.shape[2] < 3 * 80


def test_no_recordings_and_too_many_are_refused(tmp_path):
    for recordings in ([], [restless(0, 1.0)] * 13):
        with pytest.raises(MovementError, match="choose 1 to 12"):
            animate(recordings, tmp_path / "a.gif")
    with pytest.raises(MovementError, match="has no neck"):
        animate([restless().select(["left_hip", "right_hip"])], tmp_path / "a.gif")
    with pytest.raises(OutputError, match="not a supported video format"):
        animate([restless(0, 1.0)], tmp_path / "a.png")
    assert [*tmp_path.iterdir()] == []


@pytest.mark.full
def test_measures_are_plotted_with_and_without_a_sample(tmp_path, generator):
    films = [Filmed(restless(seed, 10.0)) for seed in range(2)]
    write_measures(measure_all(films), tmp_path / "alone.png")
    write_measures(compare(films, real_infants(), generator), tmp_path / "beside.svg")
    assert "±" in (tmp_path / "beside.svg").read_text() or (tmp_path / "beside.svg").stat().st_size > 10_000
    assert (tmp_path / "alone.png").stat().st_size > 10_000


@pytest.mark.full
def test_titles_of_measures_end_within_their_plots(tmp_path):
    write_measures(measure_all([Filmed(restless(0, 10.0))]), tmp_path / "alone.png")
    with Image.open(tmp_path / "alone.png") as image:
        picture = np.asarray(image.convert("L")).astype(int)
    assert picture[:, -8:].min() == 255


def test_phases_need_places_in_space(tmp_path):
    space = in_space(90, MINI_RGBD_POINTS)
    write_phases([Filmed(restless(0, 3.0), space)], tmp_path / "phase.png")
    assert (tmp_path / "phase.png").stat().st_size > 5_000
    with pytest.raises(MovementError, match="--phase needs angles of hip and knee"):
        write_phases([Filmed(restless(0, 3.0))], tmp_path / "none.png")
