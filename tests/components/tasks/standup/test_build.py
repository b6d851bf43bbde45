"""An infant of any age sits at a rail of its size, feet on the floor and hands around the bar."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support import store
from support.full import full_rows

import mimoc
from mimoc.base.errors import SpecError

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
    [
        (("lower_leg",), "right leg has the wrong length"),
        (("upper_arm", "lower_arm"), "arms are too short"),
    ],
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
