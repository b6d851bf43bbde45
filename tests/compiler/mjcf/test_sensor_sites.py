"""Sites, cameras and sensors are MIMo's, in MIMo's order."""

import mujoco
import numpy as np
import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.compiler.mjcf import sensor_sites
from mimoc.compiler.mjcf.sensor_sites import PREFIX
from mimoc.fits import measure


def floats(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def test_sites_are_mimos(model, published):
    """Between them stand the keypoints of BODY_25, which MIMo adds where it needs them."""
    rows = published("sites")
    names = [model.site(index).name for index in range(model.nsite)]
    assert [name for name in names if not name.startswith(PREFIX)] == [row["name"] for row in rows]
    for row in rows:
        site = model.site(row["name"])
        assert model.body(site.bodyid[0]).name == row["body"]
        assert site.size[0] == floats(row["size_m"])[0]


def test_sensors_are_mimos(model, published):
    rows = published("sensors")
    assert [model.sensor(index).name for index in range(model.nsensor)] == [row["name"] for row in rows]
    for row in rows:
        sensor = model.sensor(row["name"])
        assert sensor.type[0] == getattr(mujoco.mjtSensor, f"mjSENS_{row['kind'].upper()}")
        assert model.site(sensor.objid[0]).name == row["site"]
        assert sensor.dim[0] == 3


def test_cameras_are_mimos(model, published):
    rows = published("cameras")
    assert [model.camera(index).name for index in range(model.ncam)] == [row["name"] for row in rows]
    for row in rows:
        camera = model.camera(row["name"])
        assert model.body(camera.bodyid[0]).name == row["body"]
        assert camera.fovy[0] == float(row["fovy_deg"])


@pytest.mark.parametrize("side", ["left", "right"])
def test_eyes_look_ahead_from_the_front_of_the_eyeball(infants, side):
    """Upright; MuJoCo's cameras look along -z. MIMo v2 left the cameras behind when eyes grow."""
    for infant in infants:
        camera, eye = infant.data.camera(f"eye_{side}"), infant.data.geom(f"{side}_eye1")
        radius_m = infant.model.geom(f"{side}_eye1").size[0]
        right, up, back = camera.xmat.reshape(3, 3).T
        assert camera.xpos == pytest.approx(eye.xpos + np.array([radius_m, 0, 0]), abs=1e-9)
        assert np.stack([right, up, back]) == pytest.approx(np.array([[0, -1, 0], [0, 0, 1], [-1, 0, 0]]), abs=1e-8)


def test_the_eye_looks_out_of_the_head(infants):
    """A camera inside the head would see the inside of the head."""
    for infant in infants:
        head = infant.data.geom("head")
        local = head.xmat.reshape(3, 3).T @ (infant.data.camera("eye_left").xpos - head.xpos)
        assert np.linalg.norm(local / infant.model.geom("head").size) > 1.02


def test_balance_is_felt_in_the_middle_of_the_head(infants):
    for infant in infants:
        assert infant.data.site("vestibular").xpos == pytest.approx(infant.data.geom("head").xpos, abs=1e-9)


def test_at_rest_balance_is_gravity_upwards(infant_at):
    model = infant_at(9).model
    data = mujoco.MjData(model)
    data.qpos[2] = 10
    mujoco.mj_forward(model, data)
    assert data.sensor("vestibular_gyro").data == pytest.approx([0, 0, 0])
    assert np.linalg.norm(data.sensor("vestibular_acc").data) < 2, "in free fall nothing is felt but springs"


def test_torque_is_felt_between_every_part_and_its_parent(model):
    """Everywhere but at the hip, which hangs in the world."""
    sensors = [model.sensor(index) for index in range(model.nsensor) if model.sensor(index).name.startswith("proprio:")]
    felt = [model.body(model.site_bodyid[sensor.objid[0]]).name for sensor in sensors]
    bodies = {model.body(index).name for index in range(1, model.nbody)}
    assert sorted([*felt, "hip"]) == sorted(bodies)


def test_the_field_of_view_is_the_one_asked_for():
    cameras = sensor_sites.cameras(grow_tree(measure(9), assemble("mitten", False)), fovy_deg=75)
    assert [camera.fovy_deg for placed in cameras.values() for camera in placed] == [75, 75]
