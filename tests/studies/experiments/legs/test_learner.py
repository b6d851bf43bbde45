"""What is learnt of a toy, in which one limb moves the world."""

import numpy as np
import pytest

from mimoc.studies.experiments.legs.driving import LIMBS
from mimoc.studies.experiments.legs.learner import FORGETTING_S, LARGEST, WINDOW_S, GainLearner

TIED = LIMBS.index("left_hip")


def learn(seed: int, windows: int, reward) -> GainLearner:
    generator = np.random.default_rng(seed)
    learner, noise = GainLearner(np.random.default_rng([seed, 1])), generator.lognormal(0.0, 0.5, windows)
    for window in range(windows):
        learner.feel(float(reward(learner.gains(), noise[window])))
    return learner


def test_the_limb_that_moves_the_world_is_driven_more():
    learnt = np.array([learn(seed, 300, lambda gains, noise: gains[TIED] * noise).weights for seed in range(10)])
    assert (np.argmax(learnt.mean(axis=0))) == TIED
    assert learnt[:, TIED].mean() > 0.5
    assert (learnt[:, TIED] > 0).sum() >= 9


def test_nothing_is_learnt_of_a_world_that_moves_by_itself():
    learnt = np.array([learn(seed, 300, lambda gains, noise: noise).weights for seed in range(20)])
    assert abs(learnt.mean()) < 0.1


def test_nothing_is_learnt_without_reward():
    assert learn(0, 100, lambda gains, noise: 0.0).weights == pytest.approx(np.zeros(len(LIMBS)))


def test_what_was_learnt_is_forgotten():
    learner = learn(0, 300, lambda gains, noise: gains[TIED] * noise)
    before = learner.weights[TIED]
    for _ in range(round(FORGETTING_S / WINDOW_S)):
        learner.gains()
        learner.feel(0.0)
    assert learner.weights[TIED] == pytest.approx(before / np.e, rel=0.02)


def test_gains_have_a_limit():
    learner = learn(0, 100, lambda gains, noise: noise)
    learner.weights = np.full(len(LIMBS), LARGEST)
    gains = np.array([learner.gains() for _ in range(50)])
    assert gains.max() == pytest.approx(np.exp(LARGEST))


def test_the_size_of_reward_does_not_matter():
    """Only how it varies around what is expected."""
    one, other = (learn(3, 100, lambda gains, noise, size=size: size * gains[TIED] * noise) for size in (1.0, 50.0))
    assert one.weights == pytest.approx(other.weights)
