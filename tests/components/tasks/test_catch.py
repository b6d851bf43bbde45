"""Catching: what falls, what it earns, and when it ends."""

from collections.abc import Callable
from functools import cache

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.compiler.building import Builder, builder
from mimoc.compiler.model_check import compile_model
from mimoc.compiler.task_setup import RADIUS_M
from mimoc.components.tasks.catch.run import ResizableBall
from mimoc.policies.control.actuators import ActivationFilter
from mimoc.schema.task import BallEntry

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
        self.filter = ActivationFilter(model, env.actuation.actuators, env.manifest.step_ms / 1000)
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
        commands = self.filter.controls(self.env.data.act, self.activations(goal))
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


@pytest.mark.parametrize("age_months", full_but([9], [0, 24]))
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


def test_a_state_has_the_size_and_the_mass_of_its_ball(catch):
    env = catch()
    state, before = env.get_state(), size(env)
    env.reset(seed=5)
    assert size(env) != before
    env.set_state(state)
    assert size(env) == before


@pytest.mark.parametrize("age_months", full_but([9], [0, 24]))
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


BALL = BallEntry(body="ball", joint="ball:free", geom="ball")


def compiled(radius_m: float, mass_kg: float) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <compiler boundinertia="1e-13"/>
      <worldbody>
        <geom name="floor" type="plane" size="1 1 1"/>
        <body name="hand" pos="0 0 1">
          <joint name="wrist" axis="1 0 0"/>
          <geom name="palm" type="box" size=".1 .1 .01"/>
        </body>
        <body name="ball" pos="0 0 2">
          <freejoint name="ball:free"/>
          <geom name="ball" type="sphere" size="{radius_m!r}" mass="{mass_kg!r}"/>
        </body>
      </worldbody>
    </mujoco>""")


def numbers(model: mujoco.MjModel) -> dict[str, np.ndarray]:
    found = {name: getattr(model, name) for name in dir(model) if not name.startswith("_")}
    return {name: value for name, value in found.items() if isinstance(value, np.ndarray)}


@pytest.mark.parametrize(("radius_m", "mass_kg"), [(0.005, 0.05), (0.005, 0.5), (0.025, 0.05), (0.025, 0.5)])
def test_a_changed_ball_is_as_if_compiled_so(radius_m, mass_kg):
    model = compiled(0.025, 0.0654)
    ball = ResizableBall(BALL, model)
    ball.change(radius_m, mass_kg)
    wanted = numbers(compiled(radius_m, mass_kg))
    for name, value in numbers(model).items():
        np.testing.assert_allclose(value, wanted[name], rtol=1e-9, atol=1e-15, err_msg=name)


def test_a_changed_ball_rolls_and_falls_as_if_compiled_so():
    places = []
    for model in (compiled(0.02, 0.3), compiled(0.025, 0.0654)):
        ball = ResizableBall(BALL, model)
        ball.change(0.02, 0.3)
        data = mujoco.MjData(model)
        data.qpos[ball.place] = (0.05, 0.02, 1.1)
        mujoco.mj_step(model, data, 600)
        places.append(data.qpos.copy())
    assert places[1] == pytest.approx(places[0], rel=1e-6)
    assert places[0][3] < 0.9  # It has rolled off the palm.


AGES = (0, 3, 9, 18, 24)
SOME_AGES = full_but([0, 18], AGES)
PALMAR = {"right": -1, "left": 1}


def staged(age_months: float = 18, hands: str = "mitten", hand: str = "right", **keys) -> Builder:
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "body": {"hands": hands}, **keys}
    return builder(mimoc.InfantSpec.model_validate({**spec, "task": {"kind": "catch", "hand": hand}}))


@cache
def average(age_months: float, hands: str, hand: str) -> tuple[Builder, mujoco.MjModel]:
    made = staged(age_months, hands, hand)
    return made, compile_model(made(0).files)


def started(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("catch").id)
    mujoco.mj_forward(model, data)
    return data


@pytest.fixture(params=["right", "left"])
def hand(request) -> str:
    return request.param


@pytest.fixture(params=["mitten", "five_finger"])
def hands(request) -> str:
    return request.param


def palm_of(made: Builder, data: mujoco.MjData) -> np.ndarray:
    goal = made.manifest.task
    return data.body(goal.palm).xpos + data.body(goal.palm).xmat.reshape(3, 3) @ goal.palm_m


@pytest.mark.parametrize("age_months", SOME_AGES)
def test_the_palm_is_up_and_the_forearm_level(age_months, hands, hand):
    _, model = average(age_months, hands, hand)
    data = started(model)
    up = data.body(f"{hand}_hand").xmat.reshape(3, 3)[2]
    assert np.degrees(np.arccos(PALMAR[hand] * up[1])) < 10
    assert abs(np.degrees(np.arcsin(data.body(f"{hand}_lower_arm").xmat.reshape(3, 3)[2, 2]))) < 10
    upper_arm = data.body(f"{hand}_upper_arm").xmat.reshape(3, 3)[:, 2]
    assert np.degrees(np.arccos(-upper_arm[2])) < 10


@pytest.mark.parametrize("age_months", SOME_AGES)
def test_the_infant_rests_on_the_floor_and_touches_nothing_else(age_months, hands, hand):
    _, model = average(age_months, hands, hand)
    data = started(model)
    assert data.contact.dist.min() > -2e-4
    assert {model.geom(geom).name for geom in data.contact.geom[:, 0]} == {"floor"}
    ends = data.efc_type == mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT  # These act before a joint is at its end.
    assert np.abs(np.where(ends, np.minimum(data.efc_pos, 0), data.efc_pos)).max() < 2e-4


@pytest.mark.parametrize("age_months", SOME_AGES)
def test_the_point_of_the_palm_is_on_its_surface(age_months, hands, hand):
    """A ray from above meets the hand there."""
    made, model = average(age_months, hands, hand)
    data = started(model)
    point, geom = palm_of(made, data), np.zeros(1, np.int32)
    data.qpos[model.joint("target_joint").qposadr[0]] += 1.0
    mujoco.mj_forward(model, data)
    outwards = PALMAR[hand] * data.body(f"{hand}_hand").xmat.reshape(3, 3)[:, 1]
    distance_m = mujoco.mj_ray(model, data, point + 0.05 * outwards, -outwards, None, 1, -1, geom)
    assert distance_m == pytest.approx(0.05, abs=1e-6)
    assert model.body(model.geom_bodyid[geom[0]]).name == f"{hand}_hand"


@pytest.mark.parametrize("age_months", SOME_AGES)
def test_the_ball_hangs_over_the_palm(age_months, hands, hand):
    made, model = average(age_months, hands, hand)
    data = started(model)
    goal = made.manifest.task
    over = data.body("target").xpos - palm_of(made, data)
    assert over == pytest.approx((0, 0, sum(goal.drop_m) / 2 + RADIUS_M), abs=1e-6)
    assert goal.lost_m < goal.drop_m[0] < goal.drop_m[1]


def test_heights_follow_the_hand():
    """As far as MIMo's 18-month-old's hand is long, and twice that; in proportion to the hand at every age."""
    goals = [average(age_months, "mitten", "right")[0].manifest.task for age_months in AGES]
    assert goals[3].drop_m == pytest.approx((0.094, 0.188), abs=0.005)
    lows, highs, lost = np.array([(*goal.drop_m, goal.lost_m) for goal in goals]).T
    assert (np.diff(lows) > 0).all()
    assert highs == pytest.approx(2 * lows, rel=1e-6)
    assert lost == pytest.approx(0.75 * lows, rel=1e-6)


@pytest.mark.parametrize("model", ["torque", "muscle", "position"])
def test_arm_and_hand_take_commands_and_all_else_is_locked(hands, hand, model):
    made = staged(9, hands, hand, actuation={"model": model})
    free = {actuator.joint for actuator in made.manifest.actuation.actuators if actuator.commanded}
    fingers = {"mitten": ("fingers",), "five_finger": ("ff", "mf", "rf", "lf", "th")}[hands]
    parts = ("shoulder", "elbow", "hand", *fingers)
    assert free == {joint for joint in made.tree.joints if joint.startswith(tuple(f"robot:{hand}_{p}" for p in parts))}
    locked = {lock.joint for lock in made.manifest.constraints.locks}
    assert locked == made.tree.joints.keys() - free
    assert [weld.body for weld in made.manifest.constraints.welds] == ["hip"]


def test_the_hand_is_all_of_its_parts(hand):
    assert staged(hand=hand).manifest.task.hand == (f"{hand}_hand", f"{hand}_fingers")
    assert len(staged(hands="five_finger", hand=hand).manifest.task.hand) == 17


@pytest.mark.parametrize("kind", ["crib", "room"])
def test_the_ball_goes_where_the_infant_is(kind):
    made = staged(9, scene={"kind": kind, "seed": 3})
    data = started(compile_model(made(0).files))
    assert (data.body("target").xpos - palm_of(made, data))[:2] == pytest.approx((0, 0), abs=1e-6)
