"""What is declared of a model is saved and restored, and nothing else."""

import copy

import mujoco
import numpy as np
import pytest

from mimoc.base.mujoco_layout import (
    LOCK_ANGLE,
    TIME_CONSTANT,
    WELD_ANCHOR,
    WELD_PLACE,
    WELD_TURN,
    AffineBias,
    MuscleParameters,
)
from mimoc.runtime.model_fields import ModelField, ModelFields

XML = """
<mujoco>
  <worldbody>
    <body name="a"><geom size=".1"/></body>
    <body name="b"><geom size=".2"/></body>
  </worldbody>
</mujoco>"""


def test_rows_that_are_declared_are_restored():
    model = mujoco.MjModel.from_xml_string(XML)
    fields = ModelFields(model, [ModelField("body_mass", np.array([1])), ModelField("geom_size", np.array([0, 1]))])
    before, sizes = fields.state, model.geom_size.copy()
    model.body_mass[:] = 7.0
    model.geom_size[:] = 0.5
    fields.state = before
    assert model.body_mass[1] == before[0][0] != 7.0
    assert model.body_mass[2] == 7.0
    assert np.array_equal(model.geom_size, sizes)


def test_a_state_is_a_copy():
    model = mujoco.MjModel.from_xml_string(XML)
    fields = ModelFields(model, [ModelField("body_mass", np.array([1, 2]))])
    state = fields.state
    model.body_mass[:] = 7.0
    assert not (state[0] == 7.0).any()


def test_what_an_episode_changed_is_inherited_and_the_rest_is_of_the_new_age():
    young, old = (mujoco.MjModel.from_xml_string(XML.replace('size=".2"', size)) for size in ('size=".2"', 'size=".3"'))
    fields = [ModelField("body_mass", np.array([1, 2])), ModelField("geom_size", np.array([0, 1]))]
    before, after = ModelFields(young, fields), ModelFields(old, fields)
    expected = old.body_mass[2]
    young.body_mass[1] = 7.0
    after.inherit(before)
    assert old.body_mass[1:].tolist() == [7.0, expected]
    assert old.geom_size[:, 0].tolist() == [0.1, 0.3]
    assert old.body_subtreemass[0] == old.body_mass.sum()


def test_a_model_is_had_as_it_was_built():
    model = mujoco.MjModel.from_xml_string(XML)
    fields, built = ModelFields(model, [ModelField("body_mass", np.array([1]))]), model.body_mass.copy()
    model.body_mass[1] = 7.0
    other = copy.copy(model)
    fields.write_as_built(other)
    assert np.array_equal(other.body_mass, built)
    assert model.body_mass[1] == 7.0


LAYOUT_XML = """
<mujoco>
  <worldbody>
    <body name="a" pos="1 2 3" quat="0 1 0 0">
      <joint name="hinge" axis="0 1 0"/>
      <geom size=".1"/>
    </body>
  </worldbody>
  <equality>
    <joint name="lock" joint1="hinge" polycoef=".25 0 0 0 0"/>
    <weld name="weld" body1="a" anchor=".1 .2 .3" relpose="4 5 6 0 0 1 0"/>
  </equality>
  <actuator>
    <muscle joint="hinge" timeconst=".02 .04" lengthrange="0 1" range=".7 1.1" force="5" scale="150" lmin=".4"
            lmax="1.7" vmax="2" fpmax="1.4" fvmax="1.3"/>
    <position joint="hinge" kp="30" kv="2"/>
  </actuator>
</mujoco>"""


@pytest.fixture(scope="module")
def model():
    return mujoco.MjModel.from_xml_string(LAYOUT_XML)


def test_parameters_of_muscles_stand_where_they_are_named(model):
    wanted = MuscleParameters(0.7, 1.1, 5.0, 150.0, 0.4, 1.7, 2.0, 1.4, 1.3)
    for parameters in (model.actuator_gainprm[0], model.actuator_biasprm[0]):
        assert MuscleParameters(*parameters[: len(wanted)].tolist()) == pytest.approx(wanted)
    assert model.actuator_dynprm[0, TIME_CONSTANT] == 0.02


def test_the_bias_of_a_servo_is_affine(model):
    assert AffineBias(*model.actuator_biasprm[1, :3].tolist()) == AffineBias(0.0, -30.0, -2.0)


def test_a_lock_has_its_angle_and_a_weld_anchor_and_pose(model):
    lock, weld = model.equality("lock").data, model.equality("weld").data
    assert lock[LOCK_ANGLE] == 0.25
    assert np.array_equal(weld[WELD_ANCHOR], (0.1, 0.2, 0.3))
    assert len(weld[WELD_PLACE]) == 3
    assert np.linalg.norm(weld[WELD_TURN]) == pytest.approx(1.0)
