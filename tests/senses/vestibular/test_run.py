import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from mimoc.senses.vestibular import VestibularEntry
from mimoc.senses.vestibular.run import bind

GRAVITY_M_S2 = 9.81
HEAD = """
<mujoco>
  <worldbody>
    <body name="head" gravcomp="{held}">
      <freejoint/>
      <geom size="0.06" mass="1"/>
      <site name="ear"/>
    </body>
  </worldbody>
  <sensor><gyro name="gyro" site="ear"/><accelerometer name="acc" site="ear"/></sensor>
</mujoco>
"""
ENTRY = VestibularEntry(accelerometer="acc", gyro="gyro")

vectors = arrays(np.float64, 3, elements=st.floats(-10, 10))
quaternions = arrays(np.float64, 4, elements=st.floats(-1, 1)).filter(lambda q: np.linalg.norm(q) > 0.1)


def bound(held, entry=ENTRY):
    """Return a head in the air, held against gravity or not, and its sense of balance."""
    model = mujoco.MjModel.from_xml_string(HEAD.format(held=int(held)))
    return model, mujoco.MjData(model), bind(entry, bundle=None, model=model)


def rotation(quaternion):
    """Return the rotation from the head's frame to the world's, shape (3, 3)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion / np.linalg.norm(quaternion))
    return matrix.reshape(3, 3)


@given(quaternions)
def test_at_rest_it_feels_gravity_upward_in_the_heads_frame(quaternion):
    model, data, sense = bound(held=True)
    data.qpos[3:] = quaternion / np.linalg.norm(quaternion)
    mujoco.mj_forward(model, data)
    up_head = rotation(quaternion).T @ [0, 0, 1]
    assert sense(data) == pytest.approx([*(GRAVITY_M_S2 * up_head), 0, 0, 0], abs=1e-9)


@given(quaternions, vectors)
def test_it_feels_the_rate_at_which_the_head_turns(quaternion, rate_head_rad_s):
    """After the acceleration, about the axes of the head, however the head is held."""
    model, data, sense = bound(held=False)
    data.qpos[3:] = quaternion / np.linalg.norm(quaternion)
    data.qvel[3:] = rate_head_rad_s
    mujoco.mj_forward(model, data)
    assert sense(data) == pytest.approx([0, 0, 0, *rate_head_rad_s], abs=1e-9)


@pytest.mark.matrix
def test_free_fall_feels_like_nothing():
    model, data, sense = bound(held=False)
    mujoco.mj_forward(model, data)
    assert sense(data) == pytest.approx(np.zeros(6), abs=1e-9)


def test_the_layout_says_acceleration_first(env):
    assert env.layout("vestibular") == (
        *(f"vestibular_acc.{axis} [m/s²]" for axis in "xyz"),
        *(f"vestibular_gyro.{axis} [rad/s]" for axis in "xyz"),
    )


@pytest.mark.parametrize(("include", "part"), [("accelerometer", slice(0, 3)), ("gyro", slice(3, 6))])
def test_each_half_can_be_sensed_alone(open_env, include, part):
    both, half = open_env(senses={"vestibular": {}}), open_env(senses={"vestibular": {"include": [include]}})
    assert half.layout("vestibular") == both.layout("vestibular")[part]
    command = both.action_space.high
    for env in (both, half):
        env.reset(seed=0)
    samples = [env.step(command)[0]["vestibular"] for env in (both, half)]
    assert np.array_equal(samples[1], samples[0][part])


@pytest.mark.matrix
@pytest.mark.parametrize("pose", ["supine", "prone"])
def test_an_infant_that_lies_still_feels_gravity(open_env, pose):
    env = open_env(scene={"kind": "flat", "pose": pose})
    env.reset(seed=0)
    for _ in range(500):
        sample = env.step(np.zeros(44))[0]["vestibular"]
    head_from_world = env.data.body("head").xmat.reshape(3, 3).T
    assert sample[:3] == pytest.approx(head_from_world @ [0, 0, GRAVITY_M_S2], abs=0.05)
    assert sample[3:] == pytest.approx(np.zeros(3), abs=0.02)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_an_infant_that_turns_in_the_air_feels_how_fast(open_env, axis):
    env = open_env(scene={"kind": "empty"})
    env.reset(seed=0)
    hip, head = (env.data.body(name).xmat.reshape(3, 3) for name in ("hip", "head"))
    env.data.qvel[3 + axis] = 2.0
    mujoco.mj_forward(env.model, env.data)
    turning = env.step(np.zeros(44))[0]["vestibular"][3:]
    assert turning == pytest.approx(2.0 * head.T @ hip[:, axis], abs=0.3)
    assert np.linalg.norm(turning) == pytest.approx(2.0, abs=0.3)
