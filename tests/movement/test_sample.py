"""Samples of infants: aggregates of real ones, distances from a sample, and whether two groups are told apart."""

import numpy as np
import pytest
from support.moving import restless

from mimoc.base.errors import MovementError
from mimoc.base.movement_quantities import CORE, DETAILS
from mimoc.base.quantities import QUANTITIES
from mimoc.movement.sample import (
    FILES,
    Sample,
    Windows,
    accuracy_against_real,
    balanced_accuracy,
    distance,
    draw_windows,
    real_infants,
    real_windows,
    standard_scores,
    windows_of,
)


def drawn(seed: int, mean: float = 0.0, infants: int = 12) -> Windows:
    values = np.random.default_rng(seed).normal(mean, 1, (4 * infants, 21))
    return Windows(values, np.repeat(np.arange(infants), 4))


def test_windows_are_whole_and_know_their_infant():
    windows = windows_of([restless(0, 17.0), restless(1, 33.0)])
    assert windows.values.shape == (6, 21)
    assert windows.infants.tolist() == [0, 0, 1, 1, 1, 1]


def test_groups_that_are_far_apart_are_always_told_apart():
    assert balanced_accuracy(drawn(0), drawn(1, mean=4.0)) == 1


def test_groups_of_the_same_kind_are_told_apart_by_chance():
    scores = [balanced_accuracy(drawn(seed), drawn(100 + seed)) for seed in range(10)]
    assert np.mean(scores) == pytest.approx(0.5, abs=0.1)


def test_it_does_not_matter_which_group_is_first():
    first, second = drawn(0), drawn(1, mean=0.3)
    assert balanced_accuracy(first, second) == balanced_accuracy(second, first)


def test_units_of_measures_do_not_matter():
    first, second = drawn(0), drawn(1, mean=0.3)
    scales = np.logspace(-2, 2, 21)
    scaled = (Windows(group.values * scales + 7, group.infants) for group in (first, second))
    assert balanced_accuracy(*scaled) == balanced_accuracy(first, second)


def test_an_infant_that_differs_from_its_group_does_not_teach_the_classifier_itself():
    """Infants that differ by what they alone do are not told apart, though their windows are alike."""
    generator = np.random.default_rng(0)
    groups = [
        Windows(np.repeat(generator.normal(size=(6, 21)), 4, axis=0), np.repeat(np.arange(6), 4)) for _ in range(2)
    ]
    assert balanced_accuracy(*groups) < 0.8


@pytest.mark.parametrize("groups", [(drawn(0, infants=1), drawn(1)), (drawn(0), drawn(1, infants=1))])
def test_one_infant_is_no_group(groups):
    with pytest.raises(MovementError, match="each group needs two infants or seeds, or more"):
        balanced_accuracy(*groups)


def test_a_recording_shorter_than_a_window_is_refused():
    with pytest.raises(MovementError, match=r"moving: is 5\.0 s long; to be told apart it needs at least 8 s"):
        windows_of([restless(0, 5.0)])


PUBLISHED = {
    "hand_speed_median_trunk_s": (0.300, 0.133),
    "hand_sample_entropy_nats": (0.653, 0.211),
    "hands_together_r": (0.320, 0.192),
    "foot_speed_p95_trunk_s": (1.65, 0.52),
    "foot_burstiness": (8.1, 3.2),
    "foot_frequency_hz": (1.42, 0.26),
    "feet_together_r": (0.376, 0.137),
    "kicks_per_min": (12.1, 6.0),
    "dimensions": (3.50, 0.78),
    "hand_unit_s": (0.244, 0.016),
    "foot_speed_max_trunk_s": (4.4, 0.9),
    "limbs_still_share": (0.148, 0.097),
    "kick_amplitude_trunk": (0.43, 0.06),
}
"""Some of the figures of twelve infants, as they were first computed by another program."""


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_sample_has_the_figures_that_were_measured_before(name):
    mean, deviation = PUBLISHED[name]
    assert real_infants().means[name] == pytest.approx(mean, rel=0.012)
    assert real_infants().deviations[name] == pytest.approx(deviation, rel=0.1)


def test_the_sample_has_all_that_is_measured_of_pictures():
    assert [*real_infants().means] == [quantity.name for quantity in (*CORE, *DETAILS)]
    assert real_infants().means.keys() <= QUANTITIES.keys()


def test_files_of_real_infants_hold_aggregates_only():
    """One mean and one deviation for each measure; one mean and two covariances of windows."""
    rows = [file.read_text().splitlines() for file in FILES]
    assert rows[0][0] == "measure,mean,sd"
    assert len(rows[0]) == 1 + len(CORE) + len(DETAILS)
    kinds = [row.split(",")[0] for row in rows[1][1:]]
    assert (kinds.count("mean"), kinds.count("between"), kinds.count("within"), len(kinds)) == (1, 21, 21, 43)


def test_covariances_are_symmetric_and_have_no_negative_variance():
    for matrix in real_windows()[1:]:
        assert matrix == pytest.approx(matrix.T, rel=1e-4)
        deviations = np.sqrt(np.diag(matrix))
        assert np.linalg.eigvalsh(matrix / np.outer(deviations, deviations)).min() > -1e-3


def test_windows_that_are_drawn_have_the_mean_of_the_real_ones():
    generator = np.random.default_rng(0)
    values = np.concatenate([draw_windows(generator).values for _ in range(100)])
    mean, between, within = real_windows()
    deviation = np.sqrt(np.diag(between + within))
    assert (values.mean(axis=0) - mean) / deviation == pytest.approx(0, abs=0.1)
    assert values.std(axis=0) == pytest.approx(deviation, rel=0.1)


def test_windows_that_are_drawn_twice_are_told_apart_by_chance():
    generator = np.random.default_rng(0)
    scores = [balanced_accuracy(draw_windows(generator), draw_windows(generator)) for _ in range(10)]
    assert np.mean(scores) == pytest.approx(0.5, abs=0.1)
    shifted = draw_windows(generator)
    shifted.values[:] += 3 * np.sqrt(np.diag(real_windows()[1]))
    assert accuracy_against_real(shifted, generator)[0] > 0.9


def test_the_same_seed_gives_the_same_figure():
    windows = draw_windows(np.random.default_rng(5))
    assert accuracy_against_real(windows, np.random.default_rng(0)) == accuracy_against_real(
        windows, np.random.default_rng(0)
    )


def test_the_mean_of_a_sample_is_at_no_distance():
    assert distance(real_infants().means, real_infants()) == 0


def test_the_distance_is_the_root_mean_square_of_scores():
    sample = real_infants()
    away = {name: mean + 2 * sample.deviations[name] for name, mean in sample.means.items()}
    assert distance(away, sample) == pytest.approx(2)
    assert standard_scores(away, sample) == pytest.approx(dict.fromkeys(away, 2))


def test_a_score_counts_at_most_ten():
    sample = real_infants()
    away = {**sample.means, "kicks_per_min": 1e9}
    assert distance(away, sample) == pytest.approx(10 / np.sqrt(21))


def test_a_sample_has_the_measures_that_all_its_infants_have():
    sample = Sample.of([{"a": 1.0, "b": 2.0}, {"a": 3.0}])
    assert (sample.means, sample.deviations) == ({"a": 2.0}, {"a": pytest.approx(np.sqrt(2))})
