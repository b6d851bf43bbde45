"""Reproducible randomness: an independent stream of random numbers for each aspect of a scene."""

from collections.abc import Sequence
from hashlib import sha256
from typing import Any, TypeVar

import numpy as np

Item = TypeVar("Item")

SEED = "spec.scene.seed"  # The seed of a scene, as a key in `provenance.json`.


def checked_seed(seed: Any, what: str = "seed") -> int:
    """Return a seed as one of Python's integers; a ValueError says that it is none, or negative."""
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise ValueError(f"expected a non-negative integer as {what}, got {seed!r}")
    return int(seed)


def stream(seed: int, aspect: str) -> np.random.Generator:
    """Return random numbers that depend on the seed and on the name of an aspect, such as `room.walls`, alone.

    However many numbers one aspect draws, nothing else in the scene changes.
    """
    digest = sha256(aspect.encode()).digest()
    words = tuple(int.from_bytes(digest[start : start + 4], "big") for start in range(0, 16, 4))
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=words)))


def drawn_rule(what: str, aspect: str) -> str:
    """Return what `provenance.json` says of a value that was drawn from the stream of an aspect."""
    return f"drawn {what}, by the stream '{aspect}' of the seed"


# NumPy guarantees the same bits in every version, but not the same numbers from every method: these need only random().


def between(generator: np.random.Generator, low: float, high: float) -> float:
    """Return a number from an interval, uniformly distributed."""
    return min(low + (high - low) * generator.random(), high)


def whole_between(generator: np.random.Generator, low: int, high: int) -> int:
    """Return a whole number from *low* to *high*, both included, uniformly distributed."""
    return low + int(generator.random() * (high - low + 1))


def pick(generator: np.random.Generator, items: Sequence[Item]) -> Item:
    """Return one of some items, each with the same probability."""
    return items[whole_between(generator, 0, len(items) - 1)]


def shuffled(generator: np.random.Generator, items: Sequence[Item]) -> list[Item]:
    """Return all items in random order."""
    return [items[index] for index in np.argsort(generator.random(len(items)), kind="stable")]
