"""Turning over: how far, what it earns, and when it ends."""

import math

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler.building import Builder, builder
from mimoc.schema import read_spec
from mimoc.schema.source import parse

ON_ITS_BACK, ON_ITS_BELLY = -90.0, 90.0


@pytest.fixture
def rollover(open_env):
    """Return what opens an infant that is to turn over, after a reset."""

    def start(age_months=9, pose="supine", kind="flat", model="torque", hands="mitten", **task):
        env = open_env(
            age_months=age_months,
            body={"hands": hands},
            actuation={"model": model},
            scene={"kind": kind, "pose": pose},
            task={"kind": "rollover", **task},
        )
        env.reset(seed=0)
        return env

    return start


def lay(env, pitch_deg, roll_deg=0.0, lift_m=1.0):
    """Turn the infant in the air, about its own y and then about its own z axis."""
    pitch, roll, turned = (np.zeros(4) for _ in range(3))
    mujoco.mju_axisAngle2Quat(pitch, np.array([0.0, 1.0, 0.0]), math.radians(pitch_deg))
    mujoco.mju_axisAngle2Quat(roll, np.array([0.0, 0.0, 1.0]), math.radians(roll_deg))
    mujoco.mju_mulQuat(turned, pitch, roll)
    env.data.qpos[2] += lift_m
    env.data.qpos[3:7] = turned
    env.data.qvel[:] = 0.0
    mujoco.mj_forward(env.model, env.data)


def rest(env):
    """Return the commands of an infant that does nothing: servos hold its pose."""
    if env.manifest.actuation.model == "position":
        return env.data.ctrl.astype(np.float32)
    return np.clip(np.zeros(env.action_space.shape, np.float32), env.action_space.low, env.action_space.high)


def turned(env):
    return env.step(rest(env))[4]["reward_terms"]["turn"]


@pytest.mark.parametrize("pose", ["supine", "prone"])
@pytest.mark.parametrize("model", ["torque", "muscle", "position"])
@pytest.mark.parametrize("age_months", full_but([9], [0, 24]))
def test_an_episode_starts_at_rest_and_not_turned(rollover, age_months, model, pose):
    """So an infant that does nothing earns next to nothing."""
    env = rollover(age_months, pose, model=model)
    assert env.data.time == 0
    assert np.abs(env.data.qvel).max() < 2
    before = env.data.qpos.copy()
    assert turned(env) < 0.1
    assert np.abs(env.data.qpos - before).max() < 0.02


@pytest.mark.parametrize("kind", ["crib", "room"])
def test_it_can_be_played_wherever_there_is_something_to_lie_on(rollover, kind):
    assert turned(rollover(kind=kind)) < 0.1


@pytest.mark.parametrize(("pose", "back", "belly"), [("supine", 0, 1), ("prone", 1, 0)])
def test_the_share_is_mimos_pitch_of_the_hip(rollover, pose, back, belly):
    """From -90° on the back to 90° on the belly, evenly; the way there does not matter."""
    env = rollover(pose=pose)
    for pitch_deg in range(-90, 91, 15):
        lay(env, pitch_deg)
        share = (pitch_deg + 90) / 180
        assert turned(env) == pytest.approx(share * belly + (1 - share) * back, abs=2e-3)
    for roll_deg in range(0, 181, 15):
        for sign in (-1, 1):
            lay(env, ON_ITS_BACK, sign * roll_deg)
            share = roll_deg / 180
            assert turned(env) == pytest.approx(share * belly + (1 - share) * back, abs=2e-3)


def test_the_reward_is_the_turn_less_the_squared_commands(rollover):
    env = rollover()
    action = env.action_space.sample()
    _, reward, _, _, info = env.step(action)
    assert info["reward_terms"]["effort"] == pytest.approx(-0.01 * float((action**2).sum()))
    assert reward == pytest.approx(sum(info["reward_terms"].values()))
    assert info["reward_terms"].keys() == {"turn", "effort"}


def test_commands_beyond_their_range_cost_what_they_do(rollover):
    env = rollover(model="muscle")
    _, _, _, _, info = env.step(np.full(env.action_space.shape, -3, np.float32))
    assert info["reward_terms"]["effort"] == 0
    _, _, _, _, info = env.step(np.full(env.action_space.shape, 3, np.float32))
    assert info["reward_terms"]["effort"] == pytest.approx(-0.01 * len(env.action_space.low))


def test_a_dense_episode_goes_on_with_the_infant_turned_over(rollover):
    env = rollover(steps=4)
    lay(env, ON_ITS_BELLY)
    ends = [env.step(rest(env))[2:] for _ in range(4)]
    assert [(terminated, truncated) for terminated, truncated, _ in ends] == [(False, False)] * 3 + [(False, True)]
    assert all(info["is_success"] for _, _, info in ends)
    lay(env, ON_ITS_BACK, roll_deg=0.78 * 180)
    assert not env.step(rest(env))[4]["is_success"]
    lay(env, ON_ITS_BACK, roll_deg=0.82 * 180)
    assert env.step(rest(env))[4]["is_success"]


def test_a_shaped_episode_ends_with_success(rollover):
    env = rollover(reward="shaped")
    assert not env.step(rest(env))[2]
    lay(env, ON_ITS_BELLY)
    _, reward, terminated, truncated, info = env.step(rest(env))
    assert (terminated, truncated, info["is_success"]) == (True, False, True)
    assert reward == pytest.approx(10, abs=0.1)
    assert info["reward_terms"]["success"] == 10


@pytest.mark.parametrize("seed", [0, 1])
def test_shaping_adds_the_same_to_every_episode_that_succeeds(rollover, seed):
    """Its discounted sum is minus the potential at the start: it favours no way of succeeding (Ng et al. 1999)."""
    env = rollover(reward="shaped")
    env.action_space.seed(seed)
    start = env.get_state()["task"]["turned"]
    terms = [env.step(env.action_space.sample())[4]["reward_terms"]["shaping"] for _ in range(30)]
    lay(env, ON_ITS_BELLY)
    terms.append(env.step(env.action_space.sample())[4]["reward_terms"]["shaping"])
    assert np.polynomial.polynomial.polyval(0.99, terms) == pytest.approx(-start)
    assert max(map(abs, terms[:30])) > 1e-4


def test_a_reset_to_another_pose_turns_the_task_round(rollover):
    env = rollover(pose="supine")
    env.reset(seed=0, options={"pose": "prone"})
    assert turned(env) < 0.1
    lay(env, ON_ITS_BACK)
    assert env.step(rest(env))[4]["is_success"]


def test_strong_movements_can_turn_an_infant_of_eighteen_months_onto_its_back(rollover):
    """Nothing clever: commands at their limits, drawn anew every .4 s, until a sequence of them does it."""
    env = rollover(18, pose="prone")
    assert any(succeeds(env, np.random.default_rng(seed)) for seed in range(40))


def succeeds(env, generator):
    env.reset(seed=0)
    for step in range(500):
        if step % 40 == 0:
            action = np.where(generator.random(env.action_space.shape) < 0.5, -1, 1).astype(np.float32)
        if env.step(action)[4]["is_success"]:
            return True
    return False


def staged(**keys) -> Builder:
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "task": {"kind": "rollover"}, **keys}
    return builder(mimoc.InfantSpec.model_validate(spec))


@pytest.mark.parametrize("pose", ["supine", "prone"])
def test_it_starts_from_the_pose_of_the_scene_with_all_joints_free(pose):
    made = staged(scene={"pose": pose})
    assert made.manifest.pose == pose
    assert made.manifest.poses == ("supine", "prone", "sitting", "standing")
    assert all(actuator.commanded for actuator in made.manifest.actuation.actuators)
    assert not made.manifest.constraints.locks
    assert not made.manifest.constraints.welds


def test_it_has_mimos_figures_unless_told_otherwise():
    goal = staged().manifest.task
    assert (goal.steps, goal.settle_steps, goal.goal, goal.reward, goal.effort_weight) == (500, 100, 0.8, "dense", 0.01)
    goal = staged(task={"kind": "rollover", "steps": 50, "reward": "shaped"}).manifest.task
    assert (goal.steps, goal.reward) == (50, "shaped")


def test_an_infant_without_limbs_can_play():
    limbs = [f"{side}_{limb}" for side in ("left", "right") for limb in ("upper_arm", "upper_leg")]
    assert staged(body={"remove": limbs}).manifest.task.hip == "hip"


@pytest.mark.parametrize(
    ("scene", "problem"),
    [
        (
            "{kind: empty}",
            "x.yaml:4:15: scene.kind: task 'rollover' requires scene.kind: flat or crib or room; change one of them",
        ),
        (
            "{pose: sitting}",
            "x.yaml:4:15: scene.pose: task 'rollover' requires scene.pose: supine or prone; change one of them",
        ),
        (
            "{pose: standing}",
            "x.yaml:4:15: scene.pose: task 'rollover' requires scene.pose: supine or prone; change one of them",
        ),
    ],
)
def test_it_needs_a_floor_and_an_infant_that_lies_on_it(scene, problem):
    text = f"mimoc: 1\nname: x\nage_months: 9\nscene: {scene}\ntask: {{kind: rollover}}\n"
    with pytest.raises(SpecError) as error:
        read_spec(parse(text, "x.yaml"))
    assert str(error.value) == problem
