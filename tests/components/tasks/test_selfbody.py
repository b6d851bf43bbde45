"""Touching the part that the goal names ends it with a reward; touching another tells how far it is."""

from collections.abc import Callable
from itertools import product

import mujoco
import numpy as np
import pytest
from support import store
from support.full import full_but

import mimoc

ARM = ("shoulder_horizontal", "shoulder_ad_ab", "shoulder_rotation", "elbow", "hand1", "hand2", "hand3", "fingers")
DEEPEST_M = 0.002
"""How deep the arm may be in anything where it touches a part."""
TRIES, STEPS = 40, 150
BODIES = [(9, "mitten", "torque", "right"), (18, "five_finger", "muscle", "left"), (0, "mitten", "position", "left")]


def make(built, age_months: float, hands: str, model: str, hand: str) -> mimoc.InfantEnv:
    task = {"kind": "selfbody", "hand": hand}
    env = mimoc.InfantEnv(built(age_months=age_months, body={"hands": hands}, actuation={"model": model}, task=task))
    env.reset(seed=0)
    return env


@pytest.fixture(params=BODIES, ids=str)
def env(request, built):
    with make(built, *request.param) as opened:
        yield opened


def seed_of(env, target: str) -> int:
    """Return the seed of an episode with a goal, which begins."""
    names = [entry.name for entry in env.manifest.task.targets]
    return next(seed for seed in range(500) if names[env.reset(seed=seed)[0]["goal"].argmax()] == target)


def solids(env, bodies) -> list[int]:
    ids = [env.model.body(body).id for body in bodies]
    return [geom for geom in range(env.model.ngeom) if env.model.geom_bodyid[geom] in ids and _is_solid(env, geom)]


def _is_solid(env, geom: int) -> bool:
    return bool(env.model.geom_contype[geom] | env.model.geom_conaffinity[geom])


def miss(env, side: str, target: tuple[str, ...]) -> Callable[[np.ndarray], float]:
    """Return what says how far an arm with some angles is from touching a part and nothing else too deeply, in [m]."""
    model, data, fromto = env.model, env.data, np.zeros(6)
    angles = [model.joint(f"robot:{side}_{name}").qposadr[0] for name in joints_of(env, side)]
    hand, wanted = solids(env, env.manifest.task.effectors), solids(env, target)
    arm = [*hand, *solids(env, (f"{side}_upper_arm", f"{side}_lower_arm"))]

    def how_far(pose: np.ndarray) -> float:
        data.qpos[angles] = pose
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        deep = -data.contact.dist[np.isin(data.contact.geom, arm).any(axis=1)] - DEEPEST_M
        gap_m = min(
            mujoco.mj_geomDistance(model, data, one, other, 0.5, fromto) for one, other in product(hand, wanted)
        )
        return max(gap_m, -DEEPEST_M / 2) + 5 * np.maximum(deep, 0).sum()

    return how_far


def joints_of(env, side: str) -> list[str]:
    names = {env.model.joint(index).name for index in range(env.model.njnt)}
    return [name for name in ARM if f"robot:{side}_{name}" in names]


def touch(env, side: str, target: tuple[str, ...]) -> bool:
    """Put the arm where the hand touches a part, and say whether there is such a place: climb from chance places."""
    how_far, rng = miss(env, side, target), np.random.default_rng(0)
    low, high = np.array([env.model.joint(f"robot:{side}_{name}").range for name in joints_of(env, side)]).T
    for _ in range(TRIES):
        pose = rng.uniform(low, high)
        best, spread = how_far(pose), 0.4
        for _ in range(STEPS):
            other = pose + spread * rng.normal(size=len(pose)) * (rng.random(len(pose)) < 0.4)
            other = np.clip(other, low, high)
            if (found := how_far(other)) < best:
                pose, best = other, found
            spread = max(0.985 * spread, 0.02)
            if best < 0:
                how_far(pose)
                mujoco.mj_forward(env.model, env.data)
                return True
    return False


@pytest.mark.full
@pytest.mark.parametrize(
    ("age_months", "hands", "hand"),
    [
        *((0, "mitten", "right"), (0, "five_finger", "left"), (3, "mitten", "left"), (9, "five_finger", "right")),
        *((18, "mitten", "right"), (24, "five_finger", "left")),
    ],
)
def test_a_hand_gets_to_every_part_at_every_age(built, age_months, hands, hand):
    """And where it does, that is a success."""
    with make(built, age_months, hands, "torque", hand) as env:
        for target in env.manifest.task.targets:
            seed_of(env, target.name)
            assert touch(env, hand, target.bodies), target.name
            verdict = env.task.judge(env.data, env.action_space.sample(), env.effort)
            assert verdict.success, target.name
            assert verdict.terminated
            assert verdict.reward_terms == {"touch": 500.0, "distance": 0.0, "idle": 0.0}


def test_touching_another_part_costs_the_distance(env):
    hand = env.manifest.task.fingers.split("_")[0]
    seed_of(env, "head")
    for part in ("left_upper_leg", "right_upper_leg", "hip"):
        assert touch(env, hand, (part,))
        verdict = env.task.judge(env.data, env.action_space.sample(), env.effort)
        fingers = env.data.body(env.manifest.task.fingers).xpos
        middles = env.data.geom_xpos[solids(env, ("head", "left_eye", "right_eye"))]
        distance_m = np.linalg.norm(middles - fingers, axis=1).min()
        assert verdict.reward_terms == {"touch": 0.0, "distance": pytest.approx(-distance_m), "idle": 0.0}
        assert not verdict.success
        assert not verdict.terminated


def test_touching_nothing_costs_one(env):
    env.reset(seed=0)
    _, reward, terminated, _, info = env.step(env.action_space.sample())
    assert reward == -1
    assert info["reward_terms"] == {"touch": 0.0, "distance": 0.0, "idle": -1.0}
    assert not terminated


def test_the_goal_is_one_hot_and_drawn_evenly(env):
    count = len(env.manifest.task.targets)
    goals = np.array([env.reset(seed=seed)[0]["goal"] for seed in range(300)])
    assert goals.shape == (300, count)
    assert goals.dtype == np.float32
    assert (np.sort(goals) == np.eye(count)[-1]).all()
    assert (goals.mean(axis=0) > 0.5 / count).all()
    assert (goals.mean(axis=0) < 2 / count).all()


def test_the_goal_stays_for_an_episode_and_goes_with_its_state(env):
    goal = env.reset(seed=3)[0]["goal"]
    state = env.get_state()
    assert (env.step(env.action_space.sample())[0]["goal"] == goal).all()
    other = next(seed for seed in range(99) if (env.reset(seed=seed)[0]["goal"] != goal).any())
    assert (env.reset(seed=other)[0]["goal"] != goal).any()
    assert (env.set_state(state)["goal"] == goal).all()


def test_all_but_the_arm_stays_where_it_is(env):
    env.reset(seed=0)
    hand = env.manifest.task.fingers.split("_")[0]
    before = {name: env.data.body(name).xpos.copy() for name in ("head", "hip", "left_foot", "right_foot")}
    rng = np.random.default_rng(1)
    for _ in range(100):
        if env.step(rng.uniform(env.action_space.low, env.action_space.high).astype(np.float32))[2]:
            break
    assert all(np.linalg.norm(env.data.body(name).xpos - place) < 0.01 for name, place in before.items())
    angles = env.data.qpos[[env.model.joint(f"robot:{hand}_{name}").qposadr[0] for name in ARM[:4]]]
    env.reset(seed=0)
    assert (
        np.abs(angles - env.data.qpos[[env.model.joint(f"robot:{hand}_{name}").qposadr[0] for name in ARM[:4]]]).max()
        > 0.05
    )


@pytest.mark.parametrize("target", ["head", "hip", "right_upper_leg", "left_lower_leg", "left_lower_arm", "left_hand"])
def test_a_hand_that_is_there_earns_it(built, target):
    with make(built, 18, "mitten", "position", "right") as env:
        entry = next(entry for entry in env.manifest.task.targets if entry.name == target)
        seed = seed_of(env, target)
        assert touch(env, "right", entry.bodies)
        touching = env.data.qpos.copy()
        env.reset(seed=seed)
        env.data.qpos[:] = touching
        *_, reward, terminated, _, info = env.step(env.data.ctrl[env.actuation.actuators].astype(np.float32))
        assert terminated
        assert info["is_success"]
        assert reward == 500


AGES = (0, 9, 18, 24)
HANDS = ("mitten", "five_finger")
PARTS = [
    *("head", "upper_body", "hip"),
    *("left_upper_leg", "right_upper_leg", "left_lower_leg", "right_lower_leg", "left_foot", "right_foot"),
    *("left_upper_arm", "left_lower_arm", "left_hand"),
]


def selfbody(
    age_months: float = 9, hands: str = "mitten", hand: str = "right", remove: tuple[str, ...] = (), **keys
) -> mimoc.InfantSpec:
    body = {"hands": hands, "remove": list(remove)}
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "body": body, "task": {"kind": "selfbody", "hand": hand}}
    return mimoc.InfantSpec.model_validate({**data, **keys})


def targets(*args, **keys) -> list[str]:
    return [target.name for target in store.built(selfbody(*args, **keys)).manifest.task.targets]


@pytest.mark.parametrize("age_months", full_but([0, 18], AGES))
@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("hand", ["right", "left"])
def test_it_sits_on_the_floor_and_touches_nothing_else(age_months, hands, hand):
    env = mimoc.InfantEnv(store.built(selfbody(age_months, hands, hand)))
    env.reset(seed=0)
    pairs = [(env.model.geom(c.geom1).name, env.model.geom(c.geom2).name, c.dist) for c in env.data.contact]
    assert {first for first, _, _ in pairs} == {"floor"}
    assert not any("hand" in second or "arm" in second for _, second, _ in pairs)
    assert min(dist for _, _, dist in pairs) > -2e-4


def test_the_goal_is_the_same_list_at_every_age():
    assert all(targets(age_months, hands) == PARTS for age_months in AGES for hands in HANDS)


def test_the_other_hand_touches_the_other_arm():
    assert targets(hand="left") == [*PARTS[:9], "right_upper_arm", "right_lower_arm", "right_hand"]


def test_what_an_infant_does_not_have_is_no_goal():
    left = {"left_lower_arm", "left_hand"}
    assert targets(remove=("left_lower_arm",)) == [part for part in PARTS if part not in left]
    assert targets(remove=("right_foot",)) == [part for part in PARTS if part != "right_foot"]


def test_every_solid_part_but_the_touching_arm_belongs_to_one_goal():
    for hands in HANDS:
        env = mimoc.InfantEnv(store.built(selfbody(18, hands)))
        entry, model = env.manifest.task, env.model
        named = [body for target in entry.targets for body in target.bodies]
        solid = {model.body(body).name for body in model.geom_bodyid[model.geom_contype > 0]} - {"world"}
        arm = {"right_upper_arm", "right_lower_arm", *entry.effectors}
        assert sorted(named) == sorted(solid - arm)


@pytest.mark.parametrize("kind", ["empty", "crib", "room"])
def test_it_can_be_played_anywhere(kind):
    env = mimoc.InfantEnv(mimoc.build(selfbody(9, scene={"kind": kind})))
    env.reset(seed=0)
    before = env.data.body("hip").xpos.copy()
    for _ in range(50):
        env.step(np.zeros(env.action_space.shape, np.float32))
    assert env.data.body("hip").xpos == pytest.approx(before, abs=1e-3)
