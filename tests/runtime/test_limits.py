"""How strong an infant is, whatever drives it."""

import numpy as np
import pytest

import mimoc


@pytest.fixture(scope="module", params=["mitten", "five_finger"])
def limits_of(request):
    """Return what gives the limits of an infant of an actuation section."""

    def limits_of(**actuation):
        spec = {"mimoc": 1, "name": "x", "age_months": 9, "actuation": actuation}
        body = {"hands": request.param}
        return mimoc.torque_limits(mimoc.build(mimoc.InfantSpec.model_validate({**spec, "body": body})))

    return limits_of


def test_motors_have_the_limits_of_gear_and_force_range(bundle_at, infant_at):
    limits, model = mimoc.torque_limits(bundle_at(18)), infant_at(18).model
    assert limits["robot:left_elbow"] == pytest.approx((-3.6, 0.83 * 3.6))
    assert limits["robot:right_shoulder_ad_ab"] == pytest.approx((-0.6875 * 4, 4))
    assert list(limits) == [model.joint(model.actuator(index).trnid[0]).name for index in range(model.nu)]


def test_muscles_have_the_limits_of_motors_within_a_tenth(limits_of):
    motors, muscles = limits_of(), limits_of(model="muscle")
    assert motors.keys() == muscles.keys()
    for joint in motors:
        assert muscles[joint] == pytest.approx(motors[joint], rel=0.1)
        assert muscles[joint][0] < 0 < muscles[joint][1]


def test_servos_have_the_limits_of_motors(limits_of):
    motors, servos = limits_of(), limits_of(model="position")
    assert motors.keys() == servos.keys()
    for joint in motors:
        assert servos[joint] == pytest.approx(motors[joint])


@pytest.mark.parametrize("model", ["torque", "muscle", "position"])
def test_limits_follow_the_strength_of_the_spec(limits_of, model):
    plain, strong = limits_of(model=model), limits_of(model=model, strength={"legs": 2, "left_leg": 3, "neck": 0})
    assert strong["robot:right_knee"] == pytest.approx(np.multiply(2, plain["robot:right_knee"]))
    assert strong["robot:left_knee"] == pytest.approx(np.multiply(3, plain["robot:left_knee"]))
    assert strong["robot:head_tilt"] == (0, 0)
    assert strong["robot:left_elbow"] == plain["robot:left_elbow"]


def test_limits_are_read_from_a_folder_too(bundle_at, tmp_path):
    folder = mimoc.write_bundle(bundle_at(9), tmp_path / "out")
    assert mimoc.torque_limits(folder) == mimoc.torque_limits(str(folder)) == mimoc.torque_limits(bundle_at(9))
