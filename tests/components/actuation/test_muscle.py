"""Muscles on the compiled model: as strong as torque motors, and stiff together."""

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.bundle.model import load_model
from mimoc.components.actuation.muscle import MATURING

AGES_MONTHS = (0, 0.5, 1.5, 3, 6, 9, 12, 15, 18, 21, 24)
HANDS = ("mitten", "five_finger")
NEGATIVE, POSITIVE = 0, 1
FORCE, VMAX = 2, 6
PUBLISHED = {"mimoc": 1, "name": "x", "age_months": 18, "development": "published"}


def limits_nm(model):
    """Return the limits of torque motors, shape (n, 2)."""
    return model.actuator_gear[:, :1] * model.actuator_forcerange


def at(model, share):
    """Return a state with every hinge at a share of its range, and the muscles' joints as degrees of freedom."""
    data = mujoco.MjData(model)
    low, high = model.jnt_range[1:].T
    data.qpos[7:] = low + share * (high - low)
    return data, model.jnt_dofadr[model.actuator_trnid[::2, 0]]


def isometric_nm(model, share, active):
    """Return the torque about each joint with the muscles of one direction fully active, shape (n,)."""
    data, hinges = at(model, share)
    data.act[active::2] = 1
    mujoco.mj_forward(model, data)
    return data.qfrc_actuator[hinges]


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", full_but([0, 18], AGES_MONTHS))
def test_muscles_are_as_strong_as_motors(driven, age_months, hands):
    """Within a tenth, each way: where both are equally long (mid-range) and where each pulls hardest."""
    muscles, limits = driven("muscle", age_months, hands), limits_nm(driven("torque", age_months, hands))
    assert isometric_nm(muscles, 0.5, NEGATIVE) == pytest.approx(limits[:, 0], rel=0.02)
    assert isometric_nm(muscles, 0.5, POSITIVE) == pytest.approx(limits[:, 1], rel=0.02)
    at_its_best = (1 - MATURING.shortest) / MATURING.width
    assert isometric_nm(muscles, at_its_best, NEGATIVE) == pytest.approx(MATURING.peak * limits[:, 0], rel=1e-6)
    assert isometric_nm(muscles, 1 - at_its_best, POSITIVE) == pytest.approx(MATURING.peak * limits[:, 1], rel=1e-6)


@pytest.mark.parametrize("hands", HANDS)
def test_forces_grow_as_gears_do_and_speeds_as_joints_reach_less_far(driven, hands):
    grown, born = driven("muscle", 18, hands), driven("muscle", 0, hands)
    motors_grown, motors_born = driven("torque", 18, hands), driven("torque", 0, hands)
    growth = np.repeat(motors_grown.actuator_gear[:, 0] / motors_born.actuator_gear[:, 0], 2)
    assert grown.actuator_gainprm[:, 2] / born.actuator_gainprm[:, 2] == pytest.approx(growth, rel=1e-7)
    same = np.delete(np.arange(grown.actuator_gainprm.shape[1]), (FORCE, VMAX))
    assert np.array_equal(grown.actuator_gainprm[:, same], born.actuator_gainprm[:, same])
    for model in (grown, born):
        low, high = model.actuator_lengthrange.T
        assert (model.actuator_gainprm[:, VMAX] * (high - low) / 0.2 >= 35 * (1 - 1e-6)).all()
    assert np.array_equal(grown.actuator_gainprm, grown.actuator_biasprm)


@pytest.mark.parametrize("hands", HANDS)
def test_the_fastest_a_published_muscle_shortens_is_mimos(driven, reference, hands):
    """But for the left toes, which MIMo lists the other way round than it has counted them; ours mirror the right."""
    keys = {"actuation": {"model": "muscle"}, "body": {"hands": hands, "chest_joint": hands == "five_finger"}}
    model = load_model(mimoc.build(mimoc.InfantSpec.model_validate({**PUBLISHED, **keys})))
    for row in reference("actuators", hands, hands == "five_finger"):
        speeds = {model.actuator(f"{row['name']}_{way}").gainprm[6] for way in ("negative", "positive")}
        if hands == "mitten" or row["name"] not in ("act:left_toes", "act:left_big_toe"):
            assert speeds == {float(row["vmax"])}, row["name"]


def test_lengths_run_from_end_to_end_and_mirror_each_other(driven):
    """By MuJoCo's own normalisation: .85 to 1.05 over the joint's range."""
    shortest, longest = 0.85, 1.05
    model = driven("muscle", 9, "five_finger")
    for share in (0.0, 0.3, 1.0):
        data, _ = at(model, share)
        mujoco.mj_forward(model, data)
        low, high = model.actuator_lengthrange.T
        lengths = shortest + (longest - shortest) * (data.actuator_length - low) / (high - low)
        assert lengths[::2] == pytest.approx(shortest + share * (longest - shortest))
        assert lengths[::2] + lengths[1::2] == pytest.approx(shortest + longest)


@pytest.mark.parametrize(("law", "best", "share"), [("maturing", 3 / 4, 0.82), ("published", 5 / 6, 0.5)])
def test_a_shortened_muscle_pulls_less_hard(law, best, share):
    keys = {**PUBLISHED, "development": law, "actuation": {"model": "muscle"}}
    model = load_model(mimoc.build(mimoc.InfantSpec.model_validate(keys)))
    longest, shortest = isometric_nm(model, best, NEGATIVE), isometric_nm(model, 0.0, NEGATIVE)
    assert (shortest - at_rest_nm(model, 0.0)) / longest == pytest.approx(share)


def at_rest_nm(model, share):
    data, hinges = at(model, share)
    mujoco.mj_forward(model, data)
    return data.qfrc_actuator[hinges]


def test_muscles_at_rest_only_resist_being_stretched(driven):
    """By less than a fiftieth of their strength, near the ends of the range."""
    model = driven("muscle", 9, "five_finger")
    strength = model.actuator_gainprm[::2, 2]
    assert not at_rest_nm(model, 0.5).any()
    assert (at_rest_nm(model, 1.0) < 0).all()
    assert (np.abs(at_rest_nm(model, 1.0)) < strength / 50).all()


def test_a_slack_joint_is_the_same_with_muscles_and_tone_is_a_spring(driven):
    for age_months, has_tone in ((0, True), (24, False)):
        limp, plain = driven("muscle", age_months, "mitten"), driven("torque", age_months, "mitten")
        assert np.array_equal(limp.dof_damping, plain.dof_damping)
        more = limp.jnt_stiffness > plain.jnt_stiffness
        assert more.any() == has_tone
        assert np.array_equal(limp.jnt_stiffness[~more], plain.jnt_stiffness[~more])


def test_published_muscles_replace_the_springs_and_most_of_the_dampers():
    limp, plain = (
        load_model(mimoc.build(mimoc.InfantSpec.model_validate({**PUBLISHED, "actuation": {"model": model}})))
        for model in ("muscle", "torque")
    )
    assert not limp.jnt_stiffness.any()
    assert limp.dof_damping == pytest.approx(plain.dof_damping / 20, rel=1e-8)


def forearm(driven, level):
    """Return an elbow without gravity at mid-range, its muscles pulling equally at *level* of the weaker one."""
    model = driven("muscle", 9, "mitten")
    data, _ = at(model, 0.5)
    flexor, extensor = (model.actuator(f"act:left_elbow_{way}") for way in ("negative", "positive"))
    weaker = min(flexor.gainprm[2], extensor.gainprm[2])
    for muscle in (flexor, extensor):
        data.act[muscle.actadr[0]] = level * weaker / muscle.gainprm[2]
    return model, data, model.joint("robot:left_elbow")


@pytest.mark.parametrize("level", [0.25, 0.5, 1.0])
def test_co_contraction_does_not_move_a_joint(driven, level):
    model, data, elbow = forearm(driven, level)
    mujoco.mj_forward(model, data)
    assert data.qfrc_actuator[elbow.dofadr[0]] == pytest.approx(0, abs=1e-9)


def stiffness_and_damping(driven, level):
    """Return the restoring torque of the elbow's muscles by angle and by speed, from small displacements."""
    model, data, elbow = forearm(driven, level)
    dof, angle, small = elbow.dofadr[0], elbow.qposadr[0], 1e-3
    data.qpos[angle] += small
    mujoco.mj_forward(model, data)
    by_angle = -data.qfrc_actuator[dof] / small
    data.qpos[angle] -= small
    data.qvel[dof] = small
    mujoco.mj_forward(model, data)
    return by_angle, -data.qfrc_actuator[dof] / small


def test_co_contraction_stiffens_a_joint(driven):
    """In proportion to the activation: what pushes it away is met by more torque, and more of its speed is lost."""
    limp, half, full = (stiffness_and_damping(driven, level) for level in (0.0, 0.5, 1.0))
    assert limp == pytest.approx((0, 0), abs=1e-9)
    assert min(half) > 0
    assert full == pytest.approx((2 * half[0], 2 * half[1]), rel=1e-3)


MUSCLE = {"model": "muscle"}


@pytest.fixture(params=["mitten", "five_finger"])
def env(request, open_env):
    env = open_env(actuation=MUSCLE, body={"hands": request.param}, scene={"kind": "flat", "pose": "sitting"})
    env.reset(seed=0)
    return env


def test_the_manifest_says_which_two_muscles_stand_for_each_of_mimos_actuators(env, open_env):
    plain = open_env(body={"hands": "mitten" if env.model.nu == 88 else "five_finger"})
    muscles = env.manifest.actuation.actuators
    mimos = [(actuator.name, actuator.joint) for actuator in plain.manifest.actuation.actuators]
    assert [(muscle.mimo_actuator, muscle.joint) for muscle in muscles] == [pair for pair in mimos for _ in range(2)]
    assert [muscle.name for muscle in muscles] == [
        f"{name}_{way}" for name, _ in mimos for way in ("negative", "positive")
    ]


def test_readings_stay_within_their_bounds_without_being_clipped(env):
    bounds = env.observation_space["proprioception"].high[-2 * env.model.nu :]
    for _ in range(100):
        observation, *_ = env.step(env.np_random.choice([0.0, 1.0], env.model.nu))
        felt = np.abs(observation["proprioception"][-2 * env.model.nu :])
        assert (felt[env.model.nu :] < 0.9 * bounds[env.model.nu :]).all()
        assert (felt <= bounds).all()


def test_effort_is_the_mean_square_activation_weighted_by_strength(env):
    assert env.effort() == 0
    for _ in range(100):
        env.step(np.full(env.model.nu, 0.5))
    assert env.effort() == pytest.approx(0.25 / env.model.nu, rel=1e-6)
    limits = np.abs(list(mimoc.torque_limits(env.bundle).values())).ravel()
    activation = env.np_random.uniform(0, 1, env.model.nu)
    for _ in range(100):
        env.step(activation)
    assert env.effort() == pytest.approx(activation**2 @ limits / (env.model.nu * limits.sum()), rel=1e-4)


def test_a_limp_infant_stays_limp(env):
    """No muscle pulls by itself, so nothing moves an infant that lies on its back but its weight."""
    env.reset(options={"pose": "supine"})
    for _ in range(50):
        _, _, terminated, _, _ = env.step(np.zeros(env.model.nu))
    assert not terminated
    assert not env.data.act.any()
    assert np.abs(env.data.actuator_force).max() < 0.02 * env.model.actuator_gainprm[:, 2].max()


def test_a_co_contracted_elbow_resists_a_push(open_env):
    """Muscles that pull alike hold it where it is, and a push moves it less than half as far as a limp one."""
    env = open_env(actuation=MUSCLE, scene={"kind": "empty"})
    elbow = env.model.joint("robot:left_elbow")
    pair = [env.model.actuator(f"act:left_elbow_{way}").id for way in ("negative", "positive")]
    strength = env.model.actuator_gainprm[pair, 2]

    def moved_rad(activation, push_nm):
        env.reset()
        env.data.qpos[elbow.qposadr[0]] = elbow.range.mean()
        env.data.qfrc_applied[elbow.dofadr[0]] = push_nm
        command = np.zeros(env.model.nu)
        command[pair] = env.data.act[pair] = activation * strength.min() / strength
        for _ in range(10):
            env.step(command)
        return abs(float(env.data.qpos[elbow.qposadr[0]] - elbow.range.mean()))

    assert moved_rad(0.8, 0.0) < 0.02
    assert moved_rad(0.8, 0.3) < 0.5 * moved_rad(0.0, 0.3)
