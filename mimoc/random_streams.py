"""Chance that stays the same: one stream of random numbers for each aspect of a scene."""

from collections.abc import Sequence
from hashlib import sha256
from typing import TypeVar

import numpy as np

Item = TypeVar("Item")


def stream(seed: int, aspect: str) -> np.random.Generator:
    """Return random numbers that depend on the seed and on the name of an aspect, such as `room.walls`, alone.

    So that however much is drawn for one aspect, nothing else in the scene changes.
    """
    digest = sha256(aspect.encode()).digest()
    words = tuple(int.from_bytes(digest[start : start + 4], "big") for start in range(0, 16, 4))
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=words)))


# NumPy promises the same bits for good, but not the same numbers from every method: these need only random().


def between(generator: np.random.Generator, low: float, high: float) -> float:
    """Return a number from an interval, all alike likely."""
    return min(low + (high - low) * generator.random(), high)


def whole_between(generator: np.random.Generator, low: int, high: int) -> int:
    """Return a whole number from *low* to *high*, both included, all alike likely."""
    return low + int(generator.random() * (high - low + 1))


def pick(generator: np.random.Generator, items: Sequence[Item]) -> Item:
    """Return one of some items, all alike likely."""
    return items[whole_between(generator, 0, len(items) - 1)]


def shuffled(generator: np.random.Generator, items: Sequence[Item]) -> list[Item]:
    """Return all items in any order."""
    return [items[index] for index in np.argsort(generator.random(len(items)), kind="stable")]
