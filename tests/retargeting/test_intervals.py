"""Intervals of a linear model contain the truth as often as they say; noise is estimated without bias."""

import numpy as np
import pytest
from support.retargeting import setting

from mimoc.retargeting.banded import NormalEquations
from mimoc.retargeting.prior import Usual, chain
from mimoc.retargeting.result import QUANTILE, Interval
from mimoc.retargeting.setting import CALIBRATED
from mimoc.retargeting.uncertainty import (
    ADDED_DEG,
    ENDS,
    LENGTHS_WIDER,
    WIDER,
    WIDER_REST,
    Uncertainty,
    widened,
)

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


HINGES = [f"robot:{name}" for name in ("left_shoulder_horizontal", "right_knee", "hip_bend1", "head_tilt")]


def wide(points=("right_ankle", "nose"), size_is_known=False) -> Uncertainty:
    """Return what one camera leaves open of hinges whose SD is 1 degree."""
    sure = Uncertainty((1.0,), np.radians(np.ones((2, 4))), np.ones((2, 1)), np.eye(3))
    return widened(sure, HINGES, points, size_is_known)


def test_one_camera_has_wider_angles_and_says_so_but_none_with_depth():
    factors = [WIDER["shoulder_horizontal"], WIDER["knee"], WIDER["hip_"], WIDER_REST]
    assert np.degrees(wide().angle_sd_rad) == pytest.approx(np.tile(factors, (2, 1)))
    assert CALIBRATED in setting("pixels").notes
    assert not any(CALIBRATED in setting(kind).notes for kind in ("depth", "space"))


def test_the_sd_of_a_knee_without_an_ankle_and_of_a_head_without_a_face_has_a_least_value():
    least = [ADDED_DEG["knee"], ADDED_DEG["head"]]
    assert np.degrees(wide(points=("right_knee", "head")).angle_sd_rad[0, [1, 3]]) == pytest.approx(least, rel=0.01)
    assert ADDED_DEG.keys() == ENDS.keys()


def test_lengths_are_wider_only_where_the_height_of_one_camera_is_known():
    assert np.diag(wide(size_is_known=True).shared_covariance) == pytest.approx([1.0, *[LENGTHS_WIDER**2] * 2])
    assert np.array_equal(wide().shared_covariance, np.eye(3))
