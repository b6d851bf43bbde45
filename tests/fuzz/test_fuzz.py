"""A few tries of each fuzzer, of which `.ci/task fuzz` makes thousands; a little of `.ci/task soak`."""

import os
from collections.abc import Iterator
from multiprocessing import get_context

import numpy as np
import pytest
from fuzz.canaries import Canaries
from fuzz.fuzzing import FUZZERS, fuzzer, run_try
from fuzz.soak import growth, looked_at, scenes, steps
from fuzz.strange_infants import CANARIES
from support.full import FULL, full_but

SEED = 2026
LATER = {
    **dict.fromkeys(("honest_cohorts", "honest_specs"), FULL),
    **dict.fromkeys(("policies", "cohorts", "trainings"), pytest.mark.extras),
}
"""What takes long, and what trains."""


@pytest.mark.parametrize("name", [pytest.param(name, marks=LATER.get(name, ())) for name in FUZZERS])
@pytest.mark.filterwarnings("ignore:the task of .* does not limit its episodes")
def test_nothing_that_strangers_change_breaks_mimoc(name, tmp_path):
    """It is used, or refused in clear lines, and no file outside of it is opened."""
    made, watch = fuzzer(name), Canaries(tmp_path / "outside", CANARIES)
    (tmp_path / "prepared").mkdir()
    prepared = made.prepare(tmp_path / "prepared")
    outcomes = []
    for number in range(made.short):
        (tmp_path / f"{number}").mkdir()
        outcomes.append(run_try(made, prepared, SEED, number, tmp_path / f"{number}", watch))
    watch.close()
    assert [outcome for outcome in outcomes if outcome.is_fault] == []
    assert {outcome.result for outcome in outcomes} >= ({"used"} if made.honest else {"used", "refused"})


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
