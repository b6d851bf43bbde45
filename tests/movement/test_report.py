"""What is said of some infants' movement, on pages, in pictures and in plots."""

import json

import numpy as np
import pytest
from PIL import Image, ImageSequence
from support.filmed import in_space
from support.moving import moving, placed, restless

from mimoc.base.errors import MovementError, OutputError
from mimoc.base.quantities import QUANTITIES
from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.movement.filming import Filmed
from mimoc.movement.measured import measure_movement
from mimoc.movement.report import compare, measure_all
from mimoc.movement.sample import distance, real_infants
from mimoc.movement.stick_figures import animate, write_measures, write_phases

FILMS = [Filmed(restless(seed, 17.0)) for seed in range(3)]
OTHERS = [restless(seed, 17.0) for seed in range(3, 6)]


def test_means_are_over_the_infants_that_have_a_measure():
    measured = measure_all([Filmed(restless(0, 10.0)), Filmed(moving({}, 10.0))])
    first, second = measured.infants
    assert measured.means["hand_units_per_min"] == first["hand_units_per_min"] / 2
    assert "hand_unit_s" not in second
    assert measured.means["hand_unit_s"] == first["hand_unit_s"]
    assert (measured.scores, measured.distances, measured.distance) == ({}, (), None)


def test_real_infants_give_scores_and_about_how_well_infants_are_told_apart(generator):
    measured = compare(FILMS, real_infants(), generator)
    assert measured.distances[1] == distance(measure_movement(FILMS[1].seen), real_infants())
    assert measured.distance == distance(measured.means, real_infants())
    assert measured.apart is not None
    assert (measured.apart.exact, 0.5 < measured.apart.accuracy <= 1) == (False, True)


def test_recordings_give_the_exact_figure(generator):
    measured = compare(FILMS, OTHERS, generator)
    assert measured.apart is not None
    assert measured.apart.exact
    assert 0 <= measured.apart.deviation < 0.3
    assert measured.sample is not None
    assert (measured.sample.name, measured.sample.infants) == ("3 recordings", 3)


@pytest.mark.parametrize("films", [FILMS[:1], [Filmed(restless(seed, 7.0)) for seed in range(2)]])
def test_too_few_or_too_short_recordings_are_measured_but_not_told_apart(films, generator):
    measured = compare(films, real_infants(), generator)
    assert measured.apart is None
    assert "not told apart" in measured.notes[-1]
    assert measured.distance is not None


def test_it_is_plain_data(generator):
    data = json.loads(json.dumps(compare(FILMS, real_infants(), generator).to_data()))
    speed = data["measures"]["hand_speed_p95_trunk_s"]
    sample = {"sample_mean", "sample_sd", "sample_n", "score"}
    assert speed.keys() == {"label", "unit", "mean", "sd", "n", "infants", "left", "right"} | sample
    assert (data["spread_is_over"], speed["n"]) == ("infants", 3)
    assert speed["sd"] == pytest.approx(np.std(speed["infants"], ddof=1), rel=1e-4)
    assert speed["left"].keys() == {"mean", "sd", "n", "infants"}
    assert (speed["unit"], len(speed["infants"])) == ("trunk/s", 3)
    assert data["told_apart"].keys() == {"balanced_accuracy", "window_s", "windows", "exact", "sd_over_draws"}
    assert data["distance"].keys() == {"of_mean", "infants"}


def test_a_single_infant_has_the_spread_of_its_windows(generator):
    measured = compare(FILMS[:1], real_infants(), generator)
    windows = [measure_movement(FILMS[0].seen.window(start, start + 240)) for start in (0, 240)]
    for name in ("hand_units_per_min", "foot_speed_p95_trunk_s", "dimensions"):
        spread = measured.spreads[name]
        assert (spread.n, spread.sd) == (2, pytest.approx(np.std([one[name] for one in windows], ddof=1)))
    assert measured.spread_is_over == "windows of 8 s"
    assert len(measured.window_distances) == 2
    assert measured.side_spreads["left"]["hand_units_per_min"].n == 2


@pytest.mark.parametrize(("seconds", "over", "n"), [(9.0, "windows of 4 s", 2), (3.0, "infants", 1)])
def test_a_short_recording_has_the_spread_of_its_halves_or_none(seconds, over, n):
    measured = measure_all([Filmed(restless(0, seconds))])
    assert (measured.spread_is_over, measured.spreads["hand_burstiness"].n) == (over, n)
    assert (measured.spreads["hand_burstiness"].sd is None) == (n == 1)
    assert any("no spread is known" in note for note in measured.notes) == (n == 1)


def test_a_sample_of_short_recordings_is_compared_without_telling_apart(generator):
    measured = compare(FILMS, [restless(seed, 5.0) for seed in range(3)], generator)
    assert (measured.apart, "not told apart" in measured.notes[-1]) == (None, True)
    assert measured.distance is not None


def test_what_stands_in_for_what_is_a_note():
    recording = restless(0, 10.0)
    names = tuple(name.replace("hand", "wrist") for name in recording.names)
    measured = measure_all([Filmed(type(recording)("a", 30.0, names, recording.positions, recording.confidence))])
    assert [note.split(",")[0] for note in measured.notes] == [
        f"{side}_wrist stands in for {side}_hand" for side in ("left", "right")
    ]


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


def test_the_page_has_each_measure_with_its_unit_definition_and_source(request):
    page = (request.config.rootpath / "docs" / "movement_measures.md").read_text(encoding="utf-8")
    measures = [quantity for quantity in QUANTITIES.values() if quantity.over == "recording"]
    assert len(measures) >= 21
    for one in measures:
        assert f"| `{one.name}` | {one.label} | {one.unit or '-'} | {one.about} | {one.source or '-'} |" in page
