"""A search for a movement by which an infant has a skill: the cross-entropy method over a few postures.

Vectors are drawn around a mean; the best ones so far move it, and narrow what is drawn next. A round has one start. At
first, what is kept may have been lucky in its start, which leads on to what is rare; later, it is tried again in the
start of each round, and stays only if it is good in most. In the end, the kept ones and the mean are told apart in
more starts, by successive halving:

    rounds of 40 tries, 1,440 of 1,600    first half: 40 draws    second half: 32 draws, and the 8 that were kept
    checks, the other 160                 9 candidates in 4 starts each, 5 in 8 more, 3 in 13 more, 2 in 20 more

What no draw does may still be possible: a search that finds nothing says so much about itself as about the body.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from mimoc.policies.postures import PosturePolicy, Postures
from mimoc.policies.rollout import rollout
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.studies.skills.recipes import RECIPES, Form

DRAWS, KEPT = 40, 8  # Movements that are tried in a round, and how many of them are kept for the next one.
LEAST_SPREAD, SMOOTHING = 0.15, 0.7
"""The least spread, as a share of the first one, and how far the kept ones move mean and spread."""
EXPLORED = 0.5  # Share of the rounds in which what is kept is not tried again.
PASSED, CHECKS = 0.9, 8
"""The rounds end when a kept movement has had the skill in this share of at least so many starts."""
CHECKED = 0.1  # Share of the tries with which the mean and the kept movements are told apart in the end.
FIRST_TEST = 20_000  # Seed of the first start in which the result of a search is measured.
FIRST_TRY, FIRST_CHECK = 1_000_000, 500_000
"""Seed of the first start of a search, times its own seed and one, and how much further those of its checks begin."""


@dataclass(frozen=True)
class Outcome:
    """What a search has found."""

    movement: Postures
    success: float  # Share of starts that the search has not seen in which the infant has the skill.
    tried: int  # Number of episodes that were tried.
    curve: tuple[float, ...]  # Mean score of the kept movements, in each round.


@dataclass(frozen=True)
class Candidate:
    """A movement that may be the best, and what came of it."""

    vector: FloatArray  # The numbers that it is made from, shape (v,).
    scores: tuple[float, ...] = ()  # Its score in each start that it was tried in.
    successes: tuple[bool, ...] = ()  # Whether the infant had the skill, in each of them.

    @property
    def score(self) -> float:
        """Its mean score; 0 before it was tried."""
        return sum(self.scores) / max(len(self.scores), 1)

    @property
    def success(self) -> float:
        """Share of its starts in which the infant had the skill; 0 before it was tried."""
        return sum(self.successes) / max(len(self.successes), 1)


class Searcher:
    """Tries movements with one infant."""

    def __init__(self, env: InfantEnv):
        self.env = env
        env.reset(seed=0)
        joints = tuple(dict.fromkeys(a.joint for a in env.manifest.actuation.actuators if a.commanded))
        low, high = np.array([env.model.joint(joint).range for joint in joints]).T
        angles = env.data.qpos[[env.model.joint(joint).qposadr[0] for joint in joints]]
        start = (angles - (low + high) / 2) / np.maximum((high - low) / 2, 1e-9)
        task = env.manifest.task.kind
        self.form = Form(RECIPES[task], task, env.age_months, joints, start)

    def play(self, movement: Postures, seed: int) -> tuple[float, bool]:
        """Return the score of an episode, and whether the infant had the skill in it.

        That is its reward, weighted by the share of the episode that has passed: what counts is where it leads.
        """
        total, success = 0.0, False
        for step in rollout(self.env, lambda env: PosturePolicy(env, movement), episodes=1, seed=seed):
            total, success = total + step.reward * step.number / (self.env.max_steps or 1), step.success
        return total, success

    def success(self, movement: Postures, first: int, count: int) -> float:
        """Return in what share of some starts, from a seed on, the infant has the skill."""
        return sum(self.play(movement, seed)[1] for seed in range(first, first + count)) / count

    def tried(self, candidate: Candidate, seed: int) -> Candidate:
        """Return a candidate with what comes of it in one more start."""
        score, success = self.play(self.form.movement(candidate.vector), seed)
        return replace(candidate, scores=(*candidate.scores, score), successes=(*candidate.successes, success))


def search(
    env: InfantEnv, seed: int, tries: int = 1000, starts: int = 20, progress: Callable[[int], None] = lambda tried: None
) -> Outcome:
    """Return the best movement that a search finds for a task, measured in *starts* that it has not seen.

    There are at most as many tries as asked for, in rounds and in checks of the best; one round at least.
    """
    searcher, random = Searcher(env), np.random.default_rng(seed)
    scale, first = searcher.form.scale(), FIRST_TRY * (seed + 1)
    mean, spread, kept, curve = np.zeros(len(scale)), scale.copy(), list[Candidate](), list[float]()
    rounds = max(1, int(tries * (1 - CHECKED)) // DRAWS)
    while len(curve) < rounds and not any(
        len(candidate.successes) >= CHECKS and candidate.success >= PASSED for candidate in kept
    ):
        lucky, again = (kept, []) if len(curve) < EXPLORED * rounds else ([], kept)
        draws = mean + spread * random.standard_normal((DRAWS - len(again), len(mean)))
        candidates = [*again, *(Candidate(draw) for draw in draws)]
        played = [searcher.tried(candidate, first + len(curve)) for candidate in candidates]
        kept = sorted([*lucky, *played], key=lambda candidate: -candidate.score)[:KEPT]
        vectors = np.array([candidate.vector for candidate in kept])
        mean = mean + SMOOTHING * (vectors.mean(axis=0) - mean)
        spread = np.maximum(spread + SMOOTHING * (vectors.std(axis=0) - spread), LEAST_SPREAD * scale)
        curve.append(round(sum(candidate.score for candidate in kept) / KEPT, 3))
        progress(len(curve) * DRAWS)
    tried, checks = len(curve) * DRAWS, min(int(tries * CHECKED), tries - len(curve) * DRAWS)
    best, checked = best_of(searcher, [Candidate(mean), *kept], first + FIRST_CHECK, checks)
    movement = searcher.form.movement(best.vector)
    success = searcher.success(movement, FIRST_TEST, starts)
    return Outcome(movement, success, tried + checked, tuple(curve))


def best_of(searcher: Searcher, candidates: Sequence[Candidate], first: int, tries: int) -> tuple[Candidate, int]:
    """Return the best of some candidates, and the number of tries that this took, by successive halving.

    All are tried anew in a few starts, the better half of them in more, and so on, until one is left: the one with the
    skill in most of these starts, or with the best score if that is as many. Each halving has the same share of all
    tries; without enough of them it is the first one.
    """
    left, seed, tried = [Candidate(candidate.vector) for candidate in candidates], first, 0
    halvings = (len(left) - 1).bit_length()
    for _ in range(halvings):
        starts = range(seed, seed + tries // halvings // len(left))
        tried, seed = tried + len(starts) * len(left), starts.stop
        left = [reduce(searcher.tried, starts, candidate) for candidate in left]
        left.sort(key=lambda candidate: (-candidate.success, -candidate.score))
        left = left[: (len(left) + 1) // 2]
    return left[0], tried
