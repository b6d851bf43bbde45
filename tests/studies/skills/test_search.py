"""Searches in a task of three numbers, whose episodes cost nothing: their ends, their starts and their tries."""

from collections.abc import Callable

import numpy as np
import pytest

from mimoc.policies.postures import Postures
from mimoc.studies.skills import search as searching
from mimoc.studies.skills.search import (
    DRAWS,
    FIRST_TEST,
    KEPT,
    RECIPES,
    Candidate,
    Form,
    Outcome,
    Searcher,
    best_of,
    search,
)

STARTS = 20
Play = Callable[[float, int], tuple[float, bool]]


class ToySearcher(Searcher):
    """Tries movements of one knee through three postures, of which only their length as a vector matters."""

    def __init__(self, play: Play):
        self.form = Form(RECIPES["roll"], "roll", 6, ("robot:right_knee",), np.zeros(1))
        self.seeds: list[int] = []
        self._play = play

    def play(self, movement: Postures, seed: int) -> tuple[float, bool]:
        self.seeds.append(seed)
        return self._play(float(np.linalg.norm(movement.postures)), seed)


def on_a_sphere(length: float, seed: int) -> tuple[float, bool]:
    """Whatever has a length of .8 has the skill; the mean of such movements is shorter, and has not."""
    return -abs(length - 0.8), abs(length - 0.8) < 0.1


def never(length: float, seed: int) -> tuple[float, bool]:
    return length, False


def by_chance(length: float, seed: int) -> tuple[float, bool]:
    """The longer, the more often."""
    has_skill = np.random.default_rng([seed, int(1e6 * length)]).random() < length / 2
    return length + has_skill, bool(has_skill)


def searched(monkeypatch, play: Play, seed: int = 0, tries: int = 400) -> tuple[Outcome, ToySearcher]:
    toy = ToySearcher(play)
    monkeypatch.setattr(searching, "Searcher", lambda env: toy)
    return search(None, seed, tries, STARTS), toy


@pytest.fixture
def checked(monkeypatch) -> list[Candidate]:
    """What a search has checked in the end: the mean, then what it kept."""
    candidates: list[Candidate] = []

    def spy(searcher, those, first, tries):
        candidates.extend(those)
        return best_of(searcher, those, first, tries)

    monkeypatch.setattr(searching, "best_of", spy)
    return candidates


@pytest.mark.parametrize("seed", range(5))
def test_a_search_ends_with_a_draw_that_has_the_skill_where_the_mean_has_not(seed, checked, monkeypatch):
    outcome, toy = searched(monkeypatch, on_a_sphere, seed)
    assert toy.success(toy.form.movement(checked[0].vector), FIRST_TEST, 1) == 0
    assert outcome.success == 1


def test_what_is_best_in_new_starts_is_taken_and_not_what_was_lucky_before():
    toy = ToySearcher(by_chance)
    lucky = Candidate(np.array([0.2, 0, 0]), (9.0,) * 3, (True,) * 3)
    reliable = Candidate(np.array([1.0, 1.0, 0.5]), (0.0,), (False,))
    best, tried = best_of(toy, [lucky, *[Candidate(np.array([0.1, 0, 0]))] * 7, reliable], 0, 160)
    assert best.vector is reliable.vector
    assert tried == len(toy.seeds) == 9 * 4 + 5 * 8 + 3 * 13 + 2 * 20
    assert len(best.successes) == 4 + 8 + 13 + 20


def test_without_enough_tries_to_check_the_first_candidate_is_taken():
    candidates = [Candidate(np.full(3, share)) for share in (0.1, 0.9)]
    best, tried = best_of(ToySearcher(by_chance), candidates, 0, 1)
    assert (best.vector[0], tried) == (0.1, 0)


def test_what_is_kept_is_tried_again_in_the_start_of_each_round(checked, monkeypatch):
    """So one lucky start weighs less and less."""
    outcome, toy = searched(monkeypatch, never)
    starts = toy.seeds[: len(outcome.curve) * DRAWS]
    assert starts == sorted(starts)
    assert {starts.count(start) for start in starts} == {DRAWS}
    assert len(checked) == 1 + KEPT
    assert max(len(candidate.scores) for candidate in checked) > 2


@pytest.mark.parametrize("play", [on_a_sphere, never, by_chance])
@pytest.mark.parametrize("tries", [40, 60, 100, 400, 1600])
def test_rounds_and_checks_together_stay_within_the_tries_and_are_counted(tries, play, monkeypatch):
    outcome, toy = searched(monkeypatch, play, tries=tries)
    assert outcome.tried == len(toy.seeds) - STARTS <= tries
    assert len(outcome.curve) * DRAWS <= outcome.tried


def test_the_starts_of_rounds_of_checks_and_of_the_measurement_are_all_different(monkeypatch):
    """Also from those of other searches."""
    used: set[int] = set()
    for seed in (0, 1, 19, 20):
        outcome, toy = searched(monkeypatch, never, seed, tries=1600)
        rounds, rest = toy.seeds[: len(outcome.curve) * DRAWS], toy.seeds[len(outcome.curve) * DRAWS :]
        checks, measured = rest[:-STARTS], rest[-STARTS:]
        assert len(set(rounds)) == len(outcome.curve)
        assert len(set(checks)) == 4 + 8 + 13 + 20
        assert len(set(measured)) == STARTS
        seeds = [set(rounds), set(checks), set(measured), used]
        assert sum(map(len, seeds)) == len(set.union(*seeds))
        used |= set(rounds) | set(checks)


def test_rounds_end_once_a_movement_has_the_skill_in_most_of_many_starts(monkeypatch):
    outcome, _ = searched(monkeypatch, on_a_sphere, tries=1600)
    assert searching.CHECKS <= len(outcome.curve) < 36
