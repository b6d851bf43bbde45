"""An infant sits so that its hand gets to all of its body but the arm that it moves."""

import numpy as np
import pytest
from support import store

import mimoc
from mimoc.base.errors import SpecError

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


@pytest.mark.parametrize("age_months", AGES)
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


@pytest.mark.parametrize(("hands", "count"), [("mitten", 8), ("five_finger", 29)])
def test_only_one_arm_and_its_hand_take_commands(hands, count):
    entries = mimoc.build(selfbody(18, hands, "left")).manifest.actuation.actuators
    commanded = [entry.name for entry in entries if entry.commanded]
    assert len(commanded) == count
    assert all(name.startswith("act:left_") for name in commanded)


@pytest.mark.parametrize("kind", ["empty", "crib", "room"])
def test_it_can_be_played_anywhere(kind):
    env = mimoc.InfantEnv(mimoc.build(selfbody(9, scene={"kind": kind})))
    env.reset(seed=0)
    before = env.data.body("hip").xpos.copy()
    for _ in range(50):
        env.step(np.zeros(env.action_space.shape, np.float32))
    assert env.data.body("hip").xpos == pytest.approx(before, abs=1e-3)


def test_an_infant_without_the_hand_is_refused():
    with pytest.raises(SpecError, match="task 'selfbody' requires right_fingers"):
        mimoc.build(selfbody(remove=("right_hand",)))
