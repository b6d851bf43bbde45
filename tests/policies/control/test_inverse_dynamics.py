"""What inverse dynamics keeps to in every state, and how well it reaches."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.full import full_but, full_rows

import mimoc
from mimoc.base.errors import ControlError, UnknownNameError
from mimoc.policies.control.dynamics import dynamics
from mimoc.policies.control.inverse_dynamics import InverseDynamics
from mimoc.policies.control.objectives import GazeTask, OrientationTask, PositionTask, Posture
from mimoc.policies.reach import ReachGains, reach_errors
from mimoc.runtime.worlds import worlds_of_one

ARM = [
    *(f"robot:right_shoulder_{name}" for name in ("horizontal", "ad_ab", "rotation")),
    *("robot:right_elbow", "robot:right_hand1", "robot:right_hand2", "robot:right_hand3"),
]
HAND, FOOT = "right_hand", "BODY_25:LHeel"
EYES = ("eye_left", "eye_right")


def control_of(env, objectives, joints=None):
    """Return the controller of an environment's infant."""
    infant = env.unwrapped
    return InverseDynamics(infant.model, infant.data, infant.manifest, objectives, joints)


def accelerations(env, objectives, site=HAND):
    """Return what a site would do with and without the action that a controller gives, shape (3,) each, [m/s²].

    The motors must be without activations.
    """
    data, found = mujoco.MjData(env.model), []
    body = env.model.body(site).id
    jacobian, change = np.zeros((3, env.model.nv)), np.zeros((3, env.model.nv))
    for action in (control_of(env, objectives)(), np.zeros(env.model.nu)):
        data.qpos[:], data.qvel[:], data.ctrl[:] = env.data.qpos, env.data.qvel, action
        mujoco.mj_forward(env.model, data)
        mujoco.mj_jac(env.model, data, jacobian, None, data.xipos[body], body)
        mujoco.mj_jacDot(env.model, data, change, None, data.xipos[body], body)
        found.append(jacobian @ data.qacc + change @ data.qvel)
    return found


def disturb(env, seed):
    """Give an infant another posture and some motion."""
    env.reset(seed=0)
    generator = np.random.default_rng(seed)
    first = env.model.joint(ARM[0]).id  # The spine, whose joints are coupled, stays straight.
    low, high = env.model.jnt_range[first:].T
    env.data.qpos[first + 6 :] = generator.uniform(low + 0.3 * (high - low), high - 0.3 * (high - low))
    env.data.qvel[first + 5 :] = generator.normal(scale=0.1, size=env.model.njnt - first)
    mujoco.mj_forward(env.model, env.data)


def near(env, site=HAND, by_m=(0.01, 0.0, 0.01)):
    return env.data.body(site).xipos + by_m


def test_the_acceleration_that_is_wanted_comes_about(floating):
    """A floating infant: MuJoCo does with the action what the controller said it would."""
    for seed in range(5):
        disturb(floating, seed)
        objective = PositionTask(HAND, near(floating))
        control = control_of(floating, [objective])
        control()
        wanted = objective.desired_acceleration(control._motion(objective)).accelerations
        got, without = accelerations(floating, [objective])
        assert got == pytest.approx(wanted, abs=0.02 * np.linalg.norm(wanted - without))


def test_a_lower_objective_never_disturbs_a_higher_one(floating):
    """Actions are float32, so what is compared is in shares of torque, before they are rounded."""
    for seed in range(10):
        disturb(floating, seed)
        first = PositionTask(HAND, near(floating))
        lower = (
            [GazeTask(eye, (1, 0, 1)) for eye in EYES],
            PositionTask("left_foot", near(floating, "left_foot", (0, 0, 0.05))),
        )
        alone, together = control_of(floating, [first]), control_of(floating, [first, *lower])
        found = []
        for control in (alone, together):
            control()
            supports = control._supports.jacobian(control._data)
            now = dynamics(control._plant.model, control._data, control._joints.dofs, supports)
            found.append(control._wanted(now)[first].response @ control._shares(now))
        assert np.abs(found[0] - found[1]).max() < 1e-9


def test_joints_that_may_not_move_rest(held_infant):
    for model in ("torque", "muscle"):
        env = held_infant(model=model)
        env.reset(seed=0)
        control = control_of(env, [PositionTask(HAND, near(env, by_m=(0.05, 0, 0.1)))], joints=ARM)
        moved = np.isin([actuator.joint for actuator in env.manifest.actuation.actuators], ARM)
        for _ in range(30):
            action = control()
            assert not action[~moved].any()
            assert action[moved].any()
            env.step(action)


@pytest.mark.parametrize("development", ["maturing", "published"])
def test_no_torque_is_beyond_the_limits(held_infant, development):
    """Nor any activation, which would take its time to come back from there."""
    env = held_infant(development=development)
    env.reset(seed=0)
    limits = env.actuation.limits_nm / env.model.actuator_gear[env.actuation.actuators, :1]
    control = control_of(env, [PositionTask(HAND, (3, -3, 1))])
    reached = np.zeros(len(limits), bool)
    for _ in range(50):
        action = control()
        assert env.action_space.contains(action)
        env.step(action)
        shares = env.actuation.drive(worlds_of_one(env.data))[0]
        assert (shares >= limits[:, 0] - 1e-6).all()
        assert (shares <= limits[:, 1] + 1e-6).all()
        reached |= np.isclose(shares, limits[:, 0]) | np.isclose(shares, limits[:, 1])
    assert reached.any()


@pytest.mark.parametrize("model", ["torque", "muscle"])
@pytest.mark.parametrize("target", full_but([(-3, 0, 0.3), (0, -3, -3)], [(3, 0, 0.3), (0, -3, 0.3), (0, 0, 3)]))
def test_a_target_that_is_out_of_reach_leaves_everything_bounded(held_infant, model, target):
    """The arm is straight then, and no torque brings the hand nearer."""
    env = held_infant(model=model)
    env.reset(seed=0)
    start_m = near(env, by_m=(0, 0, 0))
    control = control_of(env, [PositionTask(HAND, target), [GazeTask(eye, target) for eye in EYES]])
    for _ in range(200):
        action = control()
        assert np.isfinite(action).all()
        assert env.action_space.contains(action)
        *_, info = env.step(action)
        assert not info["unstable"]
        assert np.abs(env.data.qvel).max() < 40
    assert control.errors()[0] < np.linalg.norm(start_m - target)


def test_joints_stop_before_the_ends_of_their_ranges(held_infant):
    env = held_infant()
    env.reset(seed=0)
    control = control_of(env, [PositionTask(HAND, (-1, -1, 0))])
    low, high = np.array([env.model.joint(name).range for name in ARM]).T
    addresses = [env.model.joint(name).qposadr[0] for name in ARM]
    for _ in range(150):
        env.step(control())
        angles = env.data.qpos[addresses]
        assert (angles > low - 0.1).all()
        assert (angles < high + 0.1).all()


@pytest.mark.full
@pytest.mark.parametrize(
    ("age_months", "model"), full_rows([(9, "muscle")], [(9, "torque"), (18, "muscle"), (24, "torque")])
)
def test_hands_reach_while_the_eyes_align(held_infant, age_months, model):
    """Eight trials of both hands, so sixteen reachable targets: millimetres and degrees after a second."""
    errors = reach_errors(held_infant(age_months, model=model), ReachGains(), np.random.default_rng(0), 8, 2.0)
    hands_m, eyes_rad = errors.hands_m[:, 100], errors.eyes_rad[:, 200]
    assert np.median(hands_m) < 0.002
    assert np.quantile(hands_m, 0.9) < 0.01
    assert np.rad2deg(np.median(eyes_rad)) < 1.5


@pytest.mark.parametrize("model", full_but(["torque"], ["muscle"]))
def test_five_finger_hands_reach_as_well(held_infant, model):
    errors = reach_errors(held_infant(9, "five_finger", model), ReachGains(), np.random.default_rng(0), 5, 1.0)
    assert np.median(errors.hands_m[:, -1]) < 0.002
    assert np.quantile(errors.hands_m[:, -1], 0.9) < 0.02


@pytest.mark.full
@settings(max_examples=4)
@given(
    st.one_of(
        st.tuples(st.just("maturing"), st.integers(4, 24)),
        st.tuples(st.just("published"), st.integers(2, 24)),
    ),
    st.integers(0, 1000),
)
def test_hands_reach_from_the_age_of_first_reaches_on(held_infant, law_and_age, seed):
    """By `maturing` within two seconds from 4 months on; by `published` within one, nearly from birth."""
    development, age_months = law_and_age
    env, time_s = held_infant(age_months, development=development), {"maturing": 2.0, "published": 1.0}[development]
    errors = reach_errors(env, ReachGains(), np.random.default_rng(seed), 2, time_s)
    assert np.median(errors.hands_m[:, -1]) < 0.005


@pytest.mark.full
@pytest.mark.parametrize("model", full_but(["muscle"], ["torque"]))
def test_a_newborn_misses_many_targets_that_a_four_month_old_reaches(held_infant, model):
    """Some three of its 16 targets stay more than a centimetre away for two seconds, with muscles a quarter, and hardly
    any of the older one's. Of newborns that sat upright, their hands farther from the targets, it was a third."""
    newborn, older = (
        reach_errors(held_infant(age_months, model=model), ReachGains(), np.random.default_rng(0), 8, 2.0).hands_m
        for age_months in (0, 4)
    )
    assert np.mean(newborn[:, -1] > 0.01) > {"torque": 1 / 6, "muscle": 1 / 5}[model]
    assert np.mean(older[:, -1] > 0.01) < 0.1


def test_a_hand_takes_on_an_orientation(held_infant):
    """That of an arm whose joints have other angles."""
    env = held_infant()
    env.reset(seed=0)
    there = mujoco.MjData(env.model)
    there.qpos[:] = env.data.qpos
    for name, angle_rad in zip(ARM, (0.8, 0.9, -0.3, -1.2, 0.3, 0.4, 0.2), strict=True):
        there.joint(name).qpos = angle_rad
    mujoco.mj_kinematics(env.model, there)
    hand = there.body(HAND)
    control = control_of(env, [[PositionTask(HAND, hand.xipos), OrientationTask(HAND, hand.xquat)]])
    for _ in range(150):
        env.step(control())
    assert control.errors()[0] < 0.005
    assert control.errors()[1] < np.deg2rad(3)


def test_targets_can_be_set_as_it_runs(held_infant):
    env = held_infant()
    env.reset(seed=0)
    reach = PositionTask(HAND, near(env, by_m=(0.03, 0.0, 0.05)))
    control = control_of(env, [reach])
    for by_m in ((0.0, 0.0, 0.05), (0.03, 0.03, 0.05), (0.03, 0.0, 0.1)):
        reach.target = reach.target + by_m
        for _ in range(100):
            env.step(control())
        assert control.errors()[0] < 0.002


def test_posture_holds_joints_where_they_are_wanted(held_infant):
    env = held_infant()
    env.reset(seed=0)
    start_rad = env.data.joint("robot:right_elbow").qpos[0]
    wanted_rad = {"robot:left_shoulder_ad_ab": 0.6, "robot:left_elbow": -1.5}  # Free of the trunk.
    control = control_of(env, [Posture(wanted_rad)])
    for _ in range(200):
        env.step(control())
    for name, angle_rad in wanted_rad.items():
        assert env.data.joint(name).qpos[0] == pytest.approx(angle_rad, abs=0.1)
    assert env.data.joint("robot:right_elbow").qpos[0] == pytest.approx(start_rad, abs=0.05)


def test_the_posture_of_some_joints_can_come_first(held_infant):
    """An elbow that is held does not take part in reaching; motors without activation let it sag the least."""
    env = held_infant(development="published")
    found = []
    for first in ([], [Posture(joints=["robot:right_elbow"])]):
        env.reset(seed=0)
        start_rad = env.data.joint("robot:right_elbow").qpos[0]
        control = control_of(env, [*first, PositionTask(HAND, near(env, by_m=(0.03, -0.02, 0.05)))])
        for _ in range(100):
            env.step(control())
        found.append(abs(env.data.joint("robot:right_elbow").qpos[0] - start_rad))
    assert found[1] < 0.02 < found[0]


def test_the_environment_is_only_looked_at(held_infant):
    env = held_infant()
    env.reset(seed=0)
    before = env.get_state()["physics"]
    control = control_of(env, [PositionTask(HAND, (0.2, 0, 0.2))])
    first, second = control(), control()
    control.errors()
    assert np.array_equal(first, second)
    assert np.array_equal(before, env.get_state()["physics"])


def test_it_follows_the_infant_into_another_scene():
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "scene": {"kind": "room", "pose": "sitting"}}
    env = mimoc.make(mimoc.InfantSpec.model_validate(spec))
    env.reset(seed=0)
    control = control_of(env, [PositionTask(HAND, (0.2, 0, 0.2))])
    control()
    env.reset(options={"scene_seed": 5})
    control.bind(env.unwrapped.model, env.unwrapped.data)
    assert env.action_space.contains(control())


def test_toys_are_no_part_of_the_infant(built):
    scene = {"kind": "flat", "pose": "sitting", "toys": {"subset": ["ball"], "count": [3, 3]}}
    env = mimoc.InfantEnv(built(scene=scene))
    env.reset(seed=0)
    control = control_of(env, [PositionTask(HAND, near(env))])
    control()
    toys = [env.model.body(toy.body).id for toy in env.manifest.toys]
    assert not control._supports._bearing[np.append(np.isin(env.model.geom_bodyid, toys), False)].any()


def test_a_simulation_that_broke_down_is_left_to_rest(held_infant):
    env = held_infant()
    env.reset(seed=0)
    control = control_of(env, [PositionTask(HAND, (0.2, 0, 0.2))])
    env.data.qvel[:] = np.nan
    assert not control().any()


def test_servos_are_refused_with_a_reason(open_env):
    env = open_env(actuation={"model": "position"})
    message = r"'position' does not accept; build .* actuation: {model: torque} or {model: muscle}$"
    with pytest.raises(ControlError, match=message):
        control_of(env, [PositionTask(HAND, (0, 0, 0))])


@pytest.mark.parametrize(
    ("objectives", "joints", "complaint"),
    [
        ([PositionTask("right_hnad", (0, 0, 0))], None, "'right_hnad' is not a site, camera or body"),
        ([GazeTask("left_eyes", (0, 0, 0))], None, "did you mean .*'left_eye'"),
        ([], ["robot:right_elbo"], "did you mean 'robot:right_elbow'"),
        ([], ["robot:hip_bend2"], "'robot:hip_bend2' is not a joint with an actuator"),
        ([Posture({"elbow": 1.0})], None, "'elbow' is not a joint that is allowed to move"),
        ([Posture({"robot:left_elbow": 1.0})], ARM, "'robot:left_elbow' is not a joint that is allowed to move"),
    ],
)
def test_names_that_there_are_not_are_refused(env, objectives, joints, complaint):
    with pytest.raises(UnknownNameError, match=complaint):
        control_of(env, objectives, joints)


def test_nothing_can_come_after_the_posture(env):
    with pytest.raises(ControlError, match="make it the last objective"):
        control_of(env, [Posture(), PositionTask(HAND, (0, 0, 0))])
    with pytest.raises(ControlError, match="shares its priority with nothing"):
        control_of(env, [[Posture(joints=ARM), PositionTask(HAND, (0, 0, 0))]])
