"""What is said of some infants' movement."""

import json

import numpy as np
import pytest
from support.moving import moving, restless

from mimoc.movement import distance, measure_movement
from mimoc.movement.filming import Filmed
from mimoc.movement.real_infants import real_infants
from mimoc.movement.report import compare, measure_all

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
