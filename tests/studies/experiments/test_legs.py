"""Weights, ribbons and hands that hold infants."""

from itertools import pairwise

import mujoco
import numpy as np
import pytest

from mimoc.base.units import GRAVITY_M_S2
from mimoc.policies.general_movements import Moving
from mimoc.policies.movement_law import ARM, LIMBS as POLICY_LIMBS
from mimoc.policies.policy import batch_of_one
from mimoc.studies.experiments.contingency import FORGETTING_S, LARGEST, WINDOW_S, Expected, GainLearner
from mimoc.studies.experiments.legs import (
    LIMBS,
    MOBILE_N_M,
    Mover,
    Setup,
    leg_kg,
    legs_of,
    limb_of_actuators,
    mobile_speed_m_s,
    open_infant,
    ribbon_m,
    tie_ribbon,
)
from mimoc.studies.experiments.stepping import (
    DRAG,
    LIMB_KG_M3,
    WATER_KG_M3,
    AlternateSteps,
    StepCase,
    Water,
    broadsides_m2,
    stepping,
    summarise_steps,
)


def still(env):
    return lambda generator, observation: np.zeros(env.action_space.shape, np.float32)


def test_a_weight_adds_its_mass_to_one_leg():
    plain, heavy = (open_infant(Setup(1.0, left_kg=kg)).model for kg in (0.0, 0.1))
    added = heavy.body_mass - plain.body_mass
    assert added.sum() == pytest.approx(0.1)
    assert heavy.body(int(np.argmax(added))).name == "left_lower_leg"


def test_a_weight_hangs_at_the_ankle():
    """So that it turns the shank as a point mass there does."""
    plain, heavy = (open_infant(Setup(1.0, left_kg=kg)).model for kg in (0.0, 0.1))
    shank, foot = plain.body("left_lower_leg").id, plain.body("left_foot").id
    mass_kg, centre_m, ankle_m = plain.body_mass[shank], plain.body_ipos[shank], plain.body_pos[foot]
    assert heavy.body_ipos[shank] == pytest.approx((mass_kg * centre_m + 0.1 * ankle_m) / (mass_kg + 0.1))


def test_legs_gain_mass_with_age():
    assert leg_kg(0.0) < leg_kg(1.0) < leg_kg(6.0)


def test_who_is_held_does_not_sink():
    env = open_infant(Setup(1.0, held=True))
    mover = Mover(env, 0, still)
    height_m = env.data.body("hip").xpos[2]
    mover.move(2.0)
    assert env.data.body("hip").xpos[2] == pytest.approx(height_m, abs=1e-5)


@pytest.fixture
def tied():
    env = open_infant(Setup(3.0, tied="left"))
    mover = Mover(env, 0, still)
    mover.move(1.0)
    return env, mover


def test_a_slack_ribbon_pulls_nothing(tied):
    env, mover = tied
    tie_ribbon(env, ribbon_m(env) + 0.05)
    start = env.data.qpos[env.model.joint("mobile").qposadr[0]]
    mover.move(0.5)
    assert env.data.qpos[env.model.joint("mobile").qposadr[0]] == pytest.approx(start, abs=1e-6)
    assert mobile_speed_m_s(env) == pytest.approx(0, abs=1e-6)


def test_a_straight_ribbon_pulls_the_mobile_up_and_keeps_its_length(tied):
    env, mover = tied
    length_m = ribbon_m(env) - 0.03
    tie_ribbon(env, length_m)
    mover.move(3.0)
    assert ribbon_m(env) == pytest.approx(length_m, abs=0.005)
    assert 0.005 < env.data.qpos[env.model.joint("mobile").qposadr[0]] < 0.04


def test_a_straight_ribbon_pulls_the_ankle_as_much_as_the_mobile(tied):
    """The force is that of the arm on which the mobile hangs: stiffness times way."""
    env, mover = tied
    tie_ribbon(env, ribbon_m(env) - 0.03)
    mover.move(6.0)
    way_m = env.data.qpos[env.model.joint("mobile").qposadr[0]]
    limits = env.data.efc_force[env.data.efc_type == mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON]
    assert limits[-1] == pytest.approx(MOBILE_N_M * way_m, rel=0.05)


def test_each_limb_has_its_actuators():
    env = open_infant(Setup(3.0))
    names = [env.model.actuator(int(index)).name for index in env.actuation.actuators]
    limbs = dict(zip(names, limb_of_actuators(env), strict=True))
    assert LIMBS[limbs["act:left_hip_flex_negative"]] == "left_hip"
    assert LIMBS[limbs["act:right_foot_flexion_positive"]] == "right_knee"
    assert LIMBS[limbs["act:left_wrist_ulnar_negative"]] == "left_arm"
    assert (
        limbs["act:head_tilt_positive"]
        == limbs["act:hip_bend_negative"]
        == limbs["act:left_eye_vertical_negative"]
        == -1
    )


def test_gains_change_the_commands_of_their_part_alone():
    env = open_infant(Setup(3.0))
    asked = []
    step = env.step
    env.step = lambda action: asked.append(action.copy()) or step(action)
    mover = Mover(env, 0, lambda env: lambda generator, observation: np.full(env.action_space.shape, 0.2, np.float32))
    mover.set_gains(np.array([1.0, 1.0, 3.0, 1.0, 1.0, 1.0]))
    mover.move(0.01)
    assert np.unique(asked[0][limb_of_actuators(env) == LIMBS.index("left_hip")]) == pytest.approx([0.6])
    assert np.unique(asked[0][limb_of_actuators(env) != LIMBS.index("left_hip")]) == pytest.approx([0.2])


def test_a_leg_whose_bursts_begin_more_often_is_driven_more():
    env = open_infant(Setup(3.0))
    drives = []
    for gain in (1.0, 3.0):
        env.reset(seed=0)
        moving, generator = Moving(batch_of_one(env)), np.random.default_rng(0)
        moving.movement.rate_gains = np.where(np.array(POLICY_LIMBS) == "left_leg", gain, 1.0)[None]
        actions = np.array([moving([generator], {})[0] for _ in range(3000)])
        hips = [limb_of_actuators(env) == LIMBS.index(f"{side}_hip") for side in ("left", "right")]
        drives.append([np.abs(np.diff(actions[:, hip], axis=0)).mean() for hip in hips])
    (left, right), (more, same) = drives
    assert more > 1.1 * left
    assert same == pytest.approx(right)


def test_movement_is_the_joint_speed_of_each_limb():
    env = open_infant(Setup(3.0))
    mover = Mover(env, 0, still)
    speeds = np.abs([data.qvel.copy() for data in mover.steps(0.1)]).mean(axis=0)
    arm = [env.model.joint(f"robot:left_{name}").dofadr[0] for name in ARM]
    assert mover.take_movement()[LIMBS.index("left_arm")] == pytest.approx(speeds[arm].mean())
    assert mover.take_movement() == pytest.approx(np.zeros(len(LIMBS)))


TIED = LIMBS.index("left_hip")


def learn(seed: int, windows: int, reward) -> GainLearner:
    """Let limbs move by chance, and reward be a function of their movement and of chance."""
    generator, learner = np.random.default_rng(seed), GainLearner()
    for _ in range(windows):
        movement, noise = generator.lognormal(0.0, 0.5, len(LIMBS)), generator.lognormal(0.0, 0.5)
        learner.feel(float(reward(movement, noise)), movement)
    return learner


def by_tied(movement, noise) -> float:
    return movement[TIED] * noise


def test_the_limb_that_moves_the_world_is_driven_more():
    gains = np.array([learn(seed, 150, by_tied).gains for seed in range(20)])
    assert gains[:, TIED].min() > 1.5
    assert np.delete(gains, TIED, axis=1).mean() == pytest.approx(1.0, abs=0.1)


def test_a_limb_that_moves_along_with_it_gains_less():
    """Half of the movement of all limbs is common to them."""
    generator, strengths = np.random.default_rng(0), []
    for _ in range(20):
        learner = GainLearner()
        for _ in range(150):
            movement = generator.lognormal(0.0, 0.5) + generator.lognormal(0.0, 0.5, len(LIMBS))
            learner.feel(by_tied(movement, generator.lognormal(0.0, 0.3)), movement)
        strengths.append(learner.strengths)
    learnt = np.mean(strengths, axis=0)
    assert learnt[TIED] > 3 * np.delete(learnt, TIED).max()


def test_nothing_is_learnt_of_a_world_that_moves_by_itself():
    gains = np.array([learn(seed, 150, lambda movement, noise: noise).gains for seed in range(20)])
    assert gains.mean() == pytest.approx(1.0, abs=0.05)
    assert gains.max() < 2.0


def test_strengths_are_in_proportion_to_those_of_a_regression():
    """Smaller, as what is forgotten goes back to 0."""
    true, learnt = np.array([0.6, 0.0, -0.4, 0.3, 0.0, 0.2]), []
    for seed in range(20):
        generator, learner = np.random.default_rng(seed), GainLearner()
        for _ in range(300):
            movement = generator.normal(size=len(LIMBS))
            learner.feel(float(true @ movement + 10.0 + 0.5 * generator.normal()), movement)
        learnt.append(learner.strengths)
    shown = true / np.sqrt(true @ true + 0.5**2)
    assert np.mean(learnt, axis=0) == pytest.approx(0.77 * shown, abs=0.06)


def test_nothing_is_learnt_without_reward():
    assert learn(0, 100, lambda movement, noise: 0.0).strengths == pytest.approx(np.zeros(len(LIMBS)))


def test_what_was_learnt_is_forgotten():
    learner = learn(0, 150, by_tied)
    before = learner.strengths[TIED]
    for _ in range(round(FORGETTING_S / WINDOW_S)):
        learner.feel(0.0, np.ones(len(LIMBS)))
    assert learner.strengths[TIED] == pytest.approx(before / np.e, rel=0.02)


def test_gains_have_a_limit():
    learner = learn(0, 1, by_tied)
    learner.strengths = np.full(len(LIMBS), 10.0)
    assert learner.gains == pytest.approx(np.full(len(LIMBS), np.exp(LARGEST)))


def test_the_size_of_reward_does_not_matter():
    """Only how it varies around what is expected."""
    one, other = (learn(3, 100, lambda a, noise, size=size: size * by_tied(a, noise)) for size in (1.0, 50.0))
    assert one.strengths == pytest.approx(other.strengths)


def test_expectations_become_those_of_what_is_felt():
    generator, expected = np.random.default_rng(0), Expected(1)
    values = [expected.standardised(generator.normal(5.0, 2.0, 1))[0] for _ in range(2000)]
    assert np.mean(values[200:]) == pytest.approx(0.0, abs=0.1)
    assert np.std(values[200:]) == pytest.approx(1.0, abs=0.1)


@pytest.fixture(scope="module")
def env():
    env = open_infant(Setup(1.0, held=True))
    env.reset(seed=0)
    return env


def test_legs_are_bent_in_turn(env):
    policy, generator = AlternateSteps(env), np.random.default_rng(0)
    actions = np.array([policy(generator, {}) for _ in range(2000)])
    names = [env.model.actuator(int(index)).name for index in env.actuation.actuators]
    left, right = (actions[:, names.index(f"act:{side}_hip_flex_negative")] for side in ("left", "right"))
    assert left.max() > 0
    assert right.max() > 0
    assert not ((left > 0) & (right > 0)).any()
    starts = sorted(
        (int(frame), side)
        for side, level in (("left", left), ("right", right))
        for frame in np.flatnonzero((level[1:] > 0) & (level[:-1] == 0))
    )
    assert all(first[1] != second[1] for first, second in pairwise(starts))


def test_a_lift_of_a_leg_is_a_step(env):
    qpos = np.repeat(env.data.qpos[None], 1000, axis=0)
    lift = np.clip(np.sin(np.arange(1000) * 2 * np.pi / 200), 0, 1)
    for joint, size in (("hip1", -1.0), ("knee", -1.0)):
        qpos[:, env.model.joint(f"robot:left_{joint}").qposadr[0]] += size * lift
    values = summarise_steps(env.model, qpos, 100.0)
    assert values["rate_per_min"] == pytest.approx(30.0)
    assert values["lift_cm"] > 1


def test_an_infant_without_drive_takes_no_step(env):
    assert summarise_steps(env.model, np.repeat(env.data.qpos[None], 500, axis=0), 100.0)["rate_per_min"] == 0


def test_a_weight_at_the_ankles_lowers_the_lift_and_water_raises_it():
    plain, heavy, wet = (
        stepping(StepCase(1.5, 12.0, **conditions), 0).values["lift_cm"]
        for conditions in ({}, {"weight_kg": 0.1}, {"water": True})
    )
    assert heavy < 0.9 * plain
    assert wet > 1.2 * plain


@pytest.fixture
def standing():
    env = open_infant(Setup(1.0, held=True))
    env.reset(seed=0)
    return env


def test_water_carries_legs_but_for_the_share_by_which_they_are_denser(standing):
    model, legs = standing.model, legs_of(standing.model)
    dry_n = GRAVITY_M_S2 * model.body_mass[legs].sum()
    water = Water(model)
    water(standing.data)
    weight_n = GRAVITY_M_S2 * model.body_mass[legs].sum()
    assert weight_n - standing.data.xfrc_applied[legs, 2].sum() == pytest.approx(dry_n * (1 - WATER_KG_M3 / LIMB_KG_M3))


def test_as_much_water_moves_along_as_is_displaced(standing):
    model, legs = standing.model, legs_of(standing.model)
    dry_kg = model.body_mass.copy()
    Water(model)
    added_kg = model.body_mass - dry_kg
    assert added_kg[legs] == pytest.approx(dry_kg[legs] * WATER_KG_M3 / LIMB_KG_M3)
    assert np.delete(added_kg, legs) == pytest.approx(0)


def test_drag_is_against_the_way_and_goes_with_the_square_of_speed(standing):
    model, data = standing.model, standing.data
    water, shank = Water(model), model.body("left_lower_leg").id
    forces = []
    for speed_m_s in (0.0, 0.5, 1.0):
        data.qvel[:] = 0.0
        data.qvel[0] = speed_m_s  # All of the infant forwards.
        mujoco.mj_forward(model, data)
        water(data)
        forces.append(data.xfrc_applied[shank, 0])
    area_m2 = broadsides_m2(model, [shank])[0]
    assert forces[0] == pytest.approx(0)
    assert forces[1] < 0
    assert forces[2] == pytest.approx(4 * forces[1])
    assert 0.001 < area_m2 < 0.02


def test_drag_is_half_density_times_coefficient_times_area(standing):
    model, data = standing.model, standing.data
    shank = model.body("left_lower_leg").id
    area_m2 = broadsides_m2(model, [shank])[0]
    water = Water(model)
    data.qvel[:] = 0.0
    data.qvel[0] = 1.0
    mujoco.mj_forward(model, data)
    water(data)
    assert data.xfrc_applied[shank, 0] == pytest.approx(-0.5 * WATER_KG_M3 * DRAG * area_m2)


def test_the_broadside_of_a_brick_is_its_largest_side():
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><freejoint/><geom type='box' size='.1 .2 .3' mass='2'/></body></worldbody></mujoco>"
    )
    assert broadsides_m2(model, [1]) == pytest.approx([0.4 * 0.6])
