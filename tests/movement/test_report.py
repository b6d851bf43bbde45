"""What is said of some infants' movement."""

import json

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
    assert speed.keys() == {"label", "unit", "mean", "infants", "left", "right", "sample_mean", "sample_sd", "score"}
    assert (speed["unit"], len(speed["infants"])) == ("trunk/s", 3)
    assert data["told_apart"].keys() == {"balanced_accuracy", "window_s", "exact", "sd_over_draws"}
    assert data["distance"].keys() == {"of_mean", "infants"}


def test_what_stands_in_for_what_is_a_note():
    recording = restless(0, 10.0)
    names = tuple(name.replace("hand", "wrist") for name in recording.names)
    measured = measure_all([Filmed(type(recording)("a", 30.0, names, recording.positions, recording.confidence))])
    assert [note.split(",")[0] for note in measured.notes] == [
        f"{side}_wrist stands in for {side}_hand" for side in ("left", "right")
    ]
