"""Starts of later episodes follow from the seed of a world and the number of its episode, and from nothing else."""

import numpy as np

from mimoc.runtime.device.arrays import put
from mimoc.runtime.device.initial_states import InitialStates

WORLDS, STARTS = 4000, 5


def starts_of(seeds: np.ndarray, episode: int) -> np.ndarray:
    """Return the starts that worlds with two bodies choose; those of the second body come after five of the first."""
    body = np.arange(len(seeds)) % 2
    starts = InitialStates(put(np.array([0, STARTS])[body]), put(np.array([STARTS, 1])[body]), {}, {}, {})
    return starts.draw(put(seeds), put(np.full(len(seeds), episode))).cpu().numpy()


def test_they_are_drawn_evenly_from_those_of_the_body():
    starts = starts_of(np.arange(WORLDS), 1)
    assert (starts[1::2] == STARTS).all()
    counts = np.bincount(starts[::2], minlength=STARTS)
    assert counts.min() > 0.85 * WORLDS / 2 / STARTS
    assert len(counts) == STARTS


def test_they_follow_from_seed_and_episode():
    seeds = np.arange(WORLDS)
    first, second = starts_of(seeds, 1), starts_of(seeds, 2)
    assert (starts_of(seeds, 1) == first).all()
    assert (starts_of(seeds + 2, 1)[:-2] == first[2:]).all()
    assert 0.1 < (first == second)[::2].mean() < 0.3
