"""Gradients and blocks of the normal equations are those of the residuals, for every kind of residual."""

from dataclasses import replace

import numpy as np
import pytest
from support.retargeting import problem_and_state

from mimoc.movement.retargeting.fitting import NormalEquations, Problem, State
from mimoc.movement.retargeting.prior import Usual, chain, times_chain
from mimoc.movement.retargeting.sizes import at_sizes
from mimoc.movement.retargeting.start import Contacts

STEP = 1e-6
NO_CONTACTS = Contacts(0, np.zeros(0), (), (), ())


def differences(problem: Problem, state: State, outlier: float, columns: range) -> tuple[np.ndarray, np.ndarray]:
    """Return half the derivatives of the cost by differences: of some unknowns in all frames, and of what is shared."""
    frame, shared = [], []
    for column in columns:
        step = STEP * np.eye(state.x.shape[1])[column]
        ends = [problem.equations(replace(state, x=state.x + sign * step), outlier)[1] for sign in (1, -1)]
        frame.append((ends[0] - ends[1]) / (4 * STEP))
    for column in range(1 + len(state.logs)):
        step = STEP * np.eye(1 + len(state.logs))[column]
        states = [State(state.x, state.height_m + s * step[0], state.logs + s * step[1:]) for s in (1, -1)]
        ends = [problem.equations(other, outlier)[1] for other in states]
        shared.append((ends[0] - ends[1]) / (4 * STEP))
    return np.array(frame), np.array(shared)


@pytest.mark.full
@pytest.mark.parametrize(("kind", "first", "pitch_deg"), [("pixels", 0, None), ("depth", 1, 50.0), ("space", 2, None)])
def test_the_gradient_is_that_of_the_cost(kind, first, pitch_deg):
    """With robust weights, contacts, limits, priors, and what one camera holds; each by a third of the unknowns."""
    problem, state = problem_and_state(kind, pitch_deg=pitch_deg)
    system, _ = problem.equations(state, 8.0)
    columns = range(first, state.x.shape[1], 3)
    frame, shared = differences(problem, state, 8.0, columns)
    gradient = system.g.sum(axis=0)
    assert gradient[columns] == pytest.approx(frame, abs=1e-5 * np.abs(gradient).max())
    scale = np.abs(frame).max()
    assert system.h == pytest.approx(shared, abs=1e-5 * max(scale, np.abs(shared).max()))


def test_contacts_have_the_derivatives_of_their_residuals():
    """A step moves residuals as the derivatives say."""
    problem, state = problem_and_state("pixels", shift=0.6)
    step = 1e-5 * np.random.default_rng(1).normal(size=state.x.shape)
    residuals = []
    for x in (state.x - step, state.x, state.x + step):
        pose = problem.skeleton.pose(x, at_sizes(problem.shape, state.logs))
        residuals.append(list(problem.contacts.residuals(problem.skeleton, pose, problem.rate_hz)))
    assert len(residuals[1]) > len(problem.contacts.lying)
    for before, now, after in zip(*residuals, strict=True):
        assert np.array_equal(before[0], after[0])
        moved = np.einsum("fn,fn->f", now[2], 2 * step[now[0]])
        assert after[1] - before[1] == pytest.approx(moved, abs=1e-4 * np.abs(moved).max() + 1e-9)


def test_without_contacts_and_far_from_outliers_the_system_is_that_of_all_residuals():
    """A is J'J of a dense Jacobian by differences, with the prior; C and D likewise."""
    problem, state = problem_and_state("depth")
    problem = replace(problem, contacts=NO_CONTACTS, sums=problem.sums[:0], sum_bounds=problem.sum_bounds[:0])
    wide = replace(problem, low=problem.low - 9, high=problem.high + 9)
    system, _ = wide.equations(state, 1e6)
    frame, n = 3, state.x.shape[1]
    part = slice(frame, frame + 1)

    def residuals(x: np.ndarray, logs: np.ndarray, height_m: float) -> np.ndarray:
        pose = wide.skeleton.pose(x[None], at_sizes(wide.shape, logs))
        seen = np.arange(wide.observed.places.shape[1])
        channels = wide.observed.channels(part, pose, wide.skeleton.jacobian(pose, seen), height_m)
        return np.concatenate([c.errors.ravel() for c in channels])

    x, logs, height_m = state.x[frame], state.logs, state.height_m
    dense = np.stack(
        [(residuals(x + s, logs, height_m) - residuals(x - s, logs, height_m)) / (2 * STEP) for s in STEP * np.eye(n)],
        axis=1,
    )
    block = np.zeros((n, n))
    rows = system.bands.reshape(-1, n, 2 * n + 1)[frame]
    for column in range(n):
        block[column:, column] = rows[column, : n - column]
    block = np.tril(block) + np.tril(block, -1).T - np.diag(wide.chain[0, frame])
    assert block == pytest.approx(dense.T @ dense, rel=1e-4, abs=1e-5 * np.abs(block).max())


def test_a_prior_is_a_stationary_process_of_its_spread():
    usual = [Usual(0.5, 0.05, 1.0), Usual(0.2, 0.1, 0.8)]
    for rate_hz in (15.0, 30.0):
        frames = int(30 * rate_hz)
        diagonals = chain(usual, frames, rate_hz)
        for index, item in enumerate(usual):
            matrix = sum(
                np.diag(diagonals[d, : frames - d, index], -d)
                + (np.diag(diagonals[d, : frames - d, index], d) if d else 0)
                for d in range(3)
            )
            sd = np.sqrt(np.diag(np.linalg.inv(matrix)))[frames // 2]
            assert sd == pytest.approx(item.sd, rel=0.05)
            x = np.random.default_rng(0).normal(size=(frames, 2))
            assert times_chain(diagonals, x)[:, index] == pytest.approx(matrix @ x[:, index])


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
