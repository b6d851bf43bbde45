"""The bordered banded system gives what a dense solver gives, and its inverse is the covariance of a linear model."""

import numpy as np
import pytest

from mimoc.movement.retargeting.fitting import NormalEquations

FRAMES, UNKNOWNS, SHARED = 7, 3, 2


def system_and_matrix(frames=FRAMES):
    draw = np.random.default_rng(3)
    system = NormalEquations.zeros(frames, UNKNOWNS, SHARED)
    rows = draw.normal(size=(frames, 4, UNKNOWNS))
    shared = draw.normal(size=(frames, 4, SHARED))
    errors = draw.normal(size=(frames, 4))
    system.add_blocks(0, rows.transpose(0, 2, 1) @ rows)
    system.border += rows.transpose(0, 2, 1) @ shared
    system.corner += np.einsum("tis,tir->sr", shared, shared) + np.eye(SHARED)
    system.g += np.einsum("tin,ti->tn", rows, errors)
    system.h += np.einsum("tis,ti->s", shared, errors)
    chain = np.stack([np.full((frames, UNKNOWNS), value) for value in (9.0, -4.0, 1.0)])
    system.add_chain(chain)
    size = frames * UNKNOWNS
    whole = np.zeros((size + SHARED, size + SHARED))
    for t in range(frames):
        here = slice(t * UNKNOWNS, (t + 1) * UNKNOWNS)
        whole[here, here] += rows[t].T @ rows[t] + 9 * np.eye(UNKNOWNS)
        whole[here, size:] = rows[t].T @ shared[t]
        for distance, value in ((1, -4.0), (2, 1.0)):
            if t + distance < frames:
                later = slice((t + distance) * UNKNOWNS, (t + distance + 1) * UNKNOWNS)
                whole[here, later] = whole[later, here] = value * np.eye(UNKNOWNS)
    whole[size:, :size] = whole[:size, size:].T
    whole[size:, size:] = system.corner
    return system, whole, np.concatenate([system.g.ravel(), system.h])


@pytest.mark.parametrize("frames", [1, 2, 3, 7])
def test_a_step_is_that_of_a_dense_solver(frames):
    system, whole, gradient = system_and_matrix(frames)
    step, shared = system.factored().step(np.array([True, True]))
    assert np.concatenate([step.ravel(), shared]) == pytest.approx(-np.linalg.solve(whole, gradient))


def test_what_may_not_change_keeps_its_place():
    system, whole, gradient = system_and_matrix()
    step, shared = system.factored().step(np.array([True, False]))
    dense = -np.linalg.solve(whole[:-1, :-1], gradient[:-1])
    assert shared[1] == 0
    assert np.concatenate([step.ravel(), shared[:1]]) == pytest.approx(dense)


def test_blocks_of_the_inverse_are_those_of_a_dense_inverse():
    system, whole, _ = system_and_matrix()
    factored = system.factored()
    dense, alone = np.linalg.inv(whole), np.linalg.inv(whole[:-SHARED, :-SHARED])
    frames = []
    for frame, block in factored.blocks():
        frames.append(frame)
        span = slice(frame * UNKNOWNS, (frame + 1) * UNKNOWNS)
        assert block == pytest.approx(alone[span, span])
        z = factored.inverse_border[frame]
        assert block + z @ np.linalg.inv(factored.schur()) @ z.T == pytest.approx(dense[span, span])
    assert frames == [*range(FRAMES)][::-1]
    assert np.linalg.inv(factored.schur()) == pytest.approx(dense[-SHARED:, -SHARED:])
