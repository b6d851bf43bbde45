"""A search for a movement by which an infant has a skill: the cross-entropy method over a few postures.

Vectors are drawn around a mean; the best ones so far move it, and narrow what is drawn next. What no draw
does may still be possible: a search that finds nothing says so much about itself as about the body.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mimoc.policies.postures import PosturePolicy, Postures
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import FloatArray
from mimoc.studies.skills.recipes import RECIPES, Form

DRAWS, KEPT = 40, 8
LEAST_SPREAD, SMOOTHING = 0.15, 0.7
"""The least spread, as a share of the first one, and how far the kept ones move mean and spread."""
PASSED, CHECKS = 0.75, 8
"""The search ends when the mean has the skill in this share of some starts."""
FIRST_CHECK, FIRST_TEST = 10_000, 20_000
"""Seeds of the starts in which a search checks whether to end, and in which its result is measured."""


@dataclass(frozen=True)
class Outcome:
    """What a search has found."""

    movement: Postures
    success: float
    """Share of starts that the search has not seen in which the infant has the skill."""
    tried: int
    """Number of episodes that were tried."""
    curve: tuple[float, ...]
    """Mean score of the kept draws, in each round."""


class Searcher:
    """Tries movements with one infant."""

    def __init__(self, env: InfantEnv):
        """Find what the infant can move; its task is the skill."""
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
        observation, _ = self.env.reset(seed=seed)
        policy, total, generator = PosturePolicy(self.env, movement), 0.0, np.random.default_rng(seed)
        while True:
            observation, reward, ended, cut, info = self.env.step(policy(generator, observation))
            total += reward * self.env.steps / (self.env.max_steps or 1)
            if ended or cut:
                return total, bool(info["is_success"])

    def success(self, movement: Postures, first: int, count: int) -> float:
        """Return in what share of some starts, from a seed on, the infant has the skill."""
        return sum(self.play(movement, seed)[1] for seed in range(first, first + count)) / count


def search(
    env: InfantEnv,
    seed: int,
    tries: int = 1000,
    starts: int = 20,
    progress: Callable[[int], None] = lambda tried: None,
) -> Outcome:
    """Return the best movement that a search finds for the task of an infant.

    Args:
        env: The infant.
        seed: Of the draws, and of the starts they are tried in.
        tries: How many are tried at most.
        starts: In how many other starts the result is measured.
        progress: Called with how many were tried.
    """
    searcher, random = Searcher(env), np.random.default_rng(seed)
    scale = searcher.form.scale()
    mean, spread, curve, tried = np.zeros(len(scale)), scale.copy(), list[float](), 0
    best, scores, successes = np.zeros((0, len(scale))), np.zeros(0), np.zeros(0, bool)
    while tried < tries:
        draws = mean + spread * random.standard_normal((DRAWS, len(mean)))
        outcomes = [searcher.play(searcher.form.movement(draw), seed * 1000 + tried // DRAWS) for draw in draws]
        tried += DRAWS
        best = np.concatenate([best, draws])
        scores = np.concatenate([scores, [score for score, _ in outcomes]])
        successes = np.concatenate([successes, [success for _, success in outcomes]])
        kept = np.argsort(scores)[-KEPT:]
        best, scores, successes = best[kept], scores[kept], successes[kept]
        mean = mean + SMOOTHING * (best.mean(axis=0) - mean)
        spread = np.maximum(spread + SMOOTHING * (best.std(axis=0) - spread), LEAST_SPREAD * scale)
        curve.append(round(float(scores.mean()), 3))
        progress(tried)
        if successes.sum() > KEPT // 2 and _passes(searcher, mean):
            break
    movement = searcher.form.movement(mean)
    return Outcome(movement, searcher.success(movement, FIRST_TEST, starts), tried, tuple(curve))


def _passes(searcher: Searcher, mean: FloatArray) -> bool:
    return searcher.success(searcher.form.movement(mean), FIRST_CHECK, CHECKS) >= PASSED
