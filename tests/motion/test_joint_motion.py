"""Motions pass through their frames, have MuJoCo's velocities, and read back as they were written."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from mimoc.base.errors import MimocError
from mimoc.motion.joint_motion import JointMotion, pack_motion, read_motion

XML = (
    "<mujoco><worldbody><body><freejoint name='root'/><geom size='.1'/>"
    "<body><joint name='elbow'/><geom size='.1'/></body></body></worldbody></mujoco>"
)


def any_motion(seed: int, frames: int) -> JointMotion:
    generator = np.random.default_rng(seed)
    turns = generator.normal(size=(frames, 4))
    turns = np.cumsum(0.2 * turns, axis=0) + np.array([3.0, 0, 0, 0])
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    qpos = np.concatenate([generator.normal(size=(frames, 3)), turns, generator.normal(size=(frames, 1))], axis=1)
    return JointMotion(30.0, ("root", "elbow"), qpos, ("root",))


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), frames=st.integers(2, 12))
def test_a_motion_passes_through_its_frames(seed, frames):
    motion = any_motion(seed, frames)
    there = motion.at(np.arange(frames) / 30.0).qpos
    signs = np.sign((there[:, 3:7] * motion.qpos[:, 3:7]).sum(axis=1, keepdims=True))
    there[:, 3:7] *= signs  # A quaternion and its negative are the same rotation.
    assert np.allclose(there, motion.qpos, atol=1e-9)


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 1000))
def test_velocities_and_accelerations_are_those_of_mujoco(seed):
    model, motion, h = mujoco.MjModel.from_xml_string(XML), any_motion(seed, 6), 1e-5
    before, now, after = (motion.at(np.array([0.07 + step])) for step in (-h, 0.0, h))
    speed = np.zeros(model.nv)
    mujoco.mj_differentiatePos(model, speed, 2 * h, before.qpos[0], after.qpos[0])
    assert np.allclose(speed, now.qvel[0], atol=1e-3, rtol=1e-4)
    assert np.allclose((after.qvel - before.qvel) / (2 * h), now.qacc, atol=1e-2, rtol=1e-2)


def test_a_motion_reads_back_equal(tmp_path):
    motion = any_motion(1, 5)
    (tmp_path / "motion.npz").write_bytes(pack_motion(motion))
    for place in (tmp_path, tmp_path / "motion.npz"):
        again = read_motion(place)
        assert (again.rate_hz, again.joints, again.free) == (30.0, motion.joints, motion.free)
        assert np.array_equal(again.qpos, motion.qpos)


def spoilt(rate_hz: float = 30.0, **values: float) -> bytes:
    """Return the file of a motion some of whose numbers are others; `turn` are all of its quaternions."""
    motion = any_motion(1, 5)
    if "turn" in values:
        motion.qpos[:, 3:7] = values["turn"]
    if "angle" in values:
        motion.qpos[2, 7] = values["angle"]
    return pack_motion(JointMotion(rate_hz, motion.joints, motion.qpos, motion.free))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"PK",
        pack_motion(JointMotion(30.0, ("a", "b"), np.zeros((4, 1)))),
        spoilt(turn=0.0),
        spoilt(turn=1.0),
        spoilt(angle=np.nan),
        spoilt(angle=1e300),
        spoilt(rate_hz=1e-9),
    ],
)
def test_a_damaged_motion_is_one_line(tmp_path, content):
    (tmp_path / "motion.npz").write_bytes(content)
    with pytest.raises(MimocError, match=r"damaged; give the folder") as caught:
        read_motion(tmp_path)
    assert "\n" not in str(caught.value)


def test_an_infant_without_a_joint_is_refused():
    model = mujoco.MjModel.from_xml_string(XML.replace("elbow", "knee"))
    with pytest.raises(MimocError, match="moves the joint 'elbow'"):
        any_motion(1, 3).places(model)
