"""Recordings of points in files, of bodies that move by waves and not of children."""

from pathlib import Path

import numpy as np
import pytest
from support.moving import restless

from mimoc.motion.reading import write_points


@pytest.fixture
def folder(tmp_path) -> Path:
    """Return a folder of three recordings of 17 s, with a note beside them."""
    place = tmp_path / "filmed"
    place.mkdir()
    for seed in range(3):
        write_points(restless(seed, 17.0), place / f"infant{seed}.npz")
    (place / "notes.txt").write_text("filmed at home\n")
    return place


@pytest.fixture
def generator() -> np.random.Generator:
    """Return what draws windows of real infants."""
    return np.random.default_rng(0)
