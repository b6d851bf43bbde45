"""What is learnt of a toy, in which one limb moves the world."""

import numpy as np
import pytest

from mimoc.studies.experiments.gain_learner import FORGETTING_S, LARGEST, WINDOW_S, Expected, GainLearner
from mimoc.studies.experiments.legs import LIMBS

TIED = LIMBS.index("left_hip")


def learn(seed: int, windows: int, reward) -> GainLearner:
    """Let limbs move by chance, and reward be a function of their movement and of chance."""
    generator, learner = np.random.default_rng(seed), GainLearner()
    for _ in range(windows):
        movement, noise = generator.lognormal(0.0, 0.5, len(LIMBS)), generator.lognormal(0.0, 0.5)
        learner.feel(float(reward(movement, noise)), movement)
    return learner


def by_tied(movement, noise) -> float:
    return movement[TIED] * noise


def test_the_limb_that_moves_the_world_is_driven_more():
    gains = np.array([learn(seed, 150, by_tied).gains for seed in range(20)])
    assert gains[:, TIED].min() > 1.5
    assert np.delete(gains, TIED, axis=1).mean() == pytest.approx(1.0, abs=0.1)


def test_a_limb_that_moves_along_with_it_gains_less():
    """Half of the movement of all limbs is common to them."""
    generator, strengths = np.random.default_rng(0), []
    for _ in range(20):
        learner = GainLearner()
        for _ in range(150):
            movement = generator.lognormal(0.0, 0.5) + generator.lognormal(0.0, 0.5, len(LIMBS))
            learner.feel(by_tied(movement, generator.lognormal(0.0, 0.3)), movement)
        strengths.append(learner.strengths)
    learnt = np.mean(strengths, axis=0)
    assert learnt[TIED] > 3 * np.delete(learnt, TIED).max()


def test_nothing_is_learnt_of_a_world_that_moves_by_itself():
    gains = np.array([learn(seed, 150, lambda movement, noise: noise).gains for seed in range(20)])
    assert gains.mean() == pytest.approx(1.0, abs=0.05)
    assert gains.max() < 2.0


def test_strengths_are_in_proportion_to_those_of_a_regression():
    """Smaller, as what is forgotten goes back to 0."""
    true, learnt = np.array([0.6, 0.0, -0.4, 0.3, 0.0, 0.2]), []
    for seed in range(20):
        generator, learner = np.random.default_rng(seed), GainLearner()
        for _ in range(300):
            movement = generator.normal(size=len(LIMBS))
            learner.feel(float(true @ movement + 10.0 + 0.5 * generator.normal()), movement)
        learnt.append(learner.strengths)
    shown = true / np.sqrt(true @ true + 0.5**2)
    assert np.mean(learnt, axis=0) == pytest.approx(0.77 * shown, abs=0.06)


def test_nothing_is_learnt_without_reward():
    assert learn(0, 100, lambda movement, noise: 0.0).strengths == pytest.approx(np.zeros(len(LIMBS)))


def test_what_was_learnt_is_forgotten():
    learner = learn(0, 150, by_tied)
    before = learner.strengths[TIED]
    for _ in range(round(FORGETTING_S / WINDOW_S)):
        learner.feel(0.0, np.ones(len(LIMBS)))
    assert learner.strengths[TIED] == pytest.approx(before / np.e, rel=0.02)


def test_gains_have_a_limit():
    learner = learn(0, 1, by_tied)
    learner.strengths = np.full(len(LIMBS), 10.0)
    assert learner.gains == pytest.approx(np.full(len(LIMBS), np.exp(LARGEST)))


def test_the_size_of_reward_does_not_matter():
    """Only how it varies around what is expected."""
    one, other = (learn(3, 100, lambda a, noise, size=size: size * by_tied(a, noise)) for size in (1.0, 50.0))
    assert one.strengths == pytest.approx(other.strengths)


def test_expectations_become_those_of_what_is_felt():
    generator, expected = np.random.default_rng(0), Expected(1)
    values = [expected.standardised(generator.normal(5.0, 2.0, 1))[0] for _ in range(2000)]
    assert np.mean(values[200:]) == pytest.approx(0.0, abs=0.1)
    assert np.std(values[200:]) == pytest.approx(1.0, abs=0.1)
