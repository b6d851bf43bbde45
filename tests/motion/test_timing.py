"""Times and numbers say when frames were: what jitters is resampled, and what is missing is a gap."""

import numpy as np
import pytest
from support import filmed

import mimoc
from mimoc.base.errors import RecordingError
from mimoc.motion.frame_files import frame_numbers, frame_places, numbers_of_files

FILM = filmed.filmed(90)
PIXELS_OF_A_FRAME = np.nanmax(np.abs(np.diff(FILM.positions, axis=0)))


def truth(rate_hz: float, frames: int):
    when = np.arange(FILM.frames) / FILM.rate_hz
    flat = FILM.positions.reshape(FILM.frames, -1)
    return np.stack([np.interp(np.arange(frames) / rate_hz, when, one) for one in flat.T], axis=1).reshape(
        frames, -1, 2
    )


def read(times, tmp_path, column="time_s", **options):
    path = filmed.write_times(FILM, np.asarray(times, dtype=float), tmp_path / "a.csv", column)
    return mimoc.read_points(path, **options)


def error(recording) -> float:
    """Return the largest difference from the truth, in pixels."""
    expected = truth(recording.rate_hz, recording.frames)
    order = [FILM.names.index(name) for name in recording.names]
    return float(np.nanmax(np.abs(recording.positions - expected[:, order])))


def phone(step: float, short: float = 0.5, every: int = 10):
    steps = np.where(np.arange(59) % every == 3, short * step, step)
    return np.concatenate([[0.0], np.cumsum(steps)])


@pytest.mark.parametrize("short", [0.5, 0.75, 0.9])
def test_times_that_jitter_are_resampled_by_time(short, tmp_path):
    generator = np.random.default_rng(0)
    steps = np.where(generator.random(59) < 0.2, short, 1.0) / 30
    recording = read(np.round(np.concatenate([[0], np.cumsum(steps)]), 4), tmp_path)
    assert recording.rate_hz == 30
    assert error(recording) < 0.2 * PIXELS_OF_A_FRAME
    assert any("resampled by time, at 30 frames/s, by which" in note for note in recording.notes)


def test_a_camera_that_slows_down_in_the_dark_has_no_gaps(tmp_path):
    recording = read(np.concatenate([np.arange(40) / 30, 40 / 30 + np.arange(20) / 20]), tmp_path)
    assert recording.rate_hz == 30
    assert np.isfinite(recording.positions).all()
    assert error(recording) < 0.5 * PIXELS_OF_A_FRAME


def test_interpolation_does_not_bridge_gaps(tmp_path):
    times = phone(1 / 30)
    recording = read(np.delete(times, range(20, 26)), tmp_path)
    gap = np.isnan(recording.path("neck")[:, 0]).nonzero()[0] / recording.rate_hz
    assert len(gap) == 6
    assert times[19] < gap[0] < gap[-1] < times[26]
    assert f"6 of {recording.frames} frames are missing" in recording.notes


def test_points_are_not_interpolated_from_those_that_are_not_seen(tmp_path):
    path = filmed.write_times(FILM, phone(1 / 30), tmp_path / "a.csv")
    rows = [row.split(",") for row in path.read_text().splitlines()]
    column = rows[0].index("left_hand_x")
    rows[31][column] = ""
    path.write_text("\n".join(map(",".join, rows)))
    recording = mimoc.read_points(path)
    around = np.isnan(recording.path("left_hand")[:, 0]).nonzero()[0] / 30
    assert 1 <= len(around) <= 2
    assert np.all(np.abs(around - phone(1 / 30)[30]) < 1 / 30)


@pytest.mark.parametrize(("rate_hz", "digits"), [(30, 2), (30, 3), (30, 6), (60, 2), (240, 3)])
def test_the_last_digit_of_times_is_no_jitter(rate_hz, digits, tmp_path):
    recording = read(np.round(np.arange(60) / rate_hz, digits), tmp_path)
    assert recording.rate_hz == pytest.approx(rate_hz, rel=0.01)
    assert recording.frames == 60
    assert recording.notes == ()


@pytest.mark.parametrize("column", ["time_ms", "timestamp_us", "time_ns", "Time [ms]", "timestamp", "time", "t"])
def test_the_unit_of_times_is_that_of_the_column_or_the_likely_one(column, tmp_path):
    size = {"us": 1e6, "ns": 1e9}.get(column[-2:], 1e3)
    path = filmed.write_times(FILM, np.arange(60) / 30, tmp_path / "a.csv")
    header, *rows = path.read_text().splitlines()
    cells = [row.split(",") for row in rows]
    rows = [",".join([repr(round(float(time) * size + 1.7e12)), *others]) for time, *others in cells]
    path.write_text("\n".join([header.replace("time_s", column), *rows]))
    recording = mimoc.read_points(path)
    assert (round(recording.rate_hz), recording.frames) == (30, 60)
    is_said = "s" in column[-3:] and column not in ("times", "timestamp", "time")
    assert recording.notes == (() if is_said else ("times are taken for milliseconds",))


def test_times_of_day_are_read(tmp_path):
    path = filmed.write_times(FILM, np.arange(40) / 25, tmp_path / "a.csv", "time")
    header, *rows = path.read_text().splitlines()
    times = [
        f"2024-01-31 10:59:{59 + frame // 25 - 60 * (frame >= 25):02d}.{frame % 25 * 40:03d}" for frame in range(40)
    ]
    times = [time.replace("10:59", "11:00") if frame >= 25 else time for frame, time in enumerate(times)]
    path.write_text(
        "\n".join([header, *(f"{time},{row.partition(',')[2]}" for time, row in zip(times, rows, strict=True))])
    )
    assert (mimoc.read_points(path).rate_hz, mimoc.read_points(path).frames) == (25, 40)


def test_whole_numbers_without_a_unit_are_those_of_frames(tmp_path):
    with pytest.raises(RecordingError, match="has no frame rate"):
        read(np.arange(60), tmp_path, "time")


def test_frame_numbers_beside_uneven_times_do_not_hide_them(tmp_path):
    path = filmed.write_times(FILM, phone(1 / 30), tmp_path / "a.csv")
    header, *rows = path.read_text().splitlines()
    path.write_text("\n".join([f"frame,{header}", *(f"{frame},{row}" for frame, row in enumerate(rows))]))
    recording = mimoc.read_points(path)
    assert error(recording) < 0.2 * PIXELS_OF_A_FRAME


def test_few_rows_at_the_time_of_the_row_before_are_left_out(tmp_path):
    times = np.arange(60) / 30
    times[20] = times[19]
    recording = read(times, tmp_path)
    assert recording.notes[:2] == ("left out: 1 row at the time of the row before", "1 of 60 frames are missing")


@pytest.mark.parametrize("change", [lambda t: t[::-1], lambda t: t // 0.5, lambda t: np.where(t == t[7], np.nan, t)])
def test_times_that_do_not_rise_are_refused(change, tmp_path):
    with pytest.raises(RecordingError, match="has times that do not rise from row to row"):
        read(change(np.arange(60) / 30), tmp_path)


@pytest.mark.parametrize("times", [[0, 1e300, 2e300], [0, 1 / 30, 1e9], [0, 1e-300, 1]])
def test_times_of_no_film_are_one_line(times, tmp_path):
    with pytest.raises(RecordingError):
        read(times, tmp_path)


@pytest.mark.parametrize(
    "name",
    [
        "img{0:04d}_cam2",
        "cam2_{0:04d}",
        "2024-01-01_{0:04d}",
        "{0}_of_90",
        "take3_{0}_1920x1080",
        "frame_{0:05d}_{1}",
        "{1}_{0}",
        "2024-01-01_10-59-59_{0}",
    ],
)
def test_frames_are_numbered_by_the_number_that_rises(name):
    frames = range(8, 13)
    names = [name.format(frame, 1700000000000 + 33 * frame) for frame in frames]
    assert frame_numbers(names) == [*frames]


def test_dates_with_times_of_day_are_numbers():
    names = [f"2024-01-31_23-59-59.{ms:03d}" for ms in (900, 933, 967)] + [
        f"2024-02-01_00-00-00.{ms:03d}" for ms in (0, 33)
    ]
    assert np.diff(frame_numbers(names)).tolist() == [33000, 34000, 33000, 33000]
    assert frame_places(frame_numbers(names), names)[0] == (0, 1, 2, 3, 4)


def test_time_stamps_in_names_are_frames_with_gaps():
    stamps = 1700000000000 + np.delete(np.cumsum([33, 34, 33] * 10), [4, 5])
    places, notes = frame_places(stamps.tolist(), [*map(str, stamps)])
    assert places == (0, 1, 2, 3, *range(6, 30))
    assert notes == (
        "numbers of frames rise by about 33, as time stamps do, and are divided by that",
        "2 of 30 frames are missing",
    )


def test_frames_in_folders_of_their_own_are_numbered_by_these():
    assert numbers_of_files(["day2/0001/cam.jpg", "day2/0002/cam.jpg"]) == [1, 2]


def test_two_cameras_are_not_one_film(body_25, tmp_path):
    folder = filmed.write_openpose(body_25, tmp_path / "film")
    for camera in (1, 2):
        for frame, path in enumerate(sorted(folder.glob("film*"))[:20]):
            path.rename(folder / f"cam{camera}_{frame:03d}_keypoints.json")
    with pytest.raises(RecordingError, match="have the same number; give a folder with one recording"):
        mimoc.read_points(folder, rate_hz=30)
