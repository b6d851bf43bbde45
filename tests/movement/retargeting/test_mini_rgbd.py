"""The script that measures errors in space on MINI-RGBD reads its published layout, and measures what it says."""

import numpy as np
import pytest
from support.retargeting import known, known_motions

from mimoc.motion.body_points import locate
from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.motion.read_mini_rgbd import JOINTS, POINTS

import mini_rgbd  # isort: skip  # `support.retargeting` puts benchmarks on the path.

HEIGHT_M = 1.08


@pytest.fixture(scope="module")
def data_set(tmp_path_factory):
    """Return a folder with one sequence of 12 frames, in millimetres, as the data set has it."""
    _, qpos, model, _ = known(5, frames=12)
    names = [name for name in POINTS if name not in ("left_wrist", "right_wrist")]
    seen_m = (locate(model, qpos, names) - [0, 0, HEIGHT_M]) * [1, -1, -1]
    seen = known_motions.film(model, qpos, 30.0, names)
    folder = tmp_path_factory.mktemp("data") / "01"
    for kind, places in (("3D", 1000 * seen_m), ("2Ddep", np.dstack([seen.positions, 1000 * seen_m[..., 2]]))):
        (folder / f"joints_{kind}").mkdir(parents=True)
        for frame, rows in enumerate(places):
            lines = [f"{x} {y} {z} {JOINTS.index(POINTS[n])}" for n, (x, y, z) in zip(names, rows, strict=True)]
            (folder / f"joints_{kind}" / f"syn_joints_{kind}_{frame:05d}.txt").write_text("\n".join(lines))
    return folder.parent


@pytest.mark.full
def test_a_film_with_depth_is_some_millimetres_off(data_set):
    as_it_is, hips, laid = mini_rgbd.errors_m(data_set / "01", 9.0, 12, with_depth=True)
    assert laid < as_it_is < 0.02
    assert hips < 0.02


def test_turned_moved_and_scaled_points_are_laid_on_the_truth():
    draw = np.random.default_rng(0)
    truth = draw.normal(size=(4, len(MINI_RGBD_POINTS), 3))
    moved = 1.3 * truth[..., [1, 2, 0]] + [0.1, 0.2, 0.3]
    apart, _, laid = mini_rgbd.distances_m(moved, truth, list(MINI_RGBD_POINTS))
    assert laid == pytest.approx(np.zeros_like(laid), abs=1e-12)
    assert apart.mean() > 0.1
    shifted = mini_rgbd.distances_m(truth + np.array([0.1, 0, 0]), truth, list(MINI_RGBD_POINTS))
    assert shifted[0] == pytest.approx(0.1 * np.ones_like(apart))
    assert shifted[1] == pytest.approx(np.zeros_like(apart), abs=1e-12)


def test_mirrored_points_are_not_laid_on_the_truth():
    truth = np.random.default_rng(1).normal(size=(1, len(MINI_RGBD_POINTS), 3))
    assert mini_rgbd.distances_m(truth * [-1, 1, 1], truth, list(MINI_RGBD_POINTS))[2].mean() > 0.1
