"""Reaching earns the more the nearer, and a touch ends it."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.full import full_but

import mimoc

LOOKS_RAD = np.deg2rad(3)
"""How well eyes look at the ball, where their range allows."""


@pytest.fixture(
    scope="module", params=[("mitten", "torque"), ("five_finger", "muscle"), ("mitten", "position")], ids=str
)
def env(request, built):
    hands, model = request.param
    with mimoc.InfantEnv(
        built(age_months=12, body={"hands": hands}, actuation={"model": model}, task={"kind": "reach"})
    ) as opened:
        yield opened


def gaze_error(env, looker: str) -> float:
    forward = env.data.body(looker).xmat.reshape(3, 3)[:, 0]
    towards = env.data.body("target").xpos - env.data.body(looker).xpos
    return float(np.arctan2(np.linalg.norm(np.cross(forward, towards)), forward @ towards))


def test_the_reward_is_the_distance_that_is_left(env):
    env.reset(seed=1)
    _, reward, terminated, _, info = env.step(env.action_space.sample())
    distance_m = np.linalg.norm(env.data.body("target").xpos - env.data.body(env.manifest.task.effector).xpos)
    assert reward == pytest.approx(-distance_m)
    assert info["reward_terms"] == {"distance": pytest.approx(-distance_m), "touch": 0.0}
    assert not terminated
    assert not info["is_success"]


def test_a_ball_that_moves_ends_it_with_a_reward(env):
    env.reset(seed=1)
    start = env.model.joint("target_joint").dofadr[0]
    env.data.qvel[start] = 4.0
    _, reward, terminated, _, info = env.step(np.zeros(env.action_space.shape, np.float32))
    assert terminated
    assert info["is_success"]
    assert info["reward_terms"]["touch"] == 100
    assert reward == pytest.approx(sum(info["reward_terms"].values()))


def test_an_untouched_ball_stays_where_it_hangs(env):
    env.reset(seed=2)
    before = env.data.body("target").xpos.copy()
    at_rest = np.array([env.data.ctrl[i] for i in env.actuation.actuators], np.float32)
    for _ in range(50):
        env.step(at_rest)
    assert env.data.body("target").xpos == pytest.approx(before, abs=1e-9)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_eyes_look_at_the_ball(env, seed):
    env.reset(seed=seed)
    assert gaze_error(env, "head") < np.pi / 4
    for eye in ("left_eye", "right_eye"):
        assert gaze_error(env, eye) < LOOKS_RAD or is_turned_fully(env, eye)


def is_turned_fully(env, eye: str) -> bool:
    """Return whether an eye is at an end of its range, as for a ball close to the face."""
    joints = (env.model.joint(f"robot:{eye}_{direction}") for direction in ("horizontal", "vertical"))
    ends = [np.abs(env.data.qpos[joint.qposadr[0]] - joint.range).min() for joint in joints]
    return min(ends) < np.deg2rad(0.5)


def test_eyes_follow_the_ball(env):
    env.reset(seed=3)
    joint = env.model.joint("target_joint")
    env.data.qpos[joint.qposadr[0] + 1] += 0.009
    at_rest = np.array([env.data.ctrl[i] for i in env.actuation.actuators], np.float32)
    for _ in range(40):
        env.step(at_rest)
    assert max(gaze_error(env, eye) for eye in ("left_eye", "right_eye")) < LOOKS_RAD


def test_where_the_ball_is_can_be_felt(env):
    """Head and eyes tell: other places, other joint angles."""
    seen = [env.reset(seed=seed)[0]["proprioception"] for seed in range(6)]
    names = env.layout("proprioception")
    neck = [index for index, name in enumerate(names) if ("eye" in name or "head" in name) and "angle" in name]
    assert len({tuple(reading[neck].tolist()) for reading in seen}) == 6


def test_what_is_held_stays(env):
    env.reset(seed=0)
    bodies = [env.model.body(name).id for name in ("hip", "chest", "left_hand", "left_foot", "right_foot")]
    before = env.data.xpos[bodies].copy()
    generator = np.random.default_rng(0)
    for _ in range(100):
        if env.step(generator.uniform(env.action_space.low, env.action_space.high).astype(np.float32))[2]:
            break
    assert np.abs(env.data.xpos[bodies] - before).max() < 0.01


AGES = (0, 3, 9, 18, 24)


def reach(age_months: float, hands: str = "mitten", **keys) -> mimoc.InfantSpec:
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "body": {"hands": hands}, "task": {"kind": "reach"}}
    return mimoc.InfantSpec.model_validate({**data, **keys})


@pytest.mark.full
@given(age_months=st.floats(0, 24), hands=st.sampled_from(["mitten", "five_finger"]))
@settings(max_examples=10)
def test_the_ball_is_farther_the_longer_the_arm(age_months, hands):
    """Between a half and the whole of an arm's length away: what a hand can touch without going through the body."""
    env = mimoc.InfantEnv(mimoc.build(reach(age_months, hands)))
    goal = env.manifest.task
    data = env.data
    arm_m = sum(
        float(np.linalg.norm(data.body(far).xpos - data.body(near).xpos))
        for near, far in (
            ("right_upper_arm", "right_lower_arm"),
            ("right_lower_arm", "right_hand"),
            ("right_hand", goal.effector),
        )
    )
    nearest, farthest = goal.distance_m
    assert 0.5 * arm_m < nearest < farthest < arm_m


@pytest.mark.parametrize("age_months", full_but([0], AGES))
@pytest.mark.parametrize("hand", ["right", "left"])
def test_no_ball_starts_in_the_infant(age_months, hand):
    env = mimoc.InfantEnv(mimoc.build(reach(age_months, task={"kind": "reach", "hand": hand})))
    ball = env.model.geom("ball").id
    for seed in range(30):
        env.reset(seed=seed)
        touching = env.data.contact.geom[: env.data.ncon]
        assert not (touching == ball).any(), seed


@pytest.mark.parametrize("age_months", full_but([0], AGES))
@pytest.mark.parametrize("development", ["maturing", "published"])
def test_the_infant_is_upright_though_newborns_do_not_straighten_their_hips(age_months, development):
    env = mimoc.InfantEnv(mimoc.build(reach(age_months, development=development)))
    env.reset(seed=0)
    assert env.data.body("upper_body").xmat.reshape(3, 3)[2, 2] > 0.99


def test_one_hand_is_the_mirror_image_of_the_other():
    right, left = (
        mimoc.build(reach(9, task={"kind": "reach", "hand": hand})).manifest.task for hand in ("right", "left")
    )
    assert right.distance_m == left.distance_m
    assert right.azimuth_rad == tuple(-angle for angle in reversed(left.azimuth_rad))
    assert (right.effector, left.effector) == ("right_fingers", "left_fingers")


@pytest.mark.parametrize("hand", ["right", "left"])
def test_mimos_ball_hangs_in_its_box_at_18_months(hand):
    """In MIMo's scene, it is at .2 to .3, -.25 to .05 and .6 to .7 m, and the right shoulder at -.005, -.105, .61 m."""
    spec = reach(18, development="published", task={"kind": "reach", "ball": "mimo", "hand": hand})
    env, side = mimoc.InfantEnv(mimoc.build(spec)), 1 if hand == "right" else -1
    low, high = np.array([(0.205, -0.145, -0.01), (0.305, 0.155, 0.09)])
    for seed in range(30):
        env.reset(seed=seed)
        away_m = env.data.body("target").xpos - env.data.body(f"{hand}_upper_arm").xpos
        assert (low - 0.01 < away_m * (1, side, 1)).all()
        assert (away_m * (1, side, 1) < high + 0.01).all()


def test_toys_and_a_room_go_with_it():
    spec = reach(9, scene={"kind": "room", "seed": 2, "toys": {"count": [2, 2]}})
    env = mimoc.InfantEnv(mimoc.build(spec))
    env.reset(seed=0)
    assert [toy.category == "ball" for toy in env.manifest.toys].count(True) <= 2
    assert len(env.manifest.toys) == 2
    distance_m = np.linalg.norm(env.data.body("target").xpos - env.data.body("right_upper_arm").xpos)
    assert env.manifest.task.distance_m[0] <= distance_m <= env.manifest.task.distance_m[1]
