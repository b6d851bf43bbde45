"""Sites, cameras and sensors are MIMo's, in MIMo's order; keypoints are where motion capture looks for them."""

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.base.geometry.primitives import depths
from mimoc.body.grow import grow_average, grow_body, grow_tree
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf import sensor_sites
from mimoc.compiler.mjcf.sensor_sites import KEYPOINTS, PREFIX, keypoint_sites
from mimoc.fits import measure


def test_sites_sensors_and_cameras_are_mimos(model, published):
    """Between the sites stand the keypoints of BODY_25, which MIMo adds where it needs them."""
    rows = {kind: published(f"{kind}s") for kind in ("site", "sensor", "camera")}
    for kind, count in (("site", model.nsite), ("sensor", model.nsensor), ("camera", model.ncam)):
        names = [getattr(model, kind)(index).name for index in range(count)]
        assert [name for name in names if not name.startswith(PREFIX)] == [row["name"] for row in rows[kind]]
    for row in rows["site"]:
        site = model.site(row["name"])
        assert model.body(site.bodyid[0]).name == row["body"]
        assert site.size[0] == float(row["size_m"].split()[0])
    for row in rows["sensor"]:
        sensor = model.sensor(row["name"])
        assert sensor.type[0] == getattr(mujoco.mjtSensor, f"mjSENS_{row['kind'].upper()}")
        assert model.site(sensor.objid[0]).name == row["site"]
        assert sensor.dim[0] == 3
    for row in rows["camera"]:
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


def test_the_eye_looks_out_of_the_head_and_balance_is_felt_in_its_middle(infants):
    """A camera inside the head would see the inside of the head."""
    for infant in infants:
        head = infant.data.geom("head")
        local = head.xmat.reshape(3, 3).T @ (infant.data.camera("eye_left").xpos - head.xpos)
        assert np.linalg.norm(local / infant.model.geom("head").size) > 1.02
        assert infant.data.site("vestibular").xpos == pytest.approx(head.xpos, abs=1e-9)


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


NEAR_M = 0.01
MIRROR = np.array([1, -1, 1])


def keypoints(infant) -> dict[str, np.ndarray]:
    return {name: infant.data.site(PREFIX + name).xpos for name in KEYPOINTS}


def outside_m(infant, body: str, point: np.ndarray) -> float:
    """Return how far a point is from the surface of a body; negative inside."""
    distances = []
    for name in infant.geoms(body):
        geom, centre = infant.model.geom(name), infant.data.geom(name).xpos
        local = infant.data.geom(name).xmat.reshape(3, 3).T @ (point - centre)
        distances.append(_distance(geom.type[0], geom.size, local))
    return min(distances)


def _distance(kind: int, size: np.ndarray, local: np.ndarray) -> float:
    if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
        return -float(depths("ellipsoid", size, local[None])[0])
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        beyond = np.abs(local) - size
    elif kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        beyond = np.array([np.hypot(*local[:2]) - size[0], abs(local[2]) - size[1]])
    else:
        beyond = np.array([np.linalg.norm(local - (0, 0, np.clip(local[2], -size[1], size[1]))) - size[0]])
    return float(np.linalg.norm(np.maximum(beyond, 0)) + min(beyond.max(), 0))


def test_names_and_their_order_are_those_of_body_25(bundle_at):
    in_order = ["Nose", "Neck", "RShoulder", "MidHip", "LBigToe", "RHeel"]
    assert [KEYPOINTS[index] for index in (0, 1, 2, 8, 19, 24)] == in_order
    assert len(set(KEYPOINTS)) == 25
    for hands in ("mitten", "five_finger"):
        assert list(bundle_at(9, hands).manifest.keypoints) == [PREFIX + name for name in KEYPOINTS]


def test_every_keypoint_is_a_site_of_the_compiled_body(infants):
    for infant in infants[::24]:
        names = [infant.model.site(index).name for index in range(infant.model.nsite)]
        assert {name for name in names if name.startswith(PREFIX)} == {PREFIX + name for name in KEYPOINTS}


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_at_18_months_they_are_where_mimo_has_them(hands):
    """On head and foot, in m; sk and so on are 1 there (growth.md, section 5)."""
    placed = keypoint_sites(grow_average(18, assemble(hands, False, "published")))
    found = {site.name.removeprefix(PREFIX): (body, site.pos_m) for body, sites in placed.items() for site in sites}
    on_head = {"Nose": (0.0685, 0, 0.0435), "LEar": (0.01, 0.0625, 0.0575), "REar": (0.01, -0.0625, 0.0575)}
    for name, pos_m in on_head.items():
        assert found[name] == ("head", pytest.approx(pos_m, abs=0.002))
    for side, letter in (("left", "L"), ("right", "R")):
        assert found[f"{letter}Heel"] == (f"{side}_foot", pytest.approx((-0.020, 0, 0), abs=0.003))
        assert found[f"{letter}Ankle"][0] == f"{side}_foot"
    assert found["Neck"] == ("head", (0, 0, 0))


STOUT = {"sex": "female", "length_percentile": 1, "weight_percentile": 99, "head_percentile": 50}


@pytest.mark.parametrize(
    "body",
    [
        {"individual": STOUT},
        {"parts": {"hip": {"length": 0.6, "girth": 1.8}}},
        {"individual": STOUT, "remove": ["left_upper_leg"]},
    ],
)
def test_the_middle_of_the_hip_is_between_its_joints_in_any_child(body):
    tree = tree_of(body)
    hip = next(part for part in tree.bodies if part.name == "right_upper_leg").pos_m
    assert middle_of_hip(tree) == pytest.approx((hip[0], 0, hip[2]), abs=1e-9)


def test_without_legs_the_middle_of_the_hip_is_where_it_would_be_with_legs():
    without = tree_of({"remove": ["left_upper_leg", "right_upper_leg"]})
    assert middle_of_hip(without) == pytest.approx(middle_of_hip(tree_of({})), abs=1e-9)


def tree_of(body) -> BodyTree:
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 4, "body": body})
    return grow_body(spec).tree


def middle_of_hip(tree):
    (found,) = (site.pos_m for site in keypoint_sites(tree)["hip"] if site.name == PREFIX + "MidHip")
    return found


def test_joints_are_at_the_origin_of_their_body(infants):
    origins = {"Shoulder": "upper_arm", "Elbow": "lower_arm", "Wrist": "hand", "Hip": "upper_leg", "Knee": "lower_leg"}
    for infant in infants[::12]:
        points = keypoints(infant)
        for letter, side in (("L", "left"), ("R", "right")):
            for name, body in {**origins, "Eye": "eye"}.items():
                assert np.array_equal(points[letter + name], infant.data.body(f"{side}_{body}").xpos)
            assert points["MidHip"] == pytest.approx((points["LHip"] + points["RHip"]) / 2, abs=1e-6)
            assert points[f"{letter}Ankle"] == pytest.approx(infant.data.joint(f"robot:{side}_foot3").xanchor, abs=1e-9)


PLACES = {
    "Nose": "head", "Neck": "head", "MidHip": "hip", "{}Ear": "head", "{}Eye": "{}_eye", "{}Shoulder": "{}_upper_arm",
    "{}Elbow": "{}_lower_arm", "{}Wrist": "{}_hand", "{}Hip": "{}_upper_leg", "{}Knee": "{}_lower_leg",
    "{}Ankle": "{}_lower_leg", "{}Heel": "{}_foot", "{}BigToe": "{}_foot", "{}SmallToe": "{}_foot",
}  # fmt: skip


def test_they_are_on_the_body_at_every_age(infants):
    """Joints inside of it; nose and ears within a centimetre of the skin; ankles near the foot."""
    for infant in infants[::4]:
        points = keypoints(infant)
        for name, body in PLACES.items():
            for letter, side in (("L", "left"), ("R", "right")):
                gap_m = outside_m(infant, body.format(side), points[name.format(letter)])
                assert gap_m < NEAR_M, (name, infant)
                assert name not in ("Nose", "{}Ear") or abs(gap_m) < NEAR_M, (name, infant)
                assert name != "{}Ankle" or outside_m(infant, f"{side}_foot", points[f"{letter}Ankle"]) < NEAR_M


def test_left_mirrors_right_and_points_stand_in_order_from_head_to_heel(infants):
    """Toes are before the heel, the big one on the inside."""
    downwards = ("LEye", "Nose", "Neck", "LShoulder", "MidHip", "LKnee", "LAnkle", "LHeel")
    for infant in infants[::8]:
        points = keypoints(infant)
        for name in (name for name in KEYPOINTS if name.startswith("L")):
            assert points[name] == pytest.approx(points["R" + name[1:]] * MIRROR, abs=1e-9), (name, infant)
        heights = [points[name][2] for name in downwards]
        assert heights == sorted(heights, reverse=True), infant
        assert points["LBigToe"][0] > points["LHeel"][0] + 0.04
        assert points["LSmallToe"][1] > points["LBigToe"][1] > 0 > points["RBigToe"][1] > points["RSmallToe"][1]


# The function that gives them as an array.


def env_of(**body) -> mimoc.InfantEnv:
    return mimoc.InfantEnv(
        mimoc.build(mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9, "body": body}))
    )


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_they_are_an_array_in_that_order(hands):
    env = env_of(hands=hands)
    env.reset(seed=0)
    points = env.keypoints()
    assert points.shape == (25, 3)
    for name, point in zip(KEYPOINTS, points, strict=True):
        assert np.array_equal(point, env.data.site(PREFIX + name).xpos)


def test_they_move_with_the_infant_and_are_fresh_each_time():
    env = env_of()
    env.reset(seed=0)
    before = env.keypoints()
    kept = before.copy()
    for _ in range(20):
        env.step(env.action_space.high)
    assert np.array_equal(before, kept)
    assert np.all(np.linalg.norm(env.keypoints() - before, axis=1) > 0)


def test_those_of_absent_limbs_are_nan():
    env = env_of(remove=["left_lower_arm", "right_foot", "left_eye"])
    env.reset(seed=0)
    gone = {"LElbow", "LWrist", "LEye", "RAnkle", "RHeel", "RBigToe", "RSmallToe"}
    for name, point in zip(KEYPOINTS, env.keypoints(), strict=True):
        assert np.isnan(point).all() if name in gone else np.isfinite(point).all(), name
