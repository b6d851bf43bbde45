"""What is declared of a model is saved and restored, and nothing else."""

import copy

import mujoco
import numpy as np

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
