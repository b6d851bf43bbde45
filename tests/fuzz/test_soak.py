"""A little of `make soak`, and that it finds what leaks."""

import os
from collections.abc import Iterator

import numpy as np
import pytest
from fuzz.soak import growth, looked_at, scenes, steps


@pytest.mark.parametrize("part", [steps, scenes])
def test_memory_and_file_handles_stay_flat(part):
    first, *_, last = looked_at(part(3), 3)
    assert last.rounds == 3
    assert growth(first, last) == ""


def leaking(rounds: int, mb: int, handles: int) -> Iterator[None]:
    """Keep memory and file handles in every round, and let go of them at the end."""
    kept, opened = [], []
    for _ in range(rounds):
        kept.append(np.ones(mb * 2**17))
        opened += [os.open(os.devnull, os.O_RDONLY) for _ in range(handles)]
        yield
    for handle in opened:
        os.close(handle)


@pytest.mark.parametrize(("mb", "handles"), [(64, 0), (0, 1), (64, 1)])
def test_what_leaks_is_found_and_named(mb, handles):
    """Whatever else the process holds: twice as much as may grow in memory, or one handle, is enough."""
    first, last = looked_at(leaking(2, mb, handles), 2)
    found = growth(first, last)
    assert ("file handles" in found) == (handles > 0)
    assert ("MB (at most 32)" in found) == (mb > 0)
