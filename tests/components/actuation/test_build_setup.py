"""What drives the joints, whatever the actuation model."""

import mujoco
import numpy as np
import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.compiler.actuation.setup import build_actuation
from mimoc.fits import measure
from mimoc.schema.actuation import ActuationSpec
from mimoc.schema.components.actuation import ACTUATIONS

TIMESTEP_S = 0.005


@pytest.fixture(scope="module", params=["mitten", "five_finger"])
def tree(request):
    return grow_tree(measure(18), assemble(request.param, True))


@pytest.mark.parametrize("model", ACTUATIONS)
def test_every_actuator_moves_the_joint_of_mimos(model, tree):
    actuators = build_actuation(ActuationSpec(model=model), tree, TIMESTEP_S).actuators
    joints = {motor.name: motor.joint for motor in tree.motors}
    assert {actuator.mimo_actuator for actuator in actuators} == joints.keys()
    assert all(actuator.joint == joints[actuator.mimo_actuator] for actuator in actuators)
    assert len({actuator.name for actuator in actuators}) == len(actuators)


@pytest.mark.parametrize("model", ACTUATIONS)
def test_a_body_has_an_actuator_a_joint_or_two_muscles(model, tree):
    count = len(build_actuation(ActuationSpec(model=model), tree, TIMESTEP_S).actuators) // (
        2 if model == "muscle" else 1
    )
    assert count == (46 if len(tree.motors) < 50 else 90)


@pytest.mark.parametrize("model", ACTUATIONS)
def test_an_actuation_model_leaves_a_joint_all_but_its_spring_and_damper(model, driven):
    plain, changed = driven("torque", 9, "five_finger"), driven(model, 9, "five_finger")
    for what in ("jnt_axis", "jnt_range", "dof_frictionloss", "dof_armature", "jnt_pos", "body_mass"):
        assert np.array_equal(getattr(changed, what), getattr(plain, what)), what


def test_full_activation_is_the_gear_within_the_force_range(infant_at):
    """On the compiled model: torque = gear x activation, cut off at the force range."""
    model = infant_at(18).model
    data = mujoco.MjData(model)
    elbow = model.actuator("act:left_elbow")
    for command, torque_nm in ((1, 0.83 * 3.6), (0.5, 1.8), (-1, -3.6), (-5, -3.6)):
        data.act[elbow.actadr[0]] = command
        mujoco.mj_forward(model, data)
        assert data.joint("robot:left_elbow").qfrc_actuator[0] == pytest.approx(torque_nm)
