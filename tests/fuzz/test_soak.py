"""A little of `make soak`, and that it finds what leaks."""

import os

import numpy as np
import pytest
from fuzz.soak import growth, looked_at, scenes, steps


@pytest.mark.parametrize("part", [steps, scenes])
def test_memory_and_file_handles_stay_flat(part):
    first, *_, last = looked_at(part(3), 3)
    assert last.rounds == 3
    assert growth(first, last) == ""


def test_what_leaks_is_found():
    kept = []

    def leak():
        for _ in range(2):
            kept.append((np.ones(2**23), os.open(os.devnull, os.O_RDONLY)))
            yield

    first, last = looked_at(leak(), 2)
    for _, handle in kept:
        os.close(handle)
    assert growth(first, last) == "64 MB (at most 32) and 1 file handles"
