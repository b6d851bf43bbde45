import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import stats

from mimoc.base.random_streams import stream
from mimoc.compiler.toys.placing import GAP_M, Floor, ReachableFloor, place_toys

NOTHING = np.empty((0, 3))
ENDLESS = Floor((100.0, 100.0), NOTHING)
REACH = ReachableFloor((0.2, -0.1), 0.4, 0.1)


def share_within(reach: ReachableFloor, distance_m: np.ndarray) -> np.ndarray:
    """Return what share of all places `density` puts nearer than some distances, integrated by small steps."""
    grid = np.linspace(0, reach.radius_m + 40 * reach.fading_m, 200_001)
    rings = np.cumsum(reach.density(grid) * 2 * np.pi * grid)
    return np.interp(distance_m, grid, rings / rings[-1])


def distances(places: np.ndarray, reach: ReachableFloor) -> np.ndarray:
    return np.linalg.norm(places - reach.centre_m, axis=1)


def test_a_toy_is_as_likely_anywhere_within_reach_and_rarer_beyond():
    density = REACH.density(np.array([0.0, 0.39, 0.5, 0.6]))
    assert density == pytest.approx([1, 1, np.exp(-1), np.exp(-2)])


@pytest.mark.parametrize(
    "reach", [REACH, ReachableFloor((0, 0), 0.05, 0.3), ReachableFloor((1, 2), 0.6, 0.02)], ids=str
)
def test_places_are_as_far_as_the_stated_distribution_says(reach):
    drawn = reach.draw(20_000, stream(0, "places"))
    assert stats.kstest(distances(drawn, reach), lambda far: share_within(reach, far)).pvalue > 0.01


def test_the_first_toys_of_a_thousand_scenes_are_as_far_as_the_stated_distribution_says():
    """A histogram of ten bins that are all alike likely."""
    first = np.concatenate([place_toys([0.05], REACH, ENDLESS, stream(seed, "toys.place")) for seed in range(1000)])
    counts = np.histogram(share_within(REACH, distances(first, REACH)), 10, (0, 1))[0]
    assert stats.chisquare(counts).pvalue > 0.01


def test_toys_are_in_all_directions_alike():
    drawn = REACH.draw(10_000, stream(0, "places")) - REACH.centre_m
    counts = np.histogram(np.arctan2(*drawn.T), 12, (-np.pi, np.pi))[0]
    assert stats.chisquare(counts).pvalue > 0.01


def test_what_is_taken_changes_nothing_about_the_rest_of_the_floor():
    """Where a disc is taken, toys are drawn anew: on free floor, their distances are distributed as without it."""
    taken = Floor((100.0, 100.0), np.array([[0.2, -0.1, 0.25]]))
    first = np.concatenate([place_toys([0.05], REACH, taken, stream(seed, "toys.place")) for seed in range(1000)])
    nearest = 0.25 + 0.05 + GAP_M
    start = share_within(REACH, np.array(nearest))
    shares = (share_within(REACH, distances(first, REACH)) - start) / (1 - start)
    assert stats.kstest(shares, "uniform").pvalue > 0.01


@given(st.integers(0, 2**53), st.lists(st.floats(0.01, 0.1), min_size=1, max_size=12))
def test_toys_are_apart_from_each_other_from_what_is_there_and_inside(seed, radii):
    taken = np.array([[0.0, 0.0, 0.2], [0.3, 0.1, 0.05]])
    floor = Floor((1.2, 0.9), taken)
    places = place_toys(radii, REACH, floor, stream(seed, "toys.place"))
    discs = np.vstack([taken, np.column_stack([places, radii])])
    gaps = np.linalg.norm(discs[:, None, :2] - discs[:, :2], axis=2) - discs[:, 2] - discs[:, None, 2]
    assert gaps[np.triu_indices(len(discs), 1)][1:].min() >= GAP_M - 1e-12
    assert (np.abs(places) + np.array(radii)[:, None] + GAP_M <= np.array(floor.half_size_m) + 1e-12).all()


def test_the_first_toys_stay_where_they_are_when_there_are_more():
    few, many = (place_toys([0.05] * count, REACH, ENDLESS, stream(3, "toys.place")) for count in (3, 8))
    assert (few == many[:3]).all()


def test_where_there_is_no_room_there_are_no_places():
    assert place_toys([0.05], REACH, Floor((0.04, 1.0), NOTHING), stream(0, "toys.place")) is None
    assert place_toys([0.05] * 50, REACH, Floor((0.3, 0.3), NOTHING), stream(0, "toys.place")) is None


def test_no_toys_need_no_place():
    assert place_toys([], REACH, ENDLESS, stream(0, "toys.place")).shape == (0, 2)
