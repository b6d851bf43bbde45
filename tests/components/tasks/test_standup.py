"""Standing up earns the head's height, costs commands, and is what a child can do."""

from itertools import product

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support import store
from support.full import full_but, full_rows

import mimoc
from mimoc.base.errors import SpecError, UnsupportedTaskError
from mimoc.body.grow import grow_body
from mimoc.body.kinematics import frames
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.elements import RAIL_RADIUS_M
from mimoc.components.tasks.standup.build import CLEAR_M, arm_to_bar, curled, grip_point
from mimoc.schema import InfantSpec

PULLING_UP = {
    "hip1": (-119, -44, -4),
    "knee": (-168, -27, -8),
    "foot1": (1, 3, 24),
    "hip_bend1": (65, 0, -15),
    "shoulder_horizontal": (43, 42, 35),
    "shoulder_ad_ab": (58, 176, 6),
    "elbow": (-115, -114, -105),
}
"""Angles of joints, in degrees, after `AT_S` seconds: the child pulls itself over its feet, then stretches its legs."""
AT_S = (0.5, 1.15, 1.56)
STIFFNESS_NM_PER_RAD, DAMPING_NMS_PER_RAD = 60.0, 3.0
BODIES = [(18, "mitten", "torque"), (9, "five_finger", "muscle"), (3, "mitten", "position")]


def make(built, age_months: float, hands: str, model: str) -> mimoc.InfantEnv:
    task = {"kind": "standup"}
    env = mimoc.InfantEnv(built(age_months=age_months, body={"hands": hands}, actuation={"model": model}, task=task))
    env.reset(seed=0)
    return env


@pytest.fixture(params=BODIES, ids=str)
def env(request, built):
    with make(built, *request.param) as opened:
        yield opened


class Pull:
    """Commands that follow `PULLING_UP`."""

    def __init__(self, env: mimoc.InfantEnv):
        model, self._env = env.model, env
        self._motors = env.actuation.actuators
        joints = model.actuator_trnid[self._motors, 0]
        self._angles, self._speeds = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self._range = model.jnt_range[joints]
        self._start = env.data.qpos[self._angles].copy()
        names = [model.joint(joint).name.removeprefix("robot:") for joint in joints]
        self._way = [PULLING_UP.get(name.removeprefix("left_").removeprefix("right_")) for name in names]

    def command(self, at_s: float) -> np.ndarray:
        """Return a control for the angles that are to be had at a time."""
        wanted = [
            np.interp(at_s, (0, *AT_S), (start, *np.deg2rad(way))) if way else start
            for start, way in zip(self._start, self._way, strict=True)
        ]
        env, data = self._env, self._env.data
        if env.manifest.actuation.model == "position":
            low, high = self._range.T
            return ((np.array(wanted) - low) / (high - low) * 2 - 1).astype(np.float32)
        torque_nm = STIFFNESS_NM_PER_RAD * (wanted - data.qpos[self._angles])
        torque_nm -= DAMPING_NMS_PER_RAD * data.qvel[self._speeds] + data.qfrc_passive[self._speeds]
        if env.manifest.actuation.model == "torque":
            share = torque_nm / env.model.actuator_gear[self._motors, 0]
        else:
            towards = -env.model.actuator_gear[self._motors, 0]  # A muscle pulls, and the positive one turns back.
            share = towards * torque_nm / env.model.actuator_gainprm[self._motors, 2]
        return np.clip(share, env.action_space.low, env.action_space.high).astype(np.float32)


@pytest.mark.parametrize(
    ("age_months", "hands", "model"),
    [(18, "mitten", "torque"), (18, "mitten", "muscle"), (24, "five_finger", "position")],
)
def test_a_child_can_pull_itself_up(built, age_months, hands, model):
    """It is not standing at first, and then stands for a second; both hands are at the rail all the time."""
    with make(built, age_months, hands, model) as env:
        pull, standing = Pull(env), []
        welds = [env.model.equality(weld.equality).id for weld in env.manifest.constraints.welds]
        for step in range(400):
            *_, terminated, _, info = env.step(pull.command(0.01 * step))
            standing.append(info["is_success"])
            assert not terminated
            off_m = env.data.efc_pos[np.isin(env.data.efc_id, welds) & (env.data.efc_type == 0)]
            assert np.abs(off_m).max() < 0.01
        assert not any(standing[:50])
        assert sum(standing) > 100


def test_the_reward_is_the_height_of_the_head_less_what_is_commanded(env):
    action = env.action_space.sample()
    _, reward, terminated, _, info = env.step(action)
    height_m = env.data.body("head").xpos[2] - env.manifest.task.base_m
    effort = 0.01 * float((action.astype(float) ** 2).sum())
    assert info["reward_terms"] == {"height": pytest.approx(height_m), "effort": pytest.approx(-effort)}
    assert reward == pytest.approx(height_m - effort)
    assert not terminated
    assert not info["is_success"]


def test_an_infant_that_sits_earns_a_little(env):
    at_rest = np.clip(np.zeros(env.action_space.shape, np.float32), env.action_space.low, env.action_space.high)
    if env.manifest.actuation.model == "position":
        at_rest = env.data.ctrl[env.actuation.actuators].astype(np.float32)
    heights = [env.step(at_rest)[4]["reward_terms"]["height"] for _ in range(5)]
    assert 0 < min(heights) < max(heights) < 0.2


def test_hands_stay_at_the_rail_whatever_is_commanded(built):
    """And fingers closed, whatever drives them."""
    rng = np.random.default_rng(0)
    oldest = ((24, "mitten", model) for model in ("torque", "muscle", "position"))
    for age_months, hands, model in ((3, "five_finger", "torque"), *oldest):
        with make(built, age_months, hands, model) as env:
            for _ in range(150):
                env.step(rng.uniform(env.action_space.low, env.action_space.high).astype(np.float32))
                equality = env.data.efc_type == 0
                assert np.abs(env.data.efc_pos[equality]).max() < 0.03


AGES = (3, 6, 9, 18, 24)
INFANTS = [("maturing", age_months) for age_months in AGES] + [("published", age_months) for age_months in (0, 9, 24)]
FEW_INFANTS = [("maturing", 3), ("maturing", 18), ("published", 9)]
MIMOS_AGE = 20.5
"""At which a child is 0.82 m long, as MIMo is."""
BOTTOM = {"lb", "left_upper_leg1", "right_upper_leg1"}
HANDS = ("mitten", "five_finger")


def standup(age_months: float, hands: str = "mitten", body: dict | None = None, **keys) -> mimoc.InfantSpec:
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "body": {"hands": hands, **(body or {})}}
    return mimoc.InfantSpec.model_validate({**data, "task": {"kind": "standup"}, **keys})


def opened(*args, **keys) -> mimoc.InfantEnv:
    env = mimoc.InfantEnv(store.built(standup(*args, **keys)))
    env.reset(seed=0)
    return env


def contacts(env) -> list[tuple[str, str, float]]:
    model = env.model
    return [(model.geom(c.geom1).name, model.geom(c.geom2).name, c.dist) for c in env.data.contact]


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize(("development", "age_months"), full_rows(FEW_INFANTS, INFANTS))
def test_bottom_and_soles_are_on_the_floor_and_nothing_else_touches(development, age_months, hands):
    env = opened(age_months, hands, development=development)
    touching = contacts(env)
    assert {pair[0] for pair in touching} == {"floor"}
    on_floor = {pair[1] for pair in touching}
    assert on_floor >= {"left_foot2", "right_foot2"}
    assert on_floor & BOTTOM
    assert all(name in BOTTOM or "foot" in name or "toe" in name for name in on_floor)
    assert min(dist for _, _, dist in touching) > -2e-4
    for side in ("left", "right"):
        assert env.data.body(f"{side}_foot").xmat.reshape(3, 3)[2, 2] == pytest.approx(1, abs=1e-6)


@pytest.mark.full
@given(age_months=st.floats(3, 24), hands=st.sampled_from(HANDS), chest_joint=st.booleans())
@settings(max_examples=6)
@pytest.mark.slow
def test_the_rail_goes_through_both_closed_hands_and_touches_neither(age_months, hands, chest_joint):
    env = opened(age_months, hands, body={"chest_joint": chest_joint})
    rail, fromto = env.model.geom("rail"), np.zeros(6)
    for side in ("left", "right"):
        point = env.model.equality(f"hold:{side}_hand").data[:3]
        hand = env.data.body(f"{side}_hand")
        x, _, z = hand.xpos + hand.xmat.reshape(3, 3) @ point
        assert (x, z) == pytest.approx((rail.pos[0], rail.pos[2]), abs=2e-4)
        for geom in range(env.model.ngeom):
            name = env.model.body(env.model.geom_bodyid[geom]).name
            if side in name and env.model.geom_contype[geom]:
                gap_m = mujoco.mj_geomDistance(env.model, env.data, rail.id, geom, 0.01, fromto)
                assert gap_m > 0, env.model.geom(geom).name


def test_a_child_as_long_as_mimo_has_a_rail_as_high_as_mimos():
    assert 0.42 <= opened(MIMOS_AGE).model.geom("rail").pos[2] <= 0.45


@pytest.mark.full
@pytest.mark.parametrize("hands", HANDS)
def test_an_older_child_has_a_higher_rail_and_farther_to_go(hands):
    goals, rails = [], []
    for age_months in AGES:
        env = opened(age_months, hands)
        goals.append(env.manifest.task)
        rails.append(env.model.geom("rail").pos[2])
        assert goals[-1].base_m < env.data.body("head").xpos[2] < 0.75 * goals[-1].success_m
    for values in (rails, [goal.base_m for goal in goals], [goal.success_m for goal in goals]):
        assert (np.diff(values) > 0).all()


def test_a_child_as_long_as_mimo_earns_nothing_at_the_height_that_is_mimos():
    assert opened(MIMOS_AGE).manifest.task.base_m == pytest.approx(0.2, abs=0.005)


@pytest.mark.parametrize(("hands", "count"), [("mitten", 27), ("five_finger", 29)])
def test_trunk_arms_and_legs_take_commands_but_not_wrists_and_fingers(hands, count):
    entry = opened(18, hands).manifest
    commanded = [actuator.joint for actuator in entry.actuation.actuators if actuator.commanded]
    assert len(commanded) == count
    assert not any(part in joint for joint in commanded for part in ("hand", "finger", "head", "eye", "knuckle", "th_"))
    locked = {lock.joint for lock in entry.constraints.locks}
    assert not locked & set(commanded)
    assert not any("_hand" in joint for joint in locked), "wrists give way"
    assert {weld.body for weld in entry.constraints.welds} == {"left_hand", "right_hand"}


def test_a_foot_gets_to_the_floor_on_a_leg_of_its_own_length():
    env = opened(18, body={"parts": {"left_lower_leg": {"length": 0.95}, "left_upper_arm": {"length": 0.97}}})
    touching = contacts(env)
    assert {"left_foot2", "right_foot2"} <= {name for _, name, _ in touching}
    assert min(dist for _, _, dist in touching) > -2e-4


def test_toys_keep_clear_of_the_rail():
    for seed in range(5):
        env = opened(18, scene={"seed": seed, "toys": {"count": [8, 8], "size_cm": [8, 12]}})
        assert not any("rail" in first or "rail" in second for first, second, _ in contacts(env))


@pytest.mark.parametrize("part", ["left_hand", "right_fingers", "left_foot", "right_lower_leg"])
def test_an_infant_without_a_hand_or_a_foot_is_refused(part):
    with pytest.raises(SpecError, match="task 'standup' requires"):
        mimoc.build(standup(9, body={"remove": [part]}))


@pytest.mark.parametrize(
    ("parts", "message"),
    [(("lower_leg",), "right leg has the wrong length"), (("upper_arm", "lower_arm"), "arms are too short")],
)
def test_an_infant_that_cannot_sit_at_the_rail_is_refused(parts, message):
    halved = {f"{side}_{part}": {"length": 0.5, "girth": 0.6} for side in ("left", "right") for part in parts}
    with pytest.raises(SpecError, match=message):
        mimoc.build(standup(18, body={"parts": halved}))


def test_the_ankles_of_the_newborn_do_not_bend_down_far_enough():
    with pytest.raises(SpecError, match="right ankle bends down by 26 deg, which is not enough"):
        mimoc.build(standup(0))
    assert mimoc.build(standup(0, development="published")).manifest.task.kind == "standup"


@pytest.mark.parametrize("kind", ["empty", "crib", "room"])
def test_there_is_no_place_for_the_rail_elsewhere(kind):
    with pytest.raises(SpecError, match=r"task 'standup' requires scene\.kind: flat"):
        standup(9, scene={"kind": kind})


SIDES = ("right", "left")
REACHING = full_but([(9, "mitten")], product((0, 9, 24), ("mitten", "five_finger")))


def grown(age_months: float, hands: str) -> BodyTree:
    keys = {"mimoc": 1, "name": "x", "age_months": age_months, "body": {"hands": hands}}
    return grow_body(InfantSpec.model_validate(keys)).tree


def before(tree: BodyTree, side: str, share: float) -> np.ndarray:
    """Return a place before a shoulder, so many lengths of the arm away, in the frame of the hip."""
    placed = frames(tree, {})
    shoulder, hand = placed[f"{side}_upper_arm"][0], placed[f"{side}_hand"][0]
    return shoulder + share * np.linalg.norm(hand - shoulder) * np.array([1.0, 0.0, 0.0])


def thumb_side(side: str) -> np.ndarray:
    return np.array([0.0, 1.0 if side == "right" else -1.0, 0.0])


@pytest.mark.parametrize("infant", REACHING, ids=str)
@pytest.mark.parametrize("share", [0.6, 0.8])
def test_an_arm_brings_the_hand_to_the_bar(infant, share):
    tree = grown(*infant)
    for side in SIDES:
        point_m, place_m = grip_point(tree, side, RAIL_RADIUS_M), before(tree, side, share)
        angles = arm_to_bar(tree, {}, side, point_m, place_m, thumb_side(side))
        origin, turn = frames(tree, angles)[f"{side}_hand"]
        assert origin + turn @ point_m == pytest.approx(place_m, abs=1e-4)
        assert turn[:, 0] == pytest.approx(thumb_side(side), abs=1e-3)
        for name, angle_rad in angles.items():
            low, high = np.deg2rad(tree.joints[name].range_deg)
            assert low - 1e-6 <= angle_rad <= high + 1e-6


@pytest.mark.parametrize("infant", REACHING, ids=str)
def test_both_arms_do_the_same(infant):
    tree = grown(*infant)
    right, left = (
        list(
            arm_to_bar(
                tree, {}, side, grip_point(tree, side, RAIL_RADIUS_M), before(tree, side, 0.7), thumb_side(side)
            ).values()
        )
        for side in SIDES
    )
    assert right == pytest.approx(left, abs=1e-5)


@pytest.mark.parametrize("infant", REACHING, ids=str)
def test_the_bar_is_clear_of_the_palm(infant):
    tree = grown(*infant)
    for side in SIDES:
        palm = tree.geoms[f"{side}_hand1"]
        away_m = abs(grip_point(tree, side, RAIL_RADIUS_M)[1] - palm.pos_m[1])
        assert away_m == pytest.approx(RAIL_RADIUS_M + palm.size_m[1] + CLEAR_M)
        assert curled(tree, side).keys() <= tree.joints.keys()


def test_a_bar_that_is_too_far_away_is_refused():
    tree = grown(9, "mitten")
    point_m, place_m = grip_point(tree, "right", RAIL_RADIUS_M), before(tree, "right", 1.5)
    with pytest.raises(UnsupportedTaskError, match="right hand does not reach"):
        arm_to_bar(tree, {}, "right", point_m, place_m, thumb_side("right"))
