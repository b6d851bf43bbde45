"""What is locked or held stays as a reset puts it, and takes no commands."""

from functools import cache

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import mimoc
from mimoc.base.errors import SpecError
from mimoc.schema import InfantSpec
from mimoc.schema.names import PAIRED_GROUPS, STRENGTH_GROUPS

MODELS = ("torque", "muscle", "position")
CREEP_RAD = 0.05
"""How far full random commands to all the rest move a locked joint: constraints are a little soft."""
SHIFT_M, TURN = 0.005, 0.05
"""How far they move what is held, and turn it, in rad."""
SINGLE = sorted(set(STRENGTH_GROUPS) - set(PAIRED_GROUPS))


def flail(env: mimoc.InfantEnv, steps: int = 100, seed: int = 0) -> None:
    generator, space = np.random.default_rng(seed), env.action_space
    for _ in range(steps):
        env.step(generator.uniform(space.low, space.high).astype(np.float32))


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("pose", ["supine", "prone", "sitting", "standing"])
def test_locked_joints_stay_at_the_angles_of_the_pose(open_env, model, pose):
    env = open_env(actuation={"model": model, "locked": ["legs", "neck"]}, scene={"kind": "flat", "pose": pose})
    env.reset(seed=0)
    locked = [lock.joint for lock in env.manifest.constraints.locks]
    at = [env.model.joint(joint).qposadr[0] for joint in locked]
    before = env.data.qpos[at].copy()
    flail(env)
    assert {joint for joint in locked if "hip1" in joint} == {"robot:left_hip1", "robot:right_hip1"}
    assert np.abs(env.data.qpos[at] - before).max() < CREEP_RAD


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
@pytest.mark.parametrize("pose", ["supine", "sitting", "standing"])
def test_what_is_held_stays_where_the_pose_has_it(open_env, hands, pose):
    scene = {"kind": "flat", "pose": pose, "held": ["chest", "right_foot"]}
    env = open_env(body={"hands": hands}, scene=scene)
    env.reset(seed=0)
    held = [env.model.body(name).id for name in ("chest", "right_foot")]
    before, turned = env.data.xpos[held].copy(), env.data.xmat[held].copy()
    flail(env)
    assert np.abs(env.data.xpos[held] - before).max() < SHIFT_M
    assert np.abs(env.data.xmat[held] - turned).max() < TURN


def test_the_model_alone_holds_the_spec_pose(built):
    """Opened by MuJoCo without mimoc, constraints are those of the pose that the bundle starts from."""
    bundle = built(
        actuation={"locked": ["arms"]}, scene={"kind": "room", "pose": "sitting", "seed": 3, "held": ["hip"]}
    )
    text, assets = bundle.files["scene.xml"].decode(), dict(bundle.files)
    model = mujoco.MjModel.from_xml_string(text, assets=assets)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("sitting").id)
    mujoco.mj_forward(model, data)
    is_equality = data.efc_type[: data.nefc] == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    assert is_equality.sum() == len(bundle.manifest.constraints.locks) + 6
    assert np.abs(data.efc_pos[: data.nefc][is_equality]).max() < 1e-7


def test_a_state_brings_along_what_is_held(open_env):
    keys = {"actuation": {"locked": ["legs"]}, "scene": {"kind": "flat", "held": ["chest"]}}
    env, other = open_env(**keys), open_env(**keys)
    env.reset(seed=0)
    flail(env, 10)
    state = env.get_state()
    other.reset(seed=1)
    other.set_state(state)
    flail(env, 10, seed=2)
    flail(other, 10, seed=2)
    assert np.array_equal(env.data.qpos, other.data.qpos)


@cache
def joints_of_actuators() -> set[str]:
    """Return the joints that have actuators where the spec says nothing of them."""
    spec = InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9})
    return {entry.joint for entry in mimoc.build(spec).manifest.actuation.actuators}


@given(regions=st.sets(st.sampled_from(STRENGTH_GROUPS)), locked=st.sets(st.sampled_from(SINGLE)))
@settings(max_examples=6)
def test_commands_go_to_the_regions_that_are_not_locked(regions, locked):
    data = {"mimoc": 1, "name": "x", "age_months": 9, "actuation": {"regions": sorted(regions)}}
    free = InfantSpec.model_validate(data)
    entries = mimoc.build(free).manifest.actuation.actuators
    everything = joints_of_actuators()
    assert {entry.joint for entry in entries} == everything
    commanded = {entry.joint for entry in entries if entry.commanded}
    of_arms = {joint for joint in everything if "shoulder" in joint or "elbow" in joint}
    assert (of_arms <= commanded) == ("arms" in regions or {"left_arm", "right_arm"} <= regions)
    data["actuation"] = {"locked": sorted(locked)}
    manifest = mimoc.build(InfantSpec.model_validate(data)).manifest
    kept = {lock.joint for lock in manifest.constraints.locks}
    assert {entry.joint for entry in manifest.actuation.actuators if not entry.commanded} == kept & everything


@pytest.mark.parametrize("model", MODELS)
def test_what_takes_no_commands_rests(open_env, model):
    """It behaves as in an infant of which all is commanded, but told to rest."""
    whole, part = (
        open_env(actuation={"model": model, "regions": regions}, scene={"kind": "flat"})
        for regions in (list(STRENGTH_GROUPS), ["right_arm"])
    )
    at = [entry.name for entry in whole.manifest.actuation.actuators]
    named = [entry.name for entry in part.manifest.actuation.actuators if entry.commanded]
    assert part.action_space.shape == (len(named),) < whole.action_space.shape
    for env in (whole, part):
        env.reset(seed=0)
    at_rest = whole.data.ctrl.copy().astype(np.float32)
    generator = np.random.default_rng(0)
    for _ in range(20):
        command = generator.uniform(0, 1, len(named)).astype(np.float32)
        full = at_rest.copy()
        full[[at.index(name) for name in named]] = command
        whole.step(full)
        part.step(command)
    assert part.data.qpos == pytest.approx(whole.data.qpos, abs=1e-6)


def test_an_infant_that_takes_no_commands_at_all_runs(open_env):
    env = open_env(actuation={"regions": []})
    env.reset(seed=0)
    observation, reward, *_ = env.step(np.zeros(0, np.float32))
    assert observation in env.observation_space
    assert (reward, env.effort()) == (0.0, 0.0)


def test_strength_is_that_of_the_body_whatever_takes_commands(built):
    assert mimoc.torque_limits(built(actuation={"regions": ["eyes"]})) == mimoc.torque_limits(built())


@pytest.mark.full
def test_a_part_that_is_not_there_cannot_be_held(built):
    with pytest.raises(SpecError, match=r"scene\.held: this infant has no 'left_hand' to hold; remove it"):
        built(body={"remove": ["left_lower_arm"]}, scene={"held": ["left_hand"]})


def skin_of(bundle: mimoc.Bundle) -> dict[str, np.ndarray]:
    """Return the skin points by body."""
    parts = bundle.manifest.senses.touch.skin
    points_m = np.split(bundle.arrays["touch/points_m"], np.cumsum([part.points for part in parts])[:-1])
    return dict(zip([part.body for part in parts], points_m, strict=True))


def test_skin_is_where_it_is_wanted(built):
    whole, hands = (skin_of(built(senses={"touch": touch})) for touch in ({}, {"regions": ["hands", "neck"]}))
    assert set(hands) == {"left_hand", "left_fingers", "right_hand", "right_fingers", "head"}
    assert all(np.array_equal(hands[body], whole[body]) for body in hands)


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
