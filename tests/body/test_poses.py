"""The poses an infant starts in, on the compiled model and from the written files."""

import math

import mujoco
import numpy as np
import pytest
from support.start_poses import DEPTH_M

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.body.poses import CONTACT_DEPTH_M, POSES, poses_of
from mimoc.compiler.assembling import keyframes
from mimoc.fits import measure
from mimoc.schema.scene import SceneSpec

AGES_MONTHS = (0, 1, 6, 12, 18, 24)
PER_AGE_AND_POSE = [(age, pose) for age in AGES_MONTHS for pose in POSES]
WITH_FIVE_FINGERS = [(age, pose, "five_finger") for age in (0, 12, 24) for pose in POSES]
BOTH_HANDS = [(age, pose, "mitten") for age, pose in PER_AGE_AND_POSE] + WITH_FIVE_FINGERS
AGES_AND_HANDS = sorted({(age, hands) for age, _, hands in BOTH_HANDS})
STATUE_ARMATURE_KGM2 = 1e6


def start(model: mujoco.MjModel, pose: str) -> mujoco.MjData:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    return data


def up_of_hip(data: mujoco.MjData) -> np.ndarray:
    return data.body("hip").xmat.reshape(3, 3)[2].copy()


def test_there_is_a_keyframe_for_every_pose_of_the_language(infant_at):
    model = infant_at(9).model
    named = set(SceneSpec.model_fields["pose"].annotation.__args__)
    assert [model.key(index).name for index in range(model.nkey)] == list(POSES)
    assert named == POSES.keys()


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
@pytest.mark.parametrize("chest_joint", [False, True])
def test_poses_name_joints_that_exist(hands, chest_joint):
    tree = grow_tree(measure(9), assemble(hands, chest_joint))
    for pose in POSES:
        for name in poses_of(tree)[pose].angles_deg:
            assert {f"robot:{name.format(side=side)}" for side in ("left", "right")} <= tree.joints.keys()


@pytest.mark.parametrize("pose", POSES)
def test_the_floor_is_touched_by_a_hair_and_hands_sink_into_nothing(infants, pose):
    """Hands that lie on the body press into it a little; so do fingers of a fist."""
    for infant in infants:
        data = start(infant.model, pose)
        of_floor = data.contact.geom[:, 0] == infant.model.geom("floor").id
        assert data.contact.dist[of_floor].min() == pytest.approx(-CONTACT_DEPTH_M, abs=1e-8), infant
        assert data.contact.dist.min() > -DEPTH_M, infant


@pytest.mark.parametrize("pose", POSES)
def test_angles_are_within_the_range_of_every_joint(infant_at, pose):
    model = infant_at(9).model
    angles = model.key(pose).qpos[7:]
    assert np.all(model.jnt_range[1:, 0] <= angles)
    assert np.all(angles <= model.jnt_range[1:, 1])


@pytest.mark.parametrize("pose", POSES)
def test_couplings_of_the_spine_and_limits_of_the_head_hold(infant_at, pose):
    model = infant_at(9).model
    data = start(model, pose)
    assert np.all(model.tendon_range[:, 0] <= data.ten_length)
    assert np.all(data.ten_length <= model.tendon_range[:, 1])


@pytest.mark.parametrize(("age_months", "pose", "hands"), BOTH_HANDS)
def test_a_statue_in_this_pose_does_not_tip(bundle_at, age_months, pose, hands):
    """With joints too inert to move, half a second of gravity turns and shifts it by less than one sees.

    Its joints have no limits: those push from two degrees before their ends, where hips begin that do not straighten.
    On its belly it rolls a little onto its cheek, which is beside its middle.
    """
    files = bundle_at(age_months, hands, hands == "five_finger").files
    model = mujoco.MjModel.from_xml_string(files["scene.xml"].decode(), dict(files))
    model.dof_armature[6:] = STATUE_ARMATURE_KGM2
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    data = start(model, pose)
    before = up_of_hip(data), data.qpos.copy()
    mujoco.mj_step(model, data, nstep=100)
    assert math.degrees(math.acos(min(1.0, before[0] @ up_of_hip(data)))) < (0.25 if pose == "prone" else 0.2)
    assert data.qpos[:3] == pytest.approx(before[1][:3], abs=1e-3)
    assert data.qpos[7:] == pytest.approx(before[1][7:], abs=1e-5)


@pytest.mark.parametrize("age_months", AGES_MONTHS)
def test_the_body_lies_and_stands_as_the_pose_says(infant_at, age_months):
    model = infant_at(age_months).model
    forward = {pose: start(model, pose).body("hip").xmat.reshape(3, 3)[2, 0] for pose in POSES}
    head_m = {pose: start(model, pose).body("head").xpos[2] for pose in POSES}
    assert forward["supine"] > 0.9
    assert forward["prone"] < -0.9
    assert abs(forward["standing"]) < 0.1
    assert head_m["standing"] > 1.5 * head_m["sitting"] > 3 * max(head_m["supine"], head_m["prone"])


def test_left_and_right_are_posed_alike():
    tree = grow_tree(measure(9), assemble("mitten", False))
    for keyframe in keyframes(tree):
        angles = dict(zip(tree.joints, keyframe.qpos[7:], strict=True))
        assert all(angles[name] == angles[name.replace("left", "right")] for name in angles)
        assert (angles["robot:head_swivel"] != 0) == (keyframe.name == "prone")


@pytest.fixture(scope="module")
def folders(bundle_at, tmp_path_factory):
    """Return a bundle's folder for each age and hands; the five-finger body with its chest joint."""
    root = tmp_path_factory.mktemp("bundles")
    return {
        (age, hands): mimoc.write_bundle(bundle_at(age, hands, hands == "five_finger"), root / f"age{age}_{hands}")
        for age, hands in AGES_AND_HANDS
    }


@pytest.mark.parametrize(("age_months", "pose", "hands"), BOTH_HANDS)
def test_a_second_of_random_control_leaves_no_warning_and_bounded_energy(
    folders, age_months, pose, hands, tmp_path, monkeypatch
):
    """In plain MuJoCo, from the written files; a fall from standing makes some 4 J/kg."""
    monkeypatch.chdir(tmp_path)
    model = mujoco.MjModel.from_xml_path(str(folders[age_months, hands] / "scene.xml"))
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data, chance, kinetic_j = start(model, pose), np.random.default_rng(0), 0.0
    while data.time < 1:
        data.ctrl = chance.uniform(-1, 1, model.nu)
        mujoco.mj_step(model, data)
        kinetic_j = max(kinetic_j, data.energy[1])
    assert kinetic_j < 6 * model.body("hip").subtreemass[0]
    assert not any(warning.number for warning in data.warning)
    assert not (tmp_path / "MUJOCO_LOG.TXT").exists()


@pytest.mark.parametrize(("age_months", "hands"), AGES_AND_HANDS)
def test_the_infant_alone_loads_and_steps(folders, age_months, hands, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    model = mujoco.MjModel.from_xml_path(str(folders[age_months, hands] / "infant.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=200)
    assert not any(warning.number for warning in data.warning)
    assert np.all(np.isfinite(data.qpos))
    assert not (tmp_path / "MUJOCO_LOG.TXT").exists()
