"""Intervals of a linear model contain the truth as often as they say; noise is estimated without bias."""

from dataclasses import replace

import numpy as np
import pytest
from support.retargeting import known_motions, problem_and_state, setting

import mimoc
from mimoc.bundle.model import load_model
from mimoc.movement.retargeting.fitting import NormalEquations
from mimoc.movement.retargeting.postures import AngleBounds, Scale, spread_of_alike
from mimoc.movement.retargeting.prior import Usual, chain, usual_of
from mimoc.movement.retargeting.result import QUANTILE, Interval
from mimoc.movement.retargeting.setting import CALIBRATED, Noise, problem_of
from mimoc.movement.retargeting.sizes import OVERALL_SD
from mimoc.movement.retargeting.skeleton import ROOT
from mimoc.movement.retargeting.uncertainty import NOT_SEEN, factors, turns

import moving_children  # isort: skip  # `support.retargeting` puts benchmarks on the path.

FRAMES, RATE_HZ = 60, 15.0


def test_nine_of_ten_intervals_of_a_linear_model_contain_the_truth():
    """Positions of a point with a shared offset: z_t = x_t + o + noise, x a usual movement."""
    draw = np.random.default_rng(0)
    usual, noise = Usual(0.5, 0.05, 1.0), 0.1
    diagonals = chain([usual], FRAMES, RATE_HZ)
    matrix = sum(np.diag(diagonals[d, : FRAMES - d, 0], -d) for d in range(3))
    matrix = matrix + np.tril(matrix, -1).T
    root = np.linalg.cholesky(np.linalg.inv(matrix))
    inside, shared_inside = [], []
    for _ in range(150):
        x, offset = root @ draw.normal(size=FRAMES), 0.3 * draw.normal()
        z = x + offset + noise * draw.normal(size=FRAMES)
        system = NormalEquations.zeros(FRAMES, 1, 1)
        system.add_blocks(0, np.full((FRAMES, 1, 1), noise**-2))
        system.add_chain(diagonals)
        system.border += noise**-2
        system.corner += FRAMES * noise**-2 + 0.3**-2
        system.g[:, 0] = -z * noise**-2
        system.h -= z.sum() * noise**-2
        factored = system.factored()
        step, shared = factored.step(np.array([True]))
        covariance = np.linalg.inv(factored.schur())
        variance = np.array([block[0, 0] for _, block in factored.blocks()][::-1])
        variance += factored.inverse_border[:, 0, 0] ** 2 * covariance[0, 0]
        inside.append(np.abs(step[:, 0] - x) < QUANTILE * np.sqrt(variance))
        half = QUANTILE * np.sqrt(covariance[0, 0])
        shared_inside.append(Interval(shared[0], shared[0] - half, shared[0] + half).contains(offset))
    assert np.mean(inside) == pytest.approx(0.9, abs=0.03)
    assert np.mean(shared_inside) == pytest.approx(0.9, abs=0.07)


def test_every_hinge_that_is_fitted_has_a_factor():
    for hands in ("mitten", "five_finger"):
        names = setting("pixels", hands).hinges.names
        lying, turned = factors(names)
        assert len(lying) == len(names)
        assert (turned >= lying).all()


def test_angles_are_less_sure_from_the_frame_on_in_which_the_trunk_has_turned():
    problem, state = problem_and_state("pixels", shift=0.0)
    x = state.x.copy()
    x[:, 3:ROOT] = 0.0
    assert not turns(problem, replace(state, x=x)).any()
    x[5, 3] = np.radians(60)
    assert np.array_equal(turns(problem, replace(state, x=x)), np.arange(len(x)) >= 5)


def test_the_turn_of_an_arm_is_seen_by_its_bent_elbow_only():
    whole = setting("pixels")
    problem = problem_of(whole, whole.recording, Noise(1.0, 0.01, 0.1))
    elbow, turn, across = (
        whole.hinges.names.index(f"robot:left_{part}") for part in ("elbow", "shoulder_rotation", "shoulder_ad_ab")
    )
    spreads = []
    for angle in (problem.high[elbow], np.radians(-90)):
        x = problem.mean[:3].copy()
        x[:, ROOT + elbow] = angle
        spreads.append(spread(whole, problem, x).mean(axis=0))
    straight, bent = spreads
    assert straight[turn] > 1.2 * bent[turn]
    assert straight[turn] > 2 * straight[across]


def spread(whole, problem, x):
    """Return the spread of postures that look like *x*."""
    usual = np.array([item.sd for item in usual_of(whole.hinges)[ROOT:]])
    bounds = AngleBounds(usual, problem.low, problem.high)
    scale = Scale(whole.recording.trunk, whole.start.height_m, problem.rate_hz)
    return spread_of_alike(problem.skeleton, problem.shape, problem.observed, x, bounds, scale, problem.mean[0, ROOT:])


@pytest.fixture(scope="module")
def moved():
    """Return a child that moves by itself, in physics, and the fit to its film by one camera, without noise."""
    spec, model, qpos = moving_children.moving_child("general movements", 3, 1.5)
    film = replace(known_motions.film(model, qpos, moving_children.RATE_HZ, known_motions.ALL_POINTS), depth_m=None)
    return model, qpos, mimoc.retarget(film, spec.age_months)


@pytest.mark.full
def test_one_camera_holds_the_truth_of_motion_that_nothing_in_the_fit_assumes(moved):
    model, qpos, result = moved
    own, account = load_model(result.bundle), result.account
    inside = []
    for column, name in enumerate(account.joints):
        off = result.qpos[:, own.joint(name).qposadr[0]] - qpos[:, model.joint(name).qposadr[0]]
        inside.append(np.abs(off) <= QUANTILE * account.angle_sd_rad[:, column])
    assert np.mean(inside) > 0.85
    assert CALIBRATED in account.notes


def test_lengths_of_one_camera_are_no_surer_than_overall_size(moved):
    for interval in moved[-1].account.lengths_m.values():
        assert np.log(interval.high / interval.low) > 2 * QUANTILE * 0.9 * OVERALL_SD
        assert interval.low < interval.value < interval.high


def test_hinges_that_one_camera_cannot_see_are_said_to_be_unseen(moved):
    account = moved[-1].account
    assert {"robot:left_hand1", "robot:right_hand1"} <= {*account.unseen} < {*account.joints}
    assert any(note.startswith(NOT_SEEN) and "left_hand1" in note for note in account.notes)


def test_only_one_camera_without_depth_is_calibrated():
    assert CALIBRATED in setting("pixels").notes
    assert not any(CALIBRATED in setting(kind).notes for kind in ("depth", "space"))
