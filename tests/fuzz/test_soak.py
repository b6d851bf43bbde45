"""A little of `make soak`, and that it finds what leaks."""

import os
from collections.abc import Iterator
from multiprocessing import get_context

import numpy as np
import pytest
from fuzz.soak import growth, looked_at, scenes, steps
from support.full import full_but


@pytest.mark.full
@pytest.mark.parametrize("part", full_but([steps], [scenes]))
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


def growth_while_leaking(mb: int, handles: int) -> str:
    first, last = looked_at(leaking(2, mb, handles), 2)
    return growth(first, last)


@pytest.mark.full
@pytest.mark.parametrize(("mb", "handles"), [(64, 0), (0, 1), (64, 1)])
def test_what_leaks_is_found_and_named(mb, handles):
    """Twice as much as may grow in memory, or one handle, is enough in a process that frees nothing else meanwhile."""
    with get_context("spawn").Pool(1) as pool:
        found = pool.apply(growth_while_leaking, (mb, handles))
    assert ("file handles" in found) == (handles > 0)
    assert ("MB (at most 32)" in found) == (mb > 0)
