"""Specs that anyone might write are built and used in every way, or refused in clear lines.

A failure prints the spec and its case. `python tests/fuzz/run.py honest_specs --seed 7` draws others.
"""

import pytest
from fuzz.honest_specs import Case, cases, sections, use_drawn
from fuzz.honest_uses import DEAR
from support.full import FULL

SEED, COUNT = 2026, 300
CASES = cases(SEED, COUNT)
CHUNKS = 15
QUICK = ("run", "check", "grow", "batch")
"""Dear uses that take less than a second."""


def refused(chosen: list[Case], folder) -> int:
    """Use what is drawn of some cases; return of how many something was refused."""
    count = 0
    for number, case in enumerate(chosen):
        (folder / f"{number}").mkdir()
        count += use_drawn(case, folder / f"{number}") > 0
    return count


def test_a_few_honest_specs_are_used_in_some_ways(tmp_path):
    quick = [case for case in CASES if set(case.dear) <= {*QUICK}]
    assert refused(quick[::24], tmp_path) < len(quick[::24])


@pytest.mark.slow
@pytest.mark.parametrize("chunk", [pytest.param(chunk, marks=FULL) for chunk in range(CHUNKS)])
def test_honest_specs_are_used_in_every_way_and_most_are_refused_nothing(chunk, tmp_path):
    chosen = CASES[chunk::CHUNKS]
    assert refused(chosen, tmp_path) < len(chosen) / 2


def test_each_section_is_put_to_each_dear_use_and_beside_each_other():
    met = {(section, use) for case in CASES for section in case.sections for use in case.dear}
    assert met == {(section, use) for section in sections() for use in DEAR}
    pairs = {frozenset(case.sections) for case in CASES if len(case.sections) == 2}
    assert len(pairs) == len(sections()) * (len(sections()) - 1) / 2
