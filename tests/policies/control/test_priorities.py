import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.policies.control.dynamics import LinearDemand, product, solve_prioritized

COUNT = 12
seeds = st.integers(0, 10_000)


def demand(generator, rows, response=None):
    response = generator.normal(size=(rows, COUNT)) if response is None else response
    return LinearDemand(response, generator.normal(size=rows))


@given(seeds, st.lists(st.integers(1, 5), min_size=1, max_size=4))
def test_a_wish_never_disturbs_those_before_it(seed, rows):
    generator = np.random.default_rng(seed)
    demands, rest = [demand(generator, count) for count in rows], demand(generator, COUNT)
    for count in range(1, len(demands) + 1):
        alone, nothing = demands[:count], LinearDemand(np.zeros((0, COUNT)), np.zeros(0))
        for before in alone:
            assert before.response @ solve_prioritized(demands, rest) == pytest.approx(
                before.response @ solve_prioritized(alone, nothing), abs=1e-9
            )


@given(seeds)
def test_the_first_wish_is_fulfilled(seed):
    generator = np.random.default_rng(seed)
    first, rest = demand(generator, 3), demand(generator, COUNT)
    assert first.response @ solve_prioritized([first], rest) == pytest.approx(first.accelerations, rel=0.01, abs=0.01)


@given(seeds, st.floats(0, 1e-3))
def test_a_wish_that_can_hardly_be_fulfilled_costs_little(seed, scale):
    """Its third acceleration answers to next to no torque, and however little that is, torques stay bounded."""
    generator = np.random.default_rng(seed)
    left, _ = np.linalg.qr(generator.normal(size=(3, 3)))
    right, _ = np.linalg.qr(generator.normal(size=(COUNT, 3)))
    singular = LinearDemand(left @ np.diag([1.0, 0.5, scale]) @ right.T, np.ones(3))
    rest = LinearDemand(np.eye(COUNT), np.zeros(COUNT))
    assert np.abs(solve_prioritized([singular], rest)).max() < 10.0


def test_a_wish_that_nothing_answers_to_is_let_be():
    nothing = LinearDemand(np.zeros((2, COUNT)), np.ones(2))
    assert not solve_prioritized([nothing], LinearDemand(np.eye(COUNT), np.zeros(COUNT))).any()


@given(st.integers(1, 300), st.integers(1, 40))
def test_products_are_the_same_in_strips(height, width):
    left, right = np.arange(height * width, dtype=float).reshape(height, width), np.ones((1000, width))
    assert np.array_equal(product(left, right), left @ right.T)
