"""Motions for mjlab have its arrays, in its order and frames."""

import numpy as np
import pytest
from support.store import built

import mimoc

SPEC = {"mimoc": 1, "name": "kim", "age_months": 3, "senses": {"proprioception": {}}}
SHAPES = {"body_pos_w": 3, "body_quat_w": 4, "body_lin_vel_w": 3, "body_ang_vel_w": 3}


def test_a_motion_has_joints_and_bodies_at_each_control_step(tmp_path):
    with mimoc.Recorder(mimoc.make(built(SPEC)), tmp_path / "run") as env:
        env.reset(seed=0)
        for _ in range(20):
            env.step(0.1 * env.action_space.sample())
    (note,) = mimoc.export_recording(tmp_path / "run", "mjlab", tmp_path / "out")
    assert "left out" in note
    with np.load(tmp_path / "out" / "0000-000000.npz") as motion:
        frames, bodies = 21, len(motion["body_names"])
        assert motion["fps"].tolist() == [100.0]
        assert motion["joint_pos"].shape == motion["joint_vel"].shape == (frames, len(motion["joint_names"]))
        for name, size in SHAPES.items():
            assert motion[name].shape == (frames, bodies, size)
        assert np.linalg.norm(motion["body_quat_w"], axis=-1) == pytest.approx(np.ones((frames, bodies)), abs=1e-5)
        speeds = np.gradient(motion["body_pos_w"][:, 0].astype(float), 0.01, axis=0)
        assert np.allclose(speeds[5:-5], motion["body_lin_vel_w"][5:-5, 0], atol=0.05)
