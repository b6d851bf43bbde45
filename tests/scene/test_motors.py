import mujoco
import pytest

from mimoc.body import grow
from mimoc.fits import measure
from mimoc.scene.motors import MOTORS


@pytest.fixture(scope="module")
def tree():
    return grow(measure(18))


@pytest.mark.parametrize("model", MOTORS)
def test_every_actuator_moves_a_joint_of_the_body(model, tree):
    actuators = MOTORS[model](tree)
    assert {actuator.joint for actuator in actuators} <= tree.joints.keys()
    assert len({actuator.name for actuator in actuators}) == len(actuators)


def test_a_torque_motor_is_mimos(tree):
    (elbow,) = [motor for motor in MOTORS["torque"](tree) if motor.name == "act:left_elbow"]
    assert (elbow.joint, elbow.gear_nm, elbow.force_range) == ("robot:left_elbow", 3.6, (-1, 0.83))
    assert elbow.control_range == (-1, 1)


def test_full_command_is_the_gear_within_the_force_range(infant_at):
    """On the compiled model: torque = gear x command, cut off at the force range."""
    model = infant_at(18).model
    data = mujoco.MjData(model)
    elbow = model.actuator("act:left_elbow")
    for command, torque_nm in ((1, 0.83 * 3.6), (0.5, 1.8), (-1, -3.6), (-5, -3.6)):
        data.ctrl[elbow.id] = command
        mujoco.mj_forward(model, data)
        assert data.joint("robot:left_elbow").qfrc_actuator[0] == pytest.approx(torque_nm)
