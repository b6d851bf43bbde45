from itertools import combinations
from types import SimpleNamespace
from typing import get_args

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from support.full import full_but

from mimoc.components.senses.proprioception import ProprioceptionEntry, ProprioceptiveQuantity
from mimoc.components.senses.proprioception.run import LIMIT_MARGIN_RAD, bind
from mimoc.schema.actuation import ActuationEntry, ActuatorEntry

LOW_RAD, HIGH_RAD, GEAR_NM = -0.5, 1.2, 3.0
ARM = f"""
<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.001"/>
  <worldbody>
    <body name="arm">
      <joint name="elbow" axis="0 1 0" range="{LOW_RAD} {HIGH_RAD}" limited="true"/>
      <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.02" mass="0.5"/>
      <site name="at_elbow"/>
    </body>
  </worldbody>
  <actuator><motor name="biceps" joint="elbow" gear="{GEAR_NM}" forcerange="-1 1"/></actuator>
  <sensor><torque name="load" site="at_elbow"/></sensor>
</mujoco>
"""
ACTUATION = ActuationEntry(
    actuators=(ActuatorEntry(name="biceps", mimo_actuator="biceps", joint="elbow", action_low=-1, action_high=1),)
)
BUNDLE = SimpleNamespace(manifest=SimpleNamespace(actuation=ACTUATION))
ORDER = ("velocity", "torque", "limits", "actuation")
SUBSETS = [subset for size in range(5) for subset in combinations(ORDER, size)]


def bound(*include):
    """Return an arm and the sense of it."""
    model = mujoco.MjModel.from_xml_string(ARM)
    entry = ProprioceptionEntry(include=include, joints=("elbow",), torque_sensors=("load",))
    return model, mujoco.MjData(model), bind(entry, model, BUNDLE)


def values_of(env, quantity, observation):
    """Return the values of one quantity, by joint, sensor or actuator."""
    names = [name.rsplit(" [", 1)[0].rsplit(" ", 1) for name in env.layout("proprioception")]
    values = zip(names, observation["proprioception"], strict=True)
    return {of: float(value) for (of, kind), value in values if kind == quantity}


def test_what_can_be_sensed_is_what_a_spec_can_include():
    assert get_args(ProprioceptiveQuantity) == ORDER


@pytest.mark.parametrize("include", full_but([(), ("velocity", "limits"), ORDER], SUBSETS), ids="-".join)
def test_each_quantity_is_sensed_if_it_is_included_and_in_its_order(include, open_env):
    env = open_env(senses={"proprioception": {"include": list(include)}})
    manifest, names = env.manifest, env.layout("proprioception")
    joints, sensors = manifest.senses.proprioception.joints, manifest.senses.proprioception.torque_sensors
    actuators = [actuator.name for actuator in manifest.actuation.actuators]
    parts = {
        "angle": [f"{joint} angle [rad]" for joint in joints],
        "velocity": [f"{joint} velocity [rad/s]" for joint in joints],
        "torque": [f"{sensor}.{axis} torque [N m]" for sensor in sensors for axis in "xyz"],
        "limits": [f"{joint} limit [1 at the limit]" for joint in joints],
        "actuation": [f"{name} activation [1]" for name in actuators] + [f"{name} torque [N m]" for name in actuators],
    }
    assert list(names) == [name for part in ("angle", *include) for name in parts[part]]
    assert env.reset(seed=0)[0]["proprioception"].shape == (len(names),)


def test_an_infant_feels_all_its_hinges_and_actuators_and_22_torques(env):
    model, entry = env.model, env.manifest.senses.proprioception
    hinges = [model.joint(i).name for i in range(model.njnt) if model.jnt_type[i] == mujoco.mjtJoint.mjJNT_HINGE]
    assert list(entry.joints) == hinges
    assert [actuator.name for actuator in env.manifest.actuation.actuators] == [
        model.actuator(i).name for i in range(model.nu)
    ]
    assert len(entry.torque_sensors) == 22


def test_angles_are_those_of_the_joints(env):
    for pose in env.manifest.poses:
        angles = values_of(env, "angle", env.reset(options={"pose": pose})[0])
        joints = {joint: float(env.data.joint(joint).qpos[0]) for joint in angles}
        assert angles == pytest.approx(joints, abs=1e-6)


def test_velocities_are_the_derivative_of_angles(open_env):
    env = open_env(control={"step_ms": 5, "timestep_ms": 5})
    before = values_of(env, "angle", env.reset(seed=0)[0])
    for command in np.random.default_rng(0).uniform(-1, 1, (100, 44)):
        observation = env.step(command)[0]
        angles, velocities = values_of(env, "angle", observation), values_of(env, "velocity", observation)
        slopes = {joint: (angles[joint] - before[joint]) / 0.005 for joint in angles}
        assert velocities == pytest.approx(slopes, abs=1e-3)  # Angles have seven digits.
        before = angles


@given(st.floats(-2, 3))
def test_a_limit_is_sensed_from_2_degrees_before_it(angle_rad):
    """0 until the margin, 1 at the limit and rising evenly, also beyond."""
    _, data, sense = bound("limits")
    data.qpos[0] = angle_rad
    angle, limit = sense(data)
    nearness_rad = max(angle_rad - HIGH_RAD, LOW_RAD - angle_rad)
    assert angle == angle_rad
    assert limit == pytest.approx(max(0.0, 1 + nearness_rad / LIMIT_MARGIN_RAD), abs=1e-9)


def test_torque_is_that_of_the_load_about_three_axes():
    """A rod held out level: half its length times its weight, about the hinge."""
    model, data, sense = bound("torque")
    load_nm = 0.1 * 0.5 * 9.81
    data.ctrl[0] = -load_nm / GEAR_NM
    mujoco.mj_forward(model, data)
    assert data.qacc[0] == pytest.approx(0, abs=1e-9)
    assert np.abs(sense(data)[1:]) == pytest.approx([0, load_nm, 0], abs=1e-9)


def test_a_joint_that_falls_freely_carries_no_torque():
    model, data, sense = bound("torque")
    mujoco.mj_forward(model, data)
    assert sense(data)[1:] == pytest.approx([0, 0, 0], abs=1e-9)


@given(st.floats(-1, 1))
def test_actuation_is_sensed_as_command_and_torque(command):
    model, data, sense = bound("actuation")
    data.ctrl[0] = command
    mujoco.mj_forward(model, data)
    assert sense(data)[1:] == pytest.approx([command, command * GEAR_NM])


def test_readings_of_flailing_limbs_stay_well_within_their_bounds(env):
    """So that clipping hides nothing: only a command reaches its bound."""
    high = env.observation_space["proprioception"].high
    largest = np.zeros_like(high)
    for command in np.random.default_rng(0).choice([-1.0, 1.0], (200, 44)):
        largest = np.maximum(largest, np.abs(env.step(command)[0]["proprioception"]))
    driven = 2 * len(env.manifest.actuation.actuators)
    assert (largest[:-driven] < high[:-driven] / 2).all()
    assert (largest[-driven:] <= high[-driven:]).all()
