"""Starts of later episodes follow from the seed of a world and the number of its episode, and from nothing else."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import warp as wp

from mimoc.runtime.device.arrays import to_device
from mimoc.runtime.device.episode_ends import EpisodeEnds

WORLDS, STARTS = 4000, 5


def starts_of(seeds: np.ndarray, episode: int) -> np.ndarray:
    """Return the starts that worlds with two bodies choose; those of the second body come after five of the first."""
    infants: Any = [SimpleNamespace(max_steps=None)] * 2
    body = to_device(np.arange(len(seeds)) % 2, wp.int32)
    ending = EpisodeEnds(infants, body, (), None, to_device(seeds, wp.int32))
    ending.episode.fill_(episode)
    table: Any = SimpleNamespace(first=to_device([0, STARTS], wp.int32), count=to_device([STARTS, 1], wp.int32))
    return ending._start_of(table).cpu().numpy()


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
