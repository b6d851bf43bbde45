"""Catching: what falls, what it earns, and when it ends."""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support.full import full_but

import mimoc
from mimoc.bundle.model import simulation_warnings
from mimoc.components.tasks.catch.run import ResizableBall
from mimoc.policies.control.torque_mapping import Activation

ARM = ("shoulder", "elbow", "hand")
ARM_RAD_S, FINGERS_RAD_S = 40.0, 30.0
"""How stiffly the script holds arm and fingers: natural frequencies of joints that are critically damped."""
FIST_RAD = {"fingers": -2.6, "th_swivel": 1.2, "knuckle": 1.3, "middle": 1.3, "distal": 1.3}
"""Where the fingers go, by how the name of a joint ends."""
MUSCLE_SHARE = 0.8
"""How strong a muscle is at least, by its strength at its optimal length, where the script needs it."""


@pytest.fixture
def catch(open_env):
    """Return what opens an infant that is to catch, after a reset."""

    def start(age_months=18, hands="mitten", model="torque", development="maturing", scene=None, seed=0, **task):
        env = open_env(
            age_months=age_months,
            development=development,
            body={"hands": hands},
            actuation={"model": model},
            scene=scene or {},
            task={"kind": "catch", **task},
        )
        env.reset(seed=seed)
        return env

    return start


def rest(env):
    return np.zeros(env.action_space.shape, np.float32)


def ball(env):
    """Return where the ball stands in qpos."""
    return env.model.joint("target_joint").qposadr[0] + np.arange(3)


def palm(env):
    goal = env.manifest.task
    hand = env.data.body(goal.palm)
    return hand.xpos + hand.xmat.reshape(3, 3) @ goal.palm_m


def size(env):
    ball = env.manifest.task.ball
    return env.model.geom(ball.geom).size[0], env.model.body(ball.body).mass[0]


class Script:
    """Hold the arm as it is, whatever it and the ball weigh, and close the fingers on the ball.

    It knows how slowly activations follow commands, and gives the commands that make up for it.
    """

    def __init__(self, env):
        model = env.model
        self.env, joints = env, model.actuator_trnid[env.actuation.actuators, 0]
        self.angles, self.speeds = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        names = [model.joint(joint).name.split("_", 1)[1] for joint in joints]
        self.frequency = np.array([ARM_RAD_S if name.startswith(ARM) else FINGERS_RAD_S for name in names])
        self.low, self.high = model.jnt_range[joints].T
        self.activation = Activation(model, env.actuation.actuators, env.manifest.step_ms / 1000)
        self.open = env.data.qpos[self.angles].copy()
        self.fist = np.array([self.closed(name, angle) for name, angle in zip(names, self.open, strict=True)])
        self.touched = False

    def closed(self, name, angle_rad):
        if name.startswith(ARM):
            return angle_rad
        return next((fist_rad for end, fist_rad in FIST_RAD.items() if name.endswith(end)), angle_rad)

    def __call__(self, touches):
        self.touched |= touches
        goal = self.fist if self.touched else self.open
        self.activation.keep(self.env.data)
        commands = self.activation.commands(self.activations(goal))
        return np.clip(commands, self.env.action_space.low, self.env.action_space.high).astype(np.float32)

    def torques(self, goal):
        model, data = self.env.model, self.env.data
        unit, column = np.zeros(model.nv), np.zeros(model.nv)
        inertias = np.empty(len(goal))
        for index, speed in enumerate(self.speeds):
            unit[:] = np.arange(model.nv) == speed
            mujoco.mj_mulM(model, data, column, unit)
            inertias[index] = column[speed]
        spring, damper = self.frequency**2 * (goal - data.qpos[self.angles]), 2 * self.frequency
        weight = (data.qfrc_bias - data.qfrc_passive)[self.speeds]
        if self.touched:
            lever = np.zeros((3, model.nv))
            hand = model.body(self.env.manifest.task.palm).id
            mujoco.mj_jac(model, data, lever, None, data.body("target").xpos, hand)
            weight += 9.81 * size(self.env)[1] * lever[2, self.speeds]
        return weight + inertias * (spring - damper * data.qvel[self.speeds])

    def activations(self, goal):
        if self.env.manifest.actuation.model == "position":
            return np.clip(2 * (goal - self.low) / (self.high - self.low) - 1, -1, 1)
        torques_nm = self.torques(goal)
        if self.env.manifest.actuation.model == "torque":
            gears_nm = self.env.model.actuator_gear[self.env.actuation.actuators, 0]
            return np.clip(torques_nm / gears_nm, -1, 1)
        return np.clip(torques_nm / self.env.actuation.limits_nm.sum(axis=1) / MUSCLE_SHARE, 0, 1)


def play(env, seed, policy: Callable | None = None, mass_kg: float | None = None):
    """Return the reward terms of every step of an episode, with a ball of some mass, and how it ended."""
    env.reset(seed=seed)
    if mass_kg is not None:
        ResizableBall(env.manifest.task.ball, env.model).change(size(env)[0], mass_kg)
    act, touches, seen = policy(env) if policy else None, False, []
    while True:
        action = act(touches) if act else env.action_space.sample()
        _, reward, terminated, truncated, info = env.step(action)
        terms = info["reward_terms"]
        assert reward == pytest.approx(sum(terms.values()))
        touches = terms["contact"] > 0
        seen.append(terms)
        if terminated or truncated:
            return seen, (terminated, truncated, info)


def caught(env, seed, mass_kg: float | None = None) -> bool:
    return play(env, seed, Script, mass_kg)[1][2]["is_success"]


@pytest.mark.parametrize(("age_months", "development"), [(18, "published"), (6, "maturing"), (18, "maturing")])
@pytest.mark.parametrize("model", ["torque", "muscle", "position"])
@pytest.mark.parametrize("hands", full_but(["five_finger"], ["mitten"]))
def test_a_ball_can_be_caught(catch, age_months, development, model, hands):
    """Each of these infants catches one of some balls; the published body's five fingers are too weak before."""
    env = catch(age_months, hands, model, development)
    assert any(caught(env, seed) for seed in range(10))


@pytest.mark.full
@pytest.mark.parametrize(("age_months", "light_kg", "heavy_kg"), [(0, 0.05, 0.2), (3, 0.15, 0.6), (6, 0.75, 1.25)])
def test_infants_that_mature_catch_heavier_balls_the_older_they_are(catch, age_months, light_kg, heavy_kg):
    """Most of the light ones, and hardly any of the heavy ones; the task's weigh up to 0.5 kg."""
    env = catch(age_months)
    assert sum(caught(env, seed, light_kg) for seed in range(5)) >= 4
    assert sum(caught(env, seed, heavy_kg) for seed in range(5)) <= 1


@pytest.mark.full
@pytest.mark.parametrize(("age_months", "light_kg", "heavy_kg"), [(0, 0.05, 0.2), (3, 0.15, 0.4), (6, 0.3, 0.5)])
def test_arms_that_mature_hold_heavier_balls_up_the_older_they_are(catch, age_months, light_kg, heavy_kg):
    """Fingers hold on to balls under which the arm sinks."""
    env = catch(age_months)
    height_m = palm(env)[2]

    def held_up(seed: int, mass_kg: float) -> bool:
        return caught(env, seed, mass_kg) and palm(env)[2] > height_m - 0.02

    assert sum(held_up(seed, light_kg) for seed in range(5)) >= 4
    assert sum(held_up(seed, heavy_kg) for seed in range(5)) <= 1


@pytest.mark.full
@pytest.mark.parametrize("hand", ["right", "left"])
def test_either_hand_catches_most_balls_at_eighteen_months(catch, hand):
    env = catch(hand=hand)
    assert sum(caught(env, seed) for seed in range(10)) >= 8


def test_a_catch_is_a_second_of_contact_and_ends_the_episode(catch):
    env = catch()
    terms, (terminated, truncated, info) = play(env, 2, Script)
    assert (terminated, truncated, info["is_success"]) == (True, False, True)
    contacts = [step["contact"] for step in terms]
    assert contacts[-100:] == [1.0] * 100
    assert 0.0 in contacts[:-100]
    assert [step["catch"] for step in terms] == [0.0] * (len(terms) - 1) + [100.0]
    assert all(step["loss"] == 0 for step in terms)


def test_a_ball_that_is_not_held_is_lost_and_ends_the_episode(catch):
    """An arm at rest turns its palm to the side."""
    env = catch()
    terms, (terminated, truncated, info) = play(env, 0, lambda env: lambda touches: rest(env))
    assert (terminated, truncated, info["is_success"]) == (True, False, False)
    assert [step["loss"] for step in terms] == [0.0] * (len(terms) - 1) + [-100.0]
    assert all(step["catch"] == 0 for step in terms)
    assert len(terms) < 100


@pytest.mark.parametrize("offset", [(0, 0, -1.1), (1.1, 0, 0), (0, -1.1, 0.5), (-1.1, 0, 2)])
def test_a_ball_below_the_palm_or_beside_it_is_lost(catch, offset):
    env = catch()
    lost_m = env.manifest.task.lost_m
    env.data.qpos[ball(env)] = palm(env) + np.multiply(offset, lost_m)
    assert env.step(rest(env))[2]
    env.reset(seed=0)
    env.data.qpos[ball(env)] = palm(env) + np.multiply(offset, 0.8 * lost_m)
    assert not env.step(rest(env))[2]


def test_a_break_of_contact_starts_the_count_anew(catch):
    env = catch(seed=2)
    act, touches = Script(env), False
    while env.get_state()["task"]["held"] < 50:
        touches = env.step(act(touches))[4]["reward_terms"]["contact"] > 0
    env.data.qpos[ball(env)[2]] += 0.04
    env.step(act(touches))
    assert env.get_state()["task"]["held"] == 0


def test_only_the_hand_catches(catch):
    """A ball that lies on the forearm earns nothing."""
    env = catch()
    forearm = env.data.geom("right_larm")
    x, y, z = forearm.xpos
    env.data.qpos[ball(env)] = x, y, z + env.model.geom("right_larm").size[0] + size(env)[0] - 1e-3
    mujoco.mj_forward(env.model, env.data)
    pairs = {frozenset(env.model.geom(geom).name for geom in pair) for pair in env.data.contact.geom}
    assert frozenset({"ball", "right_larm"}) in pairs
    assert env.step(rest(env))[4]["reward_terms"]["contact"] == 0


def test_effort_is_what_the_environment_says_it_is(catch):
    env = catch()
    _, _, _, _, info = env.step(env.action_space.high)
    assert env.effort() > 0
    assert info["reward_terms"]["effort"] == pytest.approx(-40 * env.effort())


@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_every_episode_has_a_ball_of_its_own(catch, age_months):
    """Sizes and masses are MIMo's at every age; the height is the hand's."""
    env = catch(age_months)
    balls = []
    for seed in range(40):
        env.reset(seed=seed)
        height_m = env.data.body("target").xpos[2] - palm(env)[2] - size(env)[0]
        balls.append((*size(env), height_m / env.manifest.task.drop_m[0]))
        assert (env.data.body("target").xpos - palm(env))[:2] == pytest.approx((0, 0), abs=1e-9)
        assert not np.isin(env.data.contact.geom, env.model.geom("ball").id).any()
    for drawn, (low, high) in zip(np.transpose(balls), [(0.005, 0.025), (0.05, 0.5), (1, 2)], strict=True):
        assert low <= drawn.min() < low + 0.2 * (high - low)
        assert high - 0.2 * (high - low) < drawn.max() <= high
    env.reset(seed=7)
    assert (*size(env),) == balls[7][:2]


@pytest.mark.parametrize("age_months", [0, 9, 24])
@pytest.mark.parametrize("model", ["torque", "muscle"])
def test_at_rest_only_the_arm_moves(catch, age_months, model):
    env = catch(age_months, model=model)
    arm = ("RShoulder", "RElbow", "RWrist")
    kept = [name for name in env.manifest.keypoints if not name.endswith(arm)]
    before = {name: env.data.site(name).xpos.copy() for name in kept}
    for _ in range(30):
        env.step(rest(env))
    moved_m = {name: float(np.linalg.norm(env.data.site(name).xpos - place)) for name, place in before.items()}
    assert max(moved_m.values()) < 3e-3, moved_m


@pytest.mark.parametrize(("age_months", "model", "hands"), [(0, "torque", "five_finger"), (24, "muscle", "mitten")])
def test_random_movements_break_nothing(catch, age_months, model, hands):
    env = catch(age_months, hands, model)
    env.action_space.seed(0)
    for seed in range(5):
        _, (_, _, info) = play(env, seed)
        assert not info["unstable"]
        assert not simulation_warnings(env.data)


def holds(env, seed) -> bool:
    """Play until the ball is held for 20 steps, or the episode ends."""
    env.reset(seed=seed)
    act, touches, ended = Script(env), False, False
    while not ended and env.get_state()["task"]["held"] < 20:
        _, _, terminated, truncated, info = env.step(act(touches))
        touches, ended = info["reward_terms"]["contact"] > 0, terminated or truncated
    return not ended


@pytest.mark.parametrize("model", ["torque", "muscle"])
def test_what_follows_a_state_follows_it_again_with_the_same_ball(open_env, catch, model):
    env = catch(model=model)
    assert any(holds(env, seed) for seed in range(10))
    state, before = env.get_state(), size(env)
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(30)]
    first = [env.step(action)[1] for action in actions]
    env.reset(seed=5)
    other = open_env(bundle=env.bundle)
    for each in (env, other):
        each.set_state(state)
        assert size(each) == before
        assert [each.step(action)[1] for action in actions] == first


@pytest.mark.parametrize("kind", ["crib", "room"])
def test_it_can_be_played_in_other_scenes(catch, kind):
    env = catch(9, scene={"kind": kind, "seed": 3})
    assert any(caught(env, seed) for seed in range(5))


@pytest.mark.parametrize("model", ["torque", "muscle"])
def test_gymnasium_finds_no_fault(catch, model):
    env = mimoc.make(catch(model=model).bundle)
    check_env(env.unwrapped)
    env.close()
