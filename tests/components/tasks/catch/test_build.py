"""The infant that is to catch: how it sits, what it offers, and where the ball is."""

from functools import cache

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler.building import Builder, builder
from mimoc.compiler.model_check import compile_model
from mimoc.compiler.task_setup import RADIUS_M

AGES = (0, 3, 9, 18, 24)
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


def palm(made: Builder, data: mujoco.MjData) -> np.ndarray:
    goal = made.manifest.task
    return data.body(goal.palm).xpos + data.body(goal.palm).xmat.reshape(3, 3) @ goal.palm_m


@pytest.mark.parametrize("age_months", AGES)
def test_the_palm_is_up_and_the_forearm_level(age_months, hands, hand):
    _, model = average(age_months, hands, hand)
    data = started(model)
    up = data.body(f"{hand}_hand").xmat.reshape(3, 3)[2]
    assert np.degrees(np.arccos(PALMAR[hand] * up[1])) < 10
    assert abs(np.degrees(np.arcsin(data.body(f"{hand}_lower_arm").xmat.reshape(3, 3)[2, 2]))) < 10
    upper_arm = data.body(f"{hand}_upper_arm").xmat.reshape(3, 3)[:, 2]
    assert np.degrees(np.arccos(-upper_arm[2])) < 10


@pytest.mark.parametrize("age_months", AGES)
def test_the_infant_rests_on_the_floor_and_touches_nothing_else(age_months, hands, hand):
    _, model = average(age_months, hands, hand)
    data = started(model)
    assert data.contact.dist.min() > -2e-4
    assert {model.geom(geom).name for geom in data.contact.geom[:, 0]} == {"floor"}
    ends = data.efc_type == mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT  # These act before a joint is at its end.
    assert np.abs(np.where(ends, np.minimum(data.efc_pos, 0), data.efc_pos)).max() < 2e-4


@pytest.mark.parametrize("age_months", AGES)
def test_the_point_of_the_palm_is_on_its_surface(age_months, hands, hand):
    """A ray from above meets the hand there."""
    made, model = average(age_months, hands, hand)
    data = started(model)
    point, geom = palm(made, data), np.zeros(1, np.int32)
    data.qpos[model.joint("target_joint").qposadr[0]] += 1.0
    mujoco.mj_forward(model, data)
    outwards = PALMAR[hand] * data.body(f"{hand}_hand").xmat.reshape(3, 3)[:, 1]
    distance_m = mujoco.mj_ray(model, data, point + 0.05 * outwards, -outwards, None, 1, -1, geom)
    assert distance_m == pytest.approx(0.05, abs=1e-6)
    assert model.body(model.geom_bodyid[geom[0]]).name == f"{hand}_hand"


@pytest.mark.parametrize("age_months", AGES)
def test_the_ball_hangs_over_the_palm(age_months, hands, hand):
    made, model = average(age_months, hands, hand)
    data = started(model)
    goal = made.manifest.task
    over = data.body("target").xpos - palm(made, data)
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
    assert (data.body("target").xpos - palm(made, data))[:2] == pytest.approx((0, 0), abs=1e-6)


def test_an_infant_without_the_hand_cannot_catch():
    with pytest.raises(SpecError, match=r"task 'catch' requires left_fingers and left_hand, which this infant"):
        staged(hand="left", body={"remove": ["left_hand"]})
    assert staged(hand="right", body={"remove": ["left_hand"]}).manifest.task.kind == "catch"
