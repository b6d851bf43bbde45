from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from pydantic import ValidationError
from support.full import full_but

from mimoc.components.senses.vestibular import CanalsEntry, VestibularEntry, VestibularSpec, build
from mimoc.components.senses.vestibular.run import bind, bind_noise
from mimoc.runtime.noise import NoiseStreams, SignalNoise, processing_of
from mimoc.schema.senses import NoiseEntry

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


def canals(months=None, word="age"):
    """Return the entry of canals as built at an age."""
    body = SimpleNamespace(age_months=months)
    return build(VestibularSpec(canals=word), body).entry.canals


def felt(dynamics, times_s, rates_rad_s):
    """Return what is felt of a head that is turned at some rates, [rad/s], by a sense that goes through a schedule."""
    model, data, _ = bound(held=True)
    sense = bind(ENTRY.model_copy(update={"canals": dynamics}), bundle=None, model=model)
    organ = SignalNoise(processing_of("vestibular", sense, NoiseEntry()), "vestibular", NoiseStreams(0))
    result = []
    for time_s, rate_rad_s in zip(times_s, rates_rad_s, strict=True):
        data.qvel[5] = rate_rad_s
        mujoco.mj_forward(model, data)
        result.append(organ.at(time_s, sense(data)))
    return np.array(result)


def transfer(dynamics, frequency_hz):
    """Return H at a frequency, as the reference has it."""
    s = 2j * np.pi * frequency_hz
    whole, adaptation = (time_s * s / (1 + time_s * s) for time_s in (dynamics.time_constant_s, dynamics.adaptation_s))
    return whole * adaptation * (1 + dynamics.lead_s * s) / (1 + dynamics.lag_s * s)


@pytest.mark.parametrize("dynamics", [canals(0), canals(24), canals(word="afferent")], ids=["0", "24", "afferent"])
@pytest.mark.parametrize("frequency_hz", [0.01, 0.1, 0.5, 2.0])
def test_the_canals_have_the_gain_and_the_phase_of_their_transfer_function(dynamics, frequency_hz):
    """Within 2 %, once the start is forgotten: over the last of whole periods, sampled every 10 ms."""
    step_s = max(0.01, 1 / frequency_hz / 400)
    count = round(1 / frequency_hz / step_s)
    times_s = np.arange(5 * count + round(30 / step_s)) * step_s
    response = felt(dynamics, times_s, np.sin(2 * np.pi * frequency_hz * times_s))
    measured = 2j * (response[-count:, 5] * np.exp(-2j * np.pi * frequency_hz * times_s[-count:])).mean()
    assert abs(measured / transfer(dynamics, frequency_hz) - 1) < 0.02


@pytest.mark.parametrize("months", full_but([0, 12], [1, 2, 4, 6, 24]))
def test_a_constant_rotation_is_no_longer_felt_after_a_minute(months):
    """Its own direction is not; what adaptation leaves in the other one is less than a tenth."""
    times_s = np.arange(0, 60.01, 0.01)
    response = felt(canals(months), times_s, np.full(len(times_s), np.deg2rad(60)))[:, 5] / np.deg2rad(60)
    assert response[0] == pytest.approx(1)
    assert -0.1 < response[-1] < 0.05
    assert response[-1] > -0.05 or months > 2


def test_after_a_rotation_stops_it_feels_as_if_it_turned_back():
    times_s = np.arange(0, 61, 0.01)
    response = felt(canals(0), times_s, np.where(times_s < 30, 1.0, 0.0))[:, 5]
    assert response[3002] == pytest.approx(-1, abs=0.1)


@pytest.mark.parametrize("dynamics", [canals(24), canals(word="adult")])
@pytest.mark.parametrize(("frequency_hz", "phase_deg"), [(0.1, 8), (0.5, 1.5), (2.0, 0.4)])
def test_fast_rotations_are_felt_as_they_are_by_the_oldest_and_by_adults(dynamics, frequency_hz, phase_deg):
    gain = transfer(dynamics, frequency_hz)
    assert abs(gain) == pytest.approx(1, rel=0.01)
    assert 0 < np.rad2deg(np.angle(gain)) < phase_deg


@given(st.floats(0, 24), st.floats(0, 24))
def test_rotation_is_felt_for_longer_by_the_older(one, other):
    young, old = (canals(age).time_constant_s for age in sorted((one, other)))
    assert 4 <= young <= old <= 15


def test_a_leading_canal_begins_an_episode_as_if_it_had_always_turned():
    response = felt(canals(word="afferent"), np.arange(0, 0.1, 0.01), np.ones(10))[:, 5]
    assert response == pytest.approx(np.ones(10), abs=0.03)


def test_otoliths_are_as_they_are_whatever_canals_do():
    times_s = np.arange(0, 30, 0.1)
    assert felt(canals(0), times_s, np.ones(300))[:, :3] == pytest.approx(np.tile([0, 0, GRAVITY_M_S2], (300, 1)))


@pytest.mark.parametrize(
    "wrong",
    [
        {"time_constant_s": 5.0, "adaptation_s": 5.0},
        {"time_constant_s": 5.0, "adaptation_s": 80.0, "lead_s": 0.1},
        {"time_constant_s": 0.0, "adaptation_s": 80.0},
    ],
)
def test_time_constants_that_make_no_filter_are_refused(wrong):
    with pytest.raises(ValidationError):
        CanalsEntry(**wrong)


def test_noise_is_in_thresholds_of_rotation_and_of_acceleration():
    sense = bound(held=True)[2]
    assert bind_noise(2.0, sense, 0.06).deviation == pytest.approx([0.06] * 3 + [np.deg2rad(2)] * 3)
