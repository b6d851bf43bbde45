"""What the runtime is told is what the compiled model has."""

import json

import mujoco
import pytest
from support import store

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.body.kinematics import stature
from mimoc.bundle.manifest import Manifest, to_data
from mimoc.fits import measure


def manifest_of(**sections) -> Manifest:
    return store.built({"mimoc": 1, "name": "x", "age_months": 9, **sections}).manifest


def test_the_manifest_in_memory_is_the_one_in_the_file(bundle_at):
    bundle = bundle_at(9)
    assert Manifest.model_validate_json(bundle.files["manifest.json"]) == bundle.manifest
    assert json.loads(bundle.files["manifest.json"]) == json.loads(json.dumps(to_data(bundle.manifest)))


@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_names_are_those_of_the_compiled_model_in_its_order(bundle_at, infant_at, age_months, hands_and_chest):
    manifest, model = bundle_at(age_months, *hands_and_chest).manifest, infant_at(age_months, *hands_and_chest).model
    assert manifest.root_body == model.body(1).name
    assert manifest.root_joint == model.joint(0).name
    assert list(manifest.poses) == [model.key(index).name for index in range(model.nkey)]
    actuators = manifest.actuation.actuators
    assert [actuator.name for actuator in actuators] == [model.actuator(index).name for index in range(model.nu)]
    for actuator in actuators:
        compiled = model.actuator(actuator.name)
        assert model.joint(compiled.trnid[0]).name == actuator.joint
        assert [actuator.action_low, actuator.action_high] == list(compiled.ctrlrange)
    senses = manifest.senses
    assert list(senses.proprioception.joints) == [model.joint(index).name for index in range(1, model.njnt)]
    for sensor in (*senses.proprioception.torque_sensors, senses.vestibular.accelerometer, senses.vestibular.gyro):
        assert model.sensor(sensor).dim[0] == 3


@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_the_child_is_the_body_as_measured(bundle_at, age_months):
    child = bundle_at(age_months).manifest.child
    found = stature(grow_tree(measure(age_months), assemble("mitten", False)))
    assert child.age_months == age_months
    assert child.model_dump(exclude={"age_months", "sex", "clothes"}) == pytest.approx(dict(found), rel=1e-8)


def test_the_clock_and_the_pose_are_the_specs():
    manifest = manifest_of(control={"step_ms": 20, "timestep_ms": 2.5}, scene={"pose": "sitting"})
    assert (manifest.step_ms, manifest.timestep_ms, manifest.pose) == (20, 2.5, "sitting")


def test_a_sense_that_is_not_named_is_off():
    senses = manifest_of(senses={"vestibular": {}}).senses
    assert senses.proprioception is None
    assert senses.vestibular is not None


def test_proprioception_includes_what_was_asked_for_in_that_order():
    senses = manifest_of(senses={"proprioception": {"include": ["limits", "velocity"]}}).senses
    assert senses.proprioception.include == ("limits", "velocity")


def test_the_timestep_is_the_models():
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "control": {"step_ms": 20, "timestep_ms": 2.5}}
    files = store.built(spec).files
    assert mujoco.MjModel.from_xml_string(files["infant.xml"].decode(), dict(files)).opt.timestep == 0.0025
